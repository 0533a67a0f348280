"""Marches gas2 as a Python user would write it, and prints what plain_gas2.c prints.

numba_gas2.py PARTICLES STEPS DRIFT BASIS
"""
import json
import sys
import time

import numba
import numpy

COURANT, PPC = 0.01, 2


@numba.njit(inline="always")
def first_node(x, quadratic):
    """Returns the first node of a particle. Node arrays have one more node before the first cell."""
    return int(x + 0.5) if quadratic else int(x) + 1


@numba.njit(inline="always")
def weight(x, n, quadratic):
    if not quadratic:
        return x - int(x) if n else 1 - (x - int(x))
    d = x - int(x + 0.5)
    if n == 1:
        return 0.75 - d * d
    return 0.5 * (0.5 - d) ** 2 if n == 0 else 0.5 * (0.5 + d) ** 2


@numba.njit(inline="always")
def slope(x, n, quadratic):
    if not quadratic:
        return 1.0 if n else -1.0
    d = x - int(x + 0.5)
    if n == 1:
        return -2 * d
    return d - 0.5 if n == 0 else d + 0.5


@numba.njit
def sum_over(node, cells):
    node[cells] += node[0]
    node[1] += node[cells + 1]
    node[2] += node[cells + 2]


@numba.njit
def complete(node, mass, cells):
    sum_over(node, cells)
    for i in range(1, cells + 1):
        node[i] /= mass[i]
    node[0] = node[cells]
    node[cells + 1] = node[1]
    node[cells + 2] = node[2]


@numba.njit
def to_nodes(x, q, node, quadratic):
    node[:] = 0
    for p in range(x.size):
        i = first_node(x[p], quadratic)
        for n in range(3 if quadratic else 2):
            node[i + n] += weight(x[p], n, quadratic) * q[p]


@numba.njit
def masses(x, mass, cells, quadratic):
    mass[:] = 0
    for p in range(x.size):
        i = first_node(x[p], quadratic)
        for n in range(3 if quadratic else 2):
            mass[i + n] += weight(x[p], n, quadratic)
    sum_over(mass, cells)


@numba.njit
def to_particles(x, q, node, quadratic):
    for p in range(x.size):
        i = first_node(x[p], quadratic)
        gradient = 0.0
        for n in range(3 if quadratic else 2):
            gradient += slope(x[p], n, quadratic) * node[i + n]
        q[p] += COURANT * gradient


@numba.njit
def move(x, drift, cells):
    for p in range(x.size):
        y = x[p] + drift
        x[p] = y - cells if y >= cells else y


@numba.njit
def march(x, u, r, ui, ri, mass, cells, steps, drift, quadratic):
    masses(x, mass, cells, quadratic)
    for _ in range(steps):
        to_nodes(x, r, ri, quadratic)
        complete(ri, mass, cells)
        to_particles(x, u, ri, quadratic)
        to_nodes(x, u, ui, quadratic)
        complete(ui, mass, cells)
        to_particles(x, r, ui, quadratic)
        if drift != 0:
            move(x, drift, cells)
            masses(x, mass, cells, quadratic)


def main():
    particles, steps, drift = int(sys.argv[1]), int(sys.argv[2]), float(sys.argv[3])
    quadratic = sys.argv[4] == "quadratic"
    cells = particles // PPC
    p = numpy.arange(particles)
    x = p // PPC + (p % PPC + 0.51) / PPC
    u = numpy.sin(2 * numpy.pi * (cells // 32) * x / cells)
    r = numpy.zeros(particles)
    ui, ri, mass = (numpy.zeros(cells + 3) for _ in range(3))
    march(x, u, r, ui, ri, mass, cells, 0, drift, quadratic)  # this call compiles
    start = time.perf_counter()
    march(x, u, r, ui, ri, mass, cells, steps, drift, quadratic)
    seconds = time.perf_counter() - start
    print(json.dumps({"ns_per_particle_step": 1e9 * seconds / particles / steps,
                      "energy": float(numpy.sum(u * u + r * r)) / (2 * particles)}))


if __name__ == "__main__":
    main()
