#!/usr/bin/python3
"""Least limits of random layouts and of lone particles for the schemes that public codes run: the table of docs/step-rules.md.

step_rules.py [--check PAGE]

Each limit is exact for its layout: with the nodal operators S = dt^2 K, A = P2G of G2P and F, the same with the affine part, a
step at rest is stable up to A S = 4 (musl, usf and usavg with flip), (2 - A) S = 4 (usl with flip), S = 2 (1 + F) (usl with
apic). Dense eigenvalues give k = c dt / h. Layouts: a lattice of 2 particles a cell and direction, 50 jittered ones (a particle
anywhere in its part of the cell), 50 with voids (a particle anywhere, three of four cells empty), 200 places of one particle.
In three dimensions there are 10 layouts of each kind, and 100 places.
"""
import os
import sys

import numpy as np
import scipy.linalg

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "python"))
from mpmstab import dt  # noqa: E402 (found by the line above)

CASES = (("musl flip", "hats", "basis", 2, 0.3), ("usl flip", "hats", "basis", 2, 0.3), ("usl flip", "quadratic", "basis", 2, 0.3),
         ("usl apic", "quadratic", "mls", 2, 0.2), ("usl apic", "quadratic", "mls", 2, 0.5), ("usl apic", "quadratic", "mls", 3, 0.3),
         ("usl apic", "quadratic", "basis", 3, 0.3), ("usl apic", "quadratic", "basis", 3, 0.4))
CELLS = {2: 8, 3: 4}


def exact_courant(scheme, x, basis, gradient, nu, cells):
    """The largest stable k of a layout in a periodic box; c = h = 1, volume and mass of a particle alike."""
    lame, mu = nu / (1 - nu), (1 - 2 * nu) / (2 * (1 - nu))
    at = dt.Layout(x, 1, 1, h=1, lame=lame, mu=mu, basis=basis, gradient=gradient, nodes=cells, periodic=True)
    free = np.flatnonzero(at.free[:, 0])
    n, d = len(free), at.dim
    number = np.zeros(len(at.free), int)
    number[free] = np.arange(n)
    A, affine = np.zeros((n, n)), np.zeros((n, n))
    mls = at.g if gradient == "mls" else dt.Layout(x, 1, 1, h=1, lame=lame, mu=mu, basis=basis, gradient="mls", nodes=cells,
                                                   periodic=True).g
    K = np.zeros((n, d, n, d))
    for p in range(at.n):
        used = at.free[at.node[p], 0]
        i, S, g, arm = number[at.node[p][used]], at.S[p][used], at.g[p][used], mls[p][used]
        root = at.root[at.node[p][used], 0]
        at_i = np.ix_(i, i)
        weights = np.outer(root, root)
        np.add.at(A, at_i, weights * np.outer(S, S))
        np.add.at(affine, at_i, weights * (arm @ arm.T) / 4)
        for a in range(d):
            for b in range(d):
                stiff = lame * np.outer(g[:, a], g[:, b]) + mu * np.outer(g[:, b], g[:, a]) + (a == b) * mu * g @ g.T
                K[i[:, None], a, i[None, :], b] += weights * stiff
    K, A, F = K.reshape(n * d, n * d), np.kron(A, np.eye(d)), np.kron(A + affine, np.eye(d))
    one = np.eye(n * d)
    if scheme == "usl apic":
        return np.sqrt(2 / scipy.linalg.eigh(K, one + F, eigvals_only=True)[-1])
    if at.n == 1 and scheme == "musl flip":
        return np.inf  # A sees rigid motion only, and S has none
    values, vectors = np.linalg.eigh(A if scheme == "musl flip" else 2 * one - A)
    root = (vectors * np.sqrt(np.maximum(values, 0))) @ vectors.T
    largest = np.linalg.eigvalsh(root @ K @ root)[-1]
    return np.sqrt(4 / largest) if largest > 0 else np.inf


def layouts(kind, dim, rng):
    cells = CELLS[dim]
    parts = np.stack(np.meshgrid(*[np.arange(2 * cells)] * dim, indexing="ij"), -1).reshape(-1, dim)
    many = 50 if dim == 2 else 10
    if kind == "lattice":
        yield (parts + 0.5) / 2
    if kind == "jittered":
        for _ in range(many):
            yield (parts + rng.random(parts.shape)) / 2
    if kind == "voids":
        for _ in range(many):
            kept = rng.permutation(cells ** dim)[:cells ** dim // 4]
            cell = np.stack(np.unravel_index(np.repeat(kept, 2 ** dim), (cells,) * dim), -1)
            yield cell + rng.random(cell.shape)
    if kind == "lone":
        yield np.full((1, dim), 1 + 1e-6)  # beside a node in each direction: the worst of hats
        yield np.full((1, dim), 1.5 + 1e-6)  # beside the middle of a cell: of quadratic splines
        for _ in range(4 * many if dim == 2 else 10 * many):
            yield 1 + rng.random((1, dim))


def main():
    lines = ["| scheme | basis | gradient | dim | nu | lattice | jittered | voids | lone |", "|---|---|---|---|---|---|---|---|---|"]
    for scheme, basis, gradient, dim, nu in CASES:
        rng = np.random.default_rng(1)
        found = [min(exact_courant(scheme, x, basis, gradient, nu, CELLS[dim]) for x in layouts(kind, dim, rng))
                 for kind in ("lattice", "jittered", "voids", "lone")]
        lines.append(f"| {scheme} | {basis} | {gradient} | {dim} | {nu:g} | " + " | ".join(f"{k:.2f}" if k < 100 else "none" for k in found) + " |")
    if "--check" in sys.argv:
        with open(sys.argv[sys.argv.index("--check") + 1], encoding="utf-8") as file:
            page = file.read()
        missing = [line for line in lines if line not in page]
        if missing:
            sys.exit("step_rules.py: the page does not have\n" + "\n".join(missing))
    else:
        print("\n".join(lines))


if __name__ == "__main__":
    main()
