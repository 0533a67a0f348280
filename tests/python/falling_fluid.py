#!/usr/bin/python3
"""mpm88 (Hu 2018; Taichi's examples/simulation/mpm88.py) in numpy, on a grid of 16 x 16 in place of 128 x 128.

mpm88.py FILE.csv: runs the block of fluid in its fall, with twice the step that mpm88 has for the width of its cells, until it
breaks, and writes the particles of a few steps before. It shares nothing with mpmstab.
"""
import sys

import numpy

CELLS, PARTICLES, E = 16, 128, 400.0
DX = 1 / CELLS
VOLUME = MASS = (DX / 2) ** 2
DT = 2e-4 * 128 / CELLS  # mpm88's own
FACTOR, BEFORE = 2, 5
NODES = [(i, j) for i in range(3) for j in range(3)]


def step(x, v, C, J, dt, gravity, rest=1):
    """A step of mpm88, with the names that it has. rest: the J at which there is no stress."""
    base = (x * CELLS - 0.5).astype(int)
    fx = x * CELLS - base
    w = [0.5 * (1.5 - fx) ** 2, 0.75 - (fx - 1) ** 2, 0.5 * (fx - 0.5) ** 2]
    stress = -dt * 4 * E * VOLUME * (J - rest) / DX**2
    affine = stress[:, None, None] * numpy.eye(2) + MASS * C
    grid_v, grid_m = numpy.zeros((CELLS, CELLS, 2)), numpy.zeros((CELLS, CELLS))
    for i, j in NODES:
        at, weight = (base[:, 0] + i, base[:, 1] + j), w[i][:, 0] * w[j][:, 1]
        dpos = (numpy.array([i, j]) - fx) * DX
        numpy.add.at(grid_v, at, weight[:, None] * (MASS * v + numpy.einsum("pab,pb->pa", affine, dpos)))
        numpy.add.at(grid_m, at, weight * MASS)
    grid_v[grid_m > 0] /= grid_m[grid_m > 0][:, None]
    grid_v[..., 1] -= dt * gravity
    for a in range(2):
        along = numpy.moveaxis(grid_v[..., a], a, 0)
        along[:3] = numpy.maximum(along[:3], 0)
        along[CELLS - 3:] = numpy.minimum(along[CELLS - 3:], 0)
    v, C = numpy.zeros_like(v), numpy.zeros_like(C)
    for i, j in NODES:
        weight, g_v = w[i][:, 0] * w[j][:, 1], grid_v[base[:, 0] + i, base[:, 1] + j]
        dpos = (numpy.array([i, j]) - fx) * DX
        v += weight[:, None] * g_v
        C += 4 * weight[:, None, None] * g_v[:, :, None] * dpos[:, None, :] / DX**2
    return x + dt * v, v, C, J * (1 + dt * numpy.trace(C, axis1=1, axis2=2))


def until_it_breaks(dt, steps=200):
    """The places and the J of each step until some J is no longer between 1/2 and 2."""
    random = numpy.random.default_rng(1)
    x, v = random.random((PARTICLES, 2)) * 0.4 + 0.2, numpy.tile([0.0, -1.0], (PARTICLES, 1))
    C, J, seen = numpy.zeros((PARTICLES, 2, 2)), numpy.ones(PARTICLES), []
    while len(seen) < steps and (J > 0.5).all() and (J < 2).all():
        seen.append((x, J))
        x, v, C, J = step(x, v, C, J, dt, 9.8)
    return seen


def main():
    seen = until_it_breaks(FACTOR * DT)
    x, J = seen[-BEFORE]
    print(f"dt {FACTOR * DT:g}: breaks after {len(seen)} steps; the particles of step {len(seen) - BEFORE}")
    # the force of a particle is V0 E dJ with dJ = J tr(L) dt, so that its volume is that of now
    numpy.savetxt(sys.argv[1], numpy.column_stack([x, VOLUME * J, numpy.full(PARTICLES, MASS)]), fmt="%.17g",
                  delimiter=",", header="x,y,volume,mass")


if __name__ == "__main__":
    main()
