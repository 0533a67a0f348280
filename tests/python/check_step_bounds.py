#!/usr/bin/python3
"""Checks limit and bounds of layouts from CSV files against dense linear algebra of their own: random layouts in one to three
dimensions, with hats, quadratic and cubic splines, one to four particles a cell, voids, two materials, Poisson's ratios of each particle
and walls.

check_step_bounds.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import math
import sys

import numpy as np

from checks import check, forks, loaded

LIMIT, BOUND = 1e-5, 1e-8


# ---- an own program of the same numbers ----

def spline(degree, r):
    """A spline at distance r from its node, and its slope."""
    a, sign = abs(r), np.sign(r)
    if degree == 1:
        return max(0, 1 - a), -sign * (a < 1)
    if degree == 2:
        if a < 0.5:
            return 0.75 - a * a, -2 * r
        return (1.5 - a) ** 2 / 2 * (a < 1.5), -sign * (1.5 - a) * (a < 1.5)
    if a < 1:
        return 2 / 3 - a * a + a ** 3 / 2, sign * (-2 * a + 1.5 * a * a)
    return (2 - a) ** 3 / 6 * (a < 2), -sign * (2 - a) ** 2 / 2 * (a < 2)


def along(degree, places, cells, walls):
    """Weights and slopes of one direction, for fields that are odd and for those that are even beyond walls."""
    nodes = cells + 1 if walls else cells
    found = np.zeros((2, 2, len(places), nodes))  # odd or even, weight or slope
    for p, x in enumerate(places):
        for i in range(math.floor(x) - 2, math.floor(x) + 4):
            pair = spline(degree, x - i)
            if not walls:
                image, sign = i % cells, 1
            elif i < 0 or i > cells:
                image, sign = (-i if i < 0 else 2 * cells - i), -1
            else:
                image, sign = i, (0 if i in (0, cells) else 1)
            found[0, :, p, image] += sign * np.array(pair)
            found[1, :, p, image] += pair
    return found


def product(tables, parity, kinds):
    """Products over the directions, particles times nodes."""
    out = tables[0][parity, kinds[0]]
    for table, kind in zip(tables[1:], kinds[1:]):
        out = np.einsum("pi,pj->pij", out, table[parity, kind]).reshape(len(out), -1)
    return out


def largest(matrix):
    return np.linalg.eigvalsh(matrix)[-1]


def reference(degree, x, cells, walls, volume, mass, young, nu):
    """Limits of usl and musl with flip, and lambda of lone and particle: of c = rho = h = 1 where young is that of c = 1."""
    dim = x.shape[1]
    tables = [along(degree, x[:, a], cells[a], walls[a]) for a in range(dim)]
    even = product(tables, 1, [0] * dim)
    weight = product(tables, 0, [0] * dim)
    slope = [product(tables, 0, [int(a == b) for b in range(dim)]) for a in range(dim)]
    m = even.T @ mass
    free = (m > 0) & (np.abs(weight).sum(0) + sum(np.abs(g).sum(0) for g in slope) > 0)
    weight, even, m, slope = weight[:, free], even[:, free], m[free], [g[:, free] for g in slope]
    shears = [(a, b) for a in range(dim) for b in range(a)]

    def root(p):  # of the stiffness of particle p, with lambda + 2 mu = 1
        lam, mu = (nu[p] / (1 - nu[p]), (1 - 2 * nu[p]) / (2 * (1 - nu[p]))) if dim > 1 else (0, 0.5)
        C = mu * np.diag([2.0] * dim + [1.0] * len(shears))
        C[:dim, :dim] += lam
        return np.linalg.cholesky(C)

    def B(p, scale):  # engineering strains of particle p
        g = [s[p] * scale for s in slope]
        out = np.zeros((dim + len(shears), dim, len(m)))
        for a in range(dim):
            out[a, a] = g[a]
        for row, (a, b) in enumerate(shears, dim):
            out[row, a], out[row, b] = g[b], g[a]
        return out.reshape(len(out), -1)
    rows = [root(p).T @ B(p, 1 / np.sqrt(m)) * math.sqrt(volume[p] * young[p]) for p in range(len(x))]
    L = np.concatenate(rows)
    A = np.kron(np.eye(dim), (weight / np.sqrt(m)).T @ (mass[:, None] * (weight / np.sqrt(m))))
    usl = math.sqrt(2 / largest(L @ (np.eye(len(A)) - A / 2) @ L.T))
    value, vector = np.linalg.eigh(A)
    half = vector * np.sqrt(np.maximum(value, 0))
    musl = math.sqrt(4 / largest(half.T @ L.T @ L @ half))
    norm = np.sqrt(sum(g ** 2 for g in slope))
    with np.errstate(divide="ignore", invalid="ignore"):
        alone = np.where(norm > 0, np.sqrt(volume[:, None] * young[:, None] / (mass[:, None] * even)), 0)
        share = np.where(norm > 0, np.sqrt(young[:, None] * (volume @ norm) / (m * norm)), 0)
    lone, particle = (max(largest(b @ b.T) for b in (root(p).T @ B(p, s[p]) for p in range(len(x))))
                      for s in (alone, share))
    return usl, musl, lone, particle, largest(L @ L.T)


# ---- layouts ----

def layout(rng, dim, ppc, voids):
    """Random particles with volumes, in some of the cells."""
    cells = ((9,), (5, 4), (3, 2, 2))[dim - 1]
    n = ppc * math.prod(cells)
    x = rng.random((n, dim)) * cells
    if voids:
        keep = rng.random(cells) > 0.4
        x = x[[bool(keep[tuple(place)]) for place in x.astype(int)]]
    if not len(x):
        x = rng.random((1, dim)) * cells
    return cells, x, rng.uniform(0.5, 1.5, len(x)) / ppc


def compare(rng, case, dim, degree, ppc, voids, two, walls):
    cells, x, volume = layout(rng, dim, ppc, voids)
    heavy = x[:, 0] > cells[0] / 2
    mass = volume * np.where(heavy & two, 5, 1)
    young = np.where(heavy & two, 20.0, 1.0)
    ends = [False] * (dim - 1) + [walls]
    nu = rng.uniform(0, 0.49, len(x)) if case % 2 else np.full(len(x), 0.25)
    modulus = 1 if dim == 1 else (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    h, rho, c = 0.5, 3.0, 2.0
    columns = [*(x * h).T, volume * h ** dim, mass * rho * h ** dim, young * rho * c * c / modulus]
    header = "x,y,z"[:2 * dim - 1] + ",volume,mass,young"
    if dim > 1:
        columns.append(nu)
        header += ",poisson"
    np.savetxt("layout.csv", np.stack(columns, 1), delimiter=",", header=header, comments="", fmt="%.17g")
    usl, musl, lone, particle, most = reference(degree, x, cells, ends, volume, mass, young, nu)
    boundary = ",".join("fixed-fixed" if wall else "periodic" for wall in ends) if dim > 1 else (
        "fixed" if walls else "periodic")
    for formulation, limit, factor in (("usl", usl, 2), ("musl", musl, 4)):
        words = (f"critical {formulation} -dim {dim} -basis {('linear', 'quadratic', 'cubic')[degree - 1]} "
                 f"-cells {','.join(map(str, cells))} -cell_width {h} -density {rho} -sound_speed {c} "
                 f"-boundary {boundary} -layout layout.csv -json out.json -step_bound_sweeps 3")
        done = forks.run([sys.argv[2], *words.split()], capture_output=True, text=True, check=False)
        check(done.returncode == 0, f"{case}, {words}: {done.stderr}")
        found = loaded("out.json")["critical"]
        bounds = found["bounds"]
        for name, mine, its, tolerance in (
                ("limit", limit, found["critical_courant"], LIMIT),
                ("lone", math.sqrt(factor / lone), bounds["lone"], BOUND),
                ("particle", math.sqrt(factor / particle), bounds["particle"], BOUND)):
            check(math.isclose(mine, its, rel_tol=tolerance, abs_tol=1e-12), f"{case}, {words}: {name} {its}, not {mine}")
        exact = math.sqrt(factor / most)
        check(bounds["particle"] <= bounds["swept"] <= exact * (1 + 1e-9) and exact <= limit * (1 + 1e-9) and
              bounds["lanczos"] <= exact * (1 + 1e-9), f"{case}, {words}: {bounds}, {exact}, {limit}")
        check(bounds["lanczos"] > 0.8 * exact, f"{case}, {words}: the certificate is poor, {bounds}, {exact}")


random = np.random.default_rng(7)
for number in range(16):
    for dimension in (1, 2, 3) if number % 4 == 1 else (1, 2):
        compare(random, number, dimension, 1 + number % 3, 1 + number % 4, number % 5 > 2, number % 2 == 1,
                number % 7 > 4)
