#!/usr/bin/python3
"""Times the step of taichi_mpm3d.py in NVIDIA's Warp, in double precision, on the processor (one thread).

warp_mpm3d.py CELLS STEPS prints ns per particle and step.
"""
import json
import sys
import time

import numpy
import warp as wp

CELLS, STEPS = (int(word) for word in sys.argv[1:])
PPC, MARGIN = 2, 3
DX = wp.constant(wp.float64(1 / CELLS))
DT, STIFFNESS = wp.constant(wp.float64(2e-5)), wp.constant(wp.float64(400.0))
VOLUME = wp.constant(wp.float64((1 / CELLS / PPC) ** 3))
LOW, HIGH = wp.constant(MARGIN), wp.constant(CELLS - MARGIN)

wp.config.quiet = True
wp.init()


@wp.func
def weights(d: wp.float64):
    """The weights of the three nodes of a particle at d from the first of them, in cells."""
    half = wp.float64(0.5)
    a, b, c = wp.float64(1.5) - d, d - wp.float64(1.0), d - half
    return wp.vec3d(half * a * a, wp.float64(0.75) - b * b, half * c * c)


@wp.kernel
def to_nodes(x: wp.array(dtype=wp.vec3d), v: wp.array(dtype=wp.vec3d), affine: wp.array(dtype=wp.mat33d),
             ratio: wp.array(dtype=wp.float64), grid_v: wp.array3d(dtype=wp.vec3d), grid_m: wp.array3d(dtype=wp.float64)):
    p = wp.tid()
    at = x[p] / DX
    i = int(at[0] - wp.float64(0.5))
    j = int(at[1] - wp.float64(0.5))
    k = int(at[2] - wp.float64(0.5))
    d = at - wp.vec3d(wp.float64(i), wp.float64(j), wp.float64(k))
    wx, wy, wz = weights(d[0]), weights(d[1]), weights(d[2])
    stress = -DT * wp.float64(4.0) * STIFFNESS * VOLUME * (ratio[p] - wp.float64(1.0)) / (DX * DX)
    matrix = wp.identity(n=3, dtype=wp.float64) * stress + affine[p] * VOLUME
    for l in range(3):
        for m in range(3):
            for n in range(3):
                near = wp.vec3i(i + l, j + m, k + n)
                r = wp.vec3d(wp.float64(near[0]), wp.float64(near[1]), wp.float64(near[2])) * DX - x[p]
                weight = wx[l] * wy[m] * wz[n]
                wp.atomic_add(grid_v, near[0], near[1], near[2], (v[p] * VOLUME + matrix * r) * weight)
                wp.atomic_add(grid_m, near[0], near[1], near[2], weight * VOLUME)


@wp.kernel
def on_nodes(grid_v: wp.array3d(dtype=wp.vec3d), grid_m: wp.array3d(dtype=wp.float64)):
    i, j, k = wp.tid()
    u = grid_v[i, j, k]
    if grid_m[i, j, k] > wp.float64(0.0):
        u = u / grid_m[i, j, k]
    zero = wp.float64(0.0)
    if (i < LOW and u[0] < zero) or (i > HIGH and u[0] > zero):
        u = wp.vec3d(zero, u[1], u[2])
    if (j < LOW and u[1] < zero) or (j > HIGH and u[1] > zero):
        u = wp.vec3d(u[0], zero, u[2])
    if (k < LOW and u[2] < zero) or (k > HIGH and u[2] > zero):
        u = wp.vec3d(u[0], u[1], zero)
    grid_v[i, j, k] = u


@wp.kernel
def to_particles(x: wp.array(dtype=wp.vec3d), v: wp.array(dtype=wp.vec3d), affine: wp.array(dtype=wp.mat33d),
                 ratio: wp.array(dtype=wp.float64), grid_v: wp.array3d(dtype=wp.vec3d)):
    p = wp.tid()
    at = x[p] / DX
    i = int(at[0] - wp.float64(0.5))
    j = int(at[1] - wp.float64(0.5))
    k = int(at[2] - wp.float64(0.5))
    d = at - wp.vec3d(wp.float64(i), wp.float64(j), wp.float64(k))
    wx, wy, wz = weights(d[0]), weights(d[1]), weights(d[2])
    new_v = wp.vec3d()
    new_c = wp.mat33d()
    for l in range(3):
        for m in range(3):
            for n in range(3):
                near = wp.vec3i(i + l, j + m, k + n)
                r = wp.vec3d(wp.float64(near[0]), wp.float64(near[1]), wp.float64(near[2])) * DX - x[p]
                weight = wx[l] * wy[m] * wz[n]
                node = grid_v[near[0], near[1], near[2]]
                new_v = new_v + node * weight
                new_c = new_c + wp.outer(node, r) * (wp.float64(4.0) * weight / (DX * DX))
    v[p] = new_v
    x[p] = x[p] + new_v * DT
    ratio[p] = ratio[p] * (wp.float64(1.0) + DT * wp.trace(new_c))
    affine[p] = new_c


def main():
    along = (numpy.arange(PPC * (CELLS - 2 * MARGIN)) + 0.51) / PPC + MARGIN
    places = numpy.stack(numpy.meshgrid(along, along, along, indexing="ij"), axis=-1).reshape(-1, 3) / CELLS
    n = len(places)
    with wp.ScopedDevice("cpu"):
        x = wp.array(places, dtype=wp.vec3d)
        v = wp.array(0.1 * numpy.sin(2 * numpy.pi * places), dtype=wp.vec3d)
        affine, ratio = wp.zeros(n, dtype=wp.mat33d), wp.array(numpy.ones(n), dtype=wp.float64)
        grid_v, grid_m = wp.zeros((CELLS,) * 3, dtype=wp.vec3d), wp.zeros((CELLS,) * 3, dtype=wp.float64)

        def step():
            grid_v.zero_()
            grid_m.zero_()
            wp.launch(to_nodes, n, inputs=[x, v, affine, ratio, grid_v, grid_m])
            wp.launch(on_nodes, (CELLS,) * 3, inputs=[grid_v, grid_m])
            wp.launch(to_particles, n, inputs=[x, v, affine, ratio, grid_v])

        step()  # compiles it
        begin = time.perf_counter()
        for _ in range(STEPS):
            step()
        wp.synchronize()
        seconds = time.perf_counter() - begin
        speed = float(numpy.abs(v.numpy()).max())
    if not 0 < speed < 1:
        sys.exit(f"warp_mpm3d: the largest velocity is {speed}")
    print(json.dumps({"ns_per_particle_step": 1e9 * seconds / STEPS / n, "particles": n}))


main()
