#!/usr/bin/python3
"""Compares limits and bounds of random layouts with dense linear algebra: one to three dimensions, walls or none, one material
or two, some particles held.

check_layout_limits.py MPIEXEC MPMSTAB [LAYOUTS [SEED]], in a folder that may be filled. Silent when all is well.
"""
import itertools
import json
import math
import sys

import numpy

from checks import check, forks

FIELDS = ("volume", "mass", "young", "fixed")


def weights(basis, x):
    """The first node, weights and slopes at a place in cells, by the definitions of the splines."""
    if basis == "linear":
        first = math.floor(x)
        return first, [1 - (x - first), x - first], [-1, 1]
    first = math.floor(x - 0.5)
    f = x - first
    return first, [(1.5 - f) ** 2 / 2, 0.75 - (f - 1) ** 2, (f - 0.5) ** 2 / 2], [f - 1.5, 2 - 2 * f, f - 0.5]


def shapes(case, x):
    """Weight S[c, node] and gradient G[c, b, node] of component c of a velocity; walls mirror the normal one."""
    dim, cells, n = case["dim"], case["cells"], case["nodes"]
    along = [weights(case["basis"], at) for at in x]
    S, G, mass = numpy.zeros((dim, n**dim)), numpy.zeros((dim, dim, n**dim)), numpy.zeros(n**dim)
    for k in itertools.product(*[range(len(one[1])) for one in along]):
        sign, node = numpy.ones(dim), 0
        for a in range(dim):
            i = along[a][0] + k[a]
            if case["walls"] and not 0 <= i <= cells:
                i, sign[a] = (-i if i < 0 else 2 * cells - i), -1
            node += (i % n) * n**a
        value = [along[a][1][k[a]] for a in range(dim)]
        slope = [along[a][2][k[a]] for a in range(dim)]
        mass[node] += numpy.prod(value)
        S[:, node] += sign * numpy.prod(value)
        for b in range(dim):
            G[:, b, node] += sign * numpy.prod([slope[a] if a == b else value[a] for a in range(dim)])
    return S, G, mass


def dense_limit(case, x, field):
    """1 / sqrt of the largest eigenvalue of K (1 - A / 2) / 2 for usl and K A / 4 for musl, A = P2G G2P of what moves."""
    dim, n, nu = case["dim"], case["nodes"], case["poisson"]
    size = dim * n**dim
    K, A, m = numpy.zeros((size, size)), numpy.zeros((size, size)), numpy.zeros(n**dim)
    mu, lame = ((1 - 2 * nu) / (2 * (1 - nu)), nu / (1 - nu)) if dim > 1 else (0.5, 0)
    for p, place in enumerate(x):
        S, G, mass = shapes(case, place)
        B, T = numpy.zeros((dim, dim, size)), numpy.zeros((dim, size))
        for c in range(dim):
            B[c, :, c * n**dim:(c + 1) * n**dim] = G[c]
            T[c, c * n**dim:(c + 1) * n**dim] = S[c]
        strain = (B + B.transpose(1, 0, 2)) / 2
        stress = 2 * mu * strain + lame * numpy.einsum("cb,aai->cbi", numpy.eye(dim), strain)
        K += field["volume"][p] * field["stiffness"][p] * numpy.einsum("cbi,cbj->ij", strain, stress)
        A += field["mass"][p] * (1 - field["fixed"][p]) * T.T @ T
        m += field["mass"][p] * mass
    moves = numpy.tile(m, dim) > 0
    for c, node in itertools.product(range(dim), range(n**dim)):
        if case["walls"] and node // n**c % n in (0, n - 1):
            moves[c * n**dim + node] = False
    K, A, root = K[moves][:, moves], A[moves][:, moves], numpy.sqrt(numpy.tile(m, dim)[moves])
    K, A = K / root / root[:, None], A / root / root[:, None]
    pencil = K @ (numpy.eye(len(K)) - A / 2) / 2 if case["formulation"] == "usl" else K @ A / 4
    return 1 / math.sqrt(max(numpy.linalg.eigvals(pencil).real.max(), 1e-30))


def draw(random, number):
    """A case at random with its places and fields: volumes from 0.3 to 2 of the share of a cell."""
    dim = 1 + number % 3
    case = {"dim": dim, "cells": int({1: random.integers(5, 14), 2: random.integers(4, 7), 3: 3 + random.integers(0, 2)}[dim]),
            "basis": str(random.choice(["linear", "quadratic"])), "formulation": str(random.choice(["usl", "musl"])),
            "walls": bool(random.integers(2)), "poisson": float(random.choice([0, 0.2, 0.4]))}
    case["nodes"] = case["cells"] + case["walls"]
    x = random.random((int(case["cells"] ** dim * random.choice([1, 2, 3])), dim)) * case["cells"]
    if random.random() < 0.4:
        x = x[x[:, 0] < max(0.6 * case["cells"], x[:, 0].min() + 1e-9)]
    second = (random.random() < 0.5) & (x[:, 0] > case["cells"] / 2)
    volume = random.uniform(0.3, 2, len(x)) / 2**dim
    field = {"volume": volume, "mass": volume * numpy.where(second, 4, 1), "stiffness": numpy.where(second, 9.0, 1.0),
             "fixed": (random.random(len(x)) < random.choice([0, 0, 0.3])).astype(int)}
    nu = case["poisson"]
    field["young"] = field["stiffness"] * ((1 + nu) * (1 - 2 * nu) / (1 - nu) if dim > 1 else 1)
    return case, x, field


def look(case, x, field):
    with open("layout.csv", "w", encoding="utf-8") as file:
        file.write(",".join(["xyz"[a] for a in range(case["dim"])] + list(FIELDS)) + "\n")
        for p, place in enumerate(x):
            file.write(",".join(repr(float(number)) for number in [*place, *(field[name][p] for name in FIELDS)]) + "\n")
    words = ["-dim", case["dim"], "-basis", case["basis"], "-cells", case["cells"], "-length", case["cells"],
             *(["-poisson", case["poisson"]] if case["dim"] > 1 else []), *(["-boundary", "symmetry"] if case["walls"] else [])]
    done = forks.run([sys.argv[2], "critical", case["formulation"], *(str(word) for word in words), "-layout", "layout.csv",
                      "-step_bound_sweeps", "3", "-json", "out.json"], capture_output=True, text=True, check=False)
    check(done.returncode == 0, f"{case}: {done.stderr}")
    with open("out.json", encoding="utf-8") as file:
        found = json.load(file)["critical"]
    exact = dense_limit(case, x, field)
    if exact > 60:
        return
    check(math.isclose(found.get("critical_courant", 0), exact, rel_tol=1e-5), f"{case}: {found}, dense {exact}")
    for name in ("lone", "particle", "swept", "lanczos"):
        check(found["bounds"][name] <= exact * (1 + 1e-9), f"{case}: bound {name} of {found['bounds']} is above {exact}")


def main():
    random = numpy.random.default_rng(int(sys.argv[4]) if len(sys.argv) > 4 else 1)
    for number in range(int(sys.argv[3]) if len(sys.argv) > 3 else 15):
        look(*draw(random, number))


main()
