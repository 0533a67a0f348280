#!/usr/bin/python3
"""Looks for random moving scenes in which a step grows, and says how many grow and by how much.

quiet_search.py FORMULATION [--scenes N] [--seed N] [--dim 1|2] [--from DRIFT] [--to DRIFT] [--validate N] [--worst N]
                [--transfer NAME] [--basis NAME] [--share LEAST] [--phases N]
quiet_search.py --table | --check FILE [--all]

FORMULATION is usl, musl, verlet, rk4 or kg5. A scene is a periodic box of 4 to 10 cells in one dimension or of 4 x 4 in two,
with flip or apic, gradients of the basis or mls, hats, quadratic or cubic splines, 1 to 4 particles a cell (or some cells
without any), jittered by 0 to a whole distance of particles. It moves by --from to --to cells a step. k is --share (0.2) to 0.97 of
the limit that the scheme has with flip at rest, whatever the layout: 2 / sqrt(L) for verlet and musl, sqrt(2 / L) for usl,
and the edge of the method over sqrt(L) for rk4 and kg5. L is the largest eigenvalue of the nodes that a step of the
period has. A scene grows if the spectral radius of its period is above 1 + 1e-6 a step. apic on hats is left out, unless
--transfer hats asks for nothing else. --transfer NAME asks for another transfer alone. mpmstab itself computes those that are
not written here: aflip, fmpm, tpic.

The steps are written anew here, with numpy. --validate N compares N scenes with 'mpmstab spectrum', and all scenes that
are printed are computed by it, too. A box holds its own waves alone: with --phases N the box is repeated N times in each direction,
which has all waves of a larger box (scenes that are compared with mpmstab have N = 1). --table prints the shares of transfers, of 1600 scenes in one dimension each. The numbers
are those of docs/ringing.md. --check FILE validates scenes of each formulation, dimension and transfer, and refuses a
file that lacks two of the rows. The environment variable MPMSTAB names the program.
"""
import itertools
import math
import os
import sys

os.environ.setdefault("OMP_NUM_THREADS", "1")

from program import Parser, end_in_one_line, launch, refuse, require_input, require_program  # noqa: E402
import numpy as np  # noqa: E402

GROWS = 1e-6
BATCH = 8
POISSON = 0.3
EDGE = {"verlet": 2, "musl": 2, "usl": math.sqrt(2), "rk4": math.sqrt(8), "kg5": 4}
STAGES = {"rk4": (1 / 4, 1 / 3, 1 / 2, 1), "kg5": (1 / 4, 1 / 6, 3 / 8, 1 / 2, 1)}
BLEND = 0.95
OWN = ("flip", "apic", "pic", "blend", "xpic")  # the transfers that are written anew here
TRANSFERS = (("flip", "basis"), ("flip", "mls"), ("apic", "basis"), ("apic", "mls"))


# ---- random numbers of mpmstab's layouts: docs/theory.md, section 1 ----

def mix(z):
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def hashed(seed, number):
    """Returns a random number in [0, 1) for each seed and number (integers, which may be negative)."""
    with np.errstate(over="ignore"):
        z = np.asarray(seed, np.int64).astype(np.uint64) + (np.asarray(number, np.int64).astype(np.uint64)
                                                            + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
        return (mix(z) >> np.uint64(11)).astype(float) * 2.0 ** -53


# ---- a family: scenes that differ by seed, jitter, offset and Courant number, so that arrays hold all of them ----

def draw(rng, formulation, dims, drifts, only, basis):
    """Returns the options that the scenes of a family share. only: the transfer, or None; basis: or None."""
    dim = int(rng.choice(dims))
    drawn = str(rng.choice(["linear", "quadratic", "cubic"])) if only != "hats" else "linear"
    basis = basis or drawn
    allowed = TRANSFERS[2:3] if only == "hats" else TRANSFERS[:1] if basis == "linear" else TRANSFERS
    if only not in (None, "hats"):
        allowed = [("apic", "mls") if only == "mls" else (only, "basis")]
    transfer, gradient = allowed[rng.integers(len(allowed))]
    drift = math.exp(rng.uniform(math.log(drifts[0]), math.log(drifts[1])))
    period = int(rng.integers(math.ceil(1 / drift), min(100, 3 * math.ceil(1 / drift)) + 1))
    moves = [max(1, round(drift * period))]
    if dim == 2:
        moves.append(int(rng.integers(-moves[0], moves[0] + 1)))
    family = {"formulation": formulation, "dim": dim, "basis": basis, "transfer": transfer, "gradient": gradient,
              "period": period, "moves": moves, "counts": None}
    if dim == 2:
        family["cells"] = 4
        family["ppc"] = [int(n) for n in ([1, 1], [2, 1], [1, 2], [2, 2])[rng.choice(4, p=[0.7, 0.13, 0.13, 0.04])]]
        return family
    family["cells"] = int(rng.integers(4, 11))
    family["ppc"] = [int(rng.integers(1, 5))]
    if rng.random() < 0.4:  # cells without particles
        counts = [0]
        while sum(counts) == 0:
            counts = [int(n) for n in rng.integers(0, family["ppc"][0] + 2, family["cells"]) * (rng.random(family["cells"]) < 0.7)]
        family["counts"] = counts
    return family


def sites(family):
    """Returns the cell, the place in the cell's sequence and the count of each particle, by direction, and its number."""
    if family["dim"] == 1:
        counts = family["counts"] or family["ppc"] * family["cells"]
        cell = np.repeat(np.arange(len(counts)), counts)
        j = np.concatenate([np.arange(n) for n in counts])
        return [(cell, j, np.repeat(counts, counts))], np.arange(len(cell))
    rows = [family["cells"] * n for n in family["ppc"]]
    y, x = np.divmod(np.arange(rows[0] * rows[1]), rows[0])
    return [(site // n, site % n, n) for site, n in zip((x, y), family["ppc"])], y * rows[0] + x


def places(family, seed, offset, jitter):
    """Returns where particles start, in cells: scenes x particles x directions."""
    along, number = sites(family)
    result = []
    for axis, (cell, j, count) in enumerate(along):
        own = seed if axis == 0 else (2.0 ** 52 * hashed(seed + 1, -64 - 2 - axis)).astype(np.int64)
        moved = jitter[:, None] * (hashed(own[:, None], number[None, :]) - 0.5)
        result.append(cell + (j + offset[:, None] + moved) / count)
    return np.stack(result, axis=2)


def spline(basis, d):
    """Returns a basis function and its derivative at a distance d from its node, in cells."""
    a = np.abs(d)
    if basis == "linear":
        return np.maximum(0, 1 - a), np.where(a < 1, np.where(d >= 0, -1.0, 1.0), np.where(d == -1, 1.0, 0.0))
    if basis == "quadratic":
        return (np.where(a < 0.5, 0.75 - d * d, np.where(a < 1.5, (1.5 - a) ** 2 / 2, 0)),
                np.where(a < 0.5, -2 * d, np.where(a < 1.5, -np.sign(d) * (1.5 - a), 0)))
    return (np.where(a < 1, 2 / 3 - a * a + a ** 3 / 2, np.where(a < 2, (2 - a) ** 3 / 6, 0)),
            np.where(a < 1, -2 * d + 1.5 * d * a, np.where(a < 2, -np.sign(d) * (2 - a) ** 2 / 2, 0)))


class Grid:
    """The frozen grid of one step: its weights, and the maps between particles and nodes.

    phase: by how much a wave differs from the box to the next one, along each direction. None: the box is periodic.
    """

    def __init__(self, family, x, phase=None):
        n, dim = family["cells"], family["dim"]
        values, slopes, arms, bare = [], [], [], []
        for axis in range(dim):
            away = x[:, :, axis, None] - np.arange(n)
            d = (away + n / 2) % n - n / 2
            value, slope = spline(family["basis"], d)
            turn = np.exp(1j * phase[axis] * np.round((away - d) / n)) if phase else 1.0
            bare.append(value)
            values.append(value * turn)
            slopes.append(slope * turn)
            arms.append(-d)

        def product(factors):
            if dim == 1:
                return factors[0]
            return (factors[1][:, :, :, None] * factors[0][:, :, None, :]).reshape(*x.shape[:2], n * n)

        self.weight = product(values)
        count = [c for _, _, c in sites(family)[0]]
        self.mass = np.broadcast_to(1 / np.prod([np.broadcast_to(c, x.shape[1]) for c in count], axis=0), x.shape[:2])
        self.node_mass = np.einsum("bpi,bp->bi", product(bare), self.mass)
        self.inverse = np.where(self.node_mass > 0, 1 / np.where(self.node_mass > 0, self.node_mass, 1), 0)
        self.arm, self.slope = [], []
        for axis in range(dim):
            one = np.ones_like(values[0])
            lever = self.weight * product([arms[axis] if b == axis else one for b in range(dim)])
            second = np.sum(bare[axis] * arms[axis] ** 2, axis=2)[:, :, None]
            self.arm.append((lever, lever / np.where(second > 0, second, 1)))
            self.slope.append(self.arm[axis][1] if family["gradient"] == "mls" else
                              product([slopes[b] if b == axis else values[b] for b in range(dim)]))
        self.transfer = family["transfer"]
        self.affine = self.transfer == "apic"
        self.dim = dim

    def down(self, lever):
        return np.conj(np.swapaxes(lever * self.mass[:, :, None], 1, 2))

    def to_nodes(self, v, c):
        """v: scenes x particles x components x columns; c: one such array for each direction of the affine part."""
        sum_ = times(self.down(self.weight), v)
        if self.affine:
            sum_ = sum_ + sum(times(self.down(lever), part) for (lever, _), part in zip(self.arm, c))
        return self.inverse[:, :, None, None] * sum_

    def to_particles(self, y):
        return times(self.weight, y)

    def affine_of(self, y):
        return [times(lever, y) for _, lever in self.arm] if self.affine else []

    def strain(self, y):
        """The stress that a velocity makes in unit time, in units of the P wave's modulus."""
        if self.dim == 1:
            return times(self.slope[0], y)
        lame = POISSON / (1 - POISSON)
        dx, dy = (times(slope, y) for slope in self.slope)
        return np.stack([dx[:, :, 0] + lame * dy[:, :, 1], lame * dx[:, :, 0] + dy[:, :, 1],
                         (1 - lame) / 2 * (dy[:, :, 0] + dx[:, :, 1])], axis=2)

    def force(self, s):
        """The acceleration of the nodes, -DIV s."""
        if self.dim == 1:
            sum_ = times(self.down(self.slope[0]), s)
        else:
            sum_ = (times(self.down(self.slope[0]), s[:, :, [0, 2]]) + times(self.down(self.slope[1]), s[:, :, [2, 1]]))
        return -self.inverse[:, :, None, None] * sum_

    def largest(self):
        """The largest eigenvalue of the nodes, of M^-1 K."""
        nodes = self.weight.shape[2] * self.dim
        unit = np.broadcast_to(np.eye(nodes).reshape(-1, self.dim, nodes), (len(self.weight), nodes // self.dim, self.dim, nodes))
        k = -(self.force(self.strain(unit)) * self.node_mass[:, :, None, None]).reshape(-1, nodes, nodes)
        root = np.repeat(np.sqrt(self.inverse), self.dim, axis=1)
        return np.linalg.eigvalsh(root[:, :, None] * k * root[:, None, :])[:, -1]


def times(matrix, field):
    """A matrix of each scene times a field: scenes x points x components x columns."""
    shape = field.shape
    return (matrix @ field.reshape(shape[0], shape[1], -1)).reshape(shape[0], matrix.shape[1], *shape[2:])


# ---- the steps ----

def kept(grid, v, y):
    """What a transfer makes of the particles' velocity before it adds what the nodes gained. y: the nodal velocity."""
    if grid.transfer == "flip":
        return v
    if grid.transfer == "blend":
        return BLEND * v + (1 - BLEND) * grid.to_particles(y)
    if grid.transfer == "xpic":  # of order 2
        return grid.to_particles(2 * y - grid.to_nodes(grid.to_particles(y), []))
    return grid.to_particles(y)


def step(formulation, grid, k, v, c, s):
    """Takes a step with particles where they are. Returns v and s of particles, and the nodal velocity after the step."""
    old = grid.to_nodes(v, c)
    first = s
    if formulation == "verlet":
        s = s + k / 2 * grid.strain(old)
    a = k * grid.force(s)
    seen = old
    for share in STAGES.get(formulation, ())[:-1]:
        q = first + share * k * grid.strain(seen)
        seen = grid.to_nodes(v + share * grid.to_particles(a), c) if grid.transfer == "flip" else old + share * a
        a = k * grid.force(q)
    new = old + a
    v = kept(grid, v, old) + grid.to_particles(a)
    if formulation not in STAGES:
        seen = grid.to_nodes(v, grid.affine_of(new)) if formulation == "musl" else new
    return v, s + (k / 2 if formulation == "verlet" else k) * grid.strain(seen), new


def growths(family, seed, offset, jitter, share, phases=1):
    """Returns k and the growth per step of each scene of a family, the largest over the phases from a box to the next."""
    x = places(family, seed, offset, jitter)
    drift = np.array(family["moves"]) / family["period"]
    turns = [None, *(tuple(2 * math.pi * j / phases for j in turn) for turn in itertools.product(range(phases), repeat=family["dim"])
                     if (0,) * len(turn) < turn <= tuple(-j % phases for j in turn))]  # the matrix of -phase is the conjugate
    grids = {turn: [Grid(family, x + t * drift, turn) for t in range(family["period"])] for turn in turns}
    limit = EDGE[family["formulation"]] / np.sqrt(np.max([grid.largest() for turn in turns for grid in grids[turn]], axis=0))
    k = np.array([float(f"{value:.4g}") for value in share * limit])
    if family["transfer"] not in OWN:
        return k, np.array([by_program(options_of(family, *one))[0] for one in zip(seed, offset, jitter, k)])
    return k, np.max([growth_of(family, x, turn, grids[turn], k) for turn in turns], axis=0)


def growth_of(family, x, phase, grids, k):
    """Returns the growth per step of each scene at a phase."""
    drift = np.array(family["moves"]) / family["period"]
    particles, dim, scenes = x.shape[1], family["dim"], len(x)
    nodes, stresses = family["cells"] ** dim, 3 if dim == 2 else 1
    first = nodes if family["transfer"] == "apic" else particles  # an apic step forgets all but nodal velocities
    n = first * dim + particles * stresses
    unit = np.broadcast_to(np.eye(n), (scenes, n, n))
    v = unit[:, :first * dim].reshape(scenes, first, dim, n)
    s = unit[:, first * dim:].reshape(scenes, particles, stresses, n)
    c, by_k = [], k[:, None, None, None]
    if family["transfer"] == "apic":
        before = Grid(family, x - drift, phase)
        v, c = before.to_particles(v), before.affine_of(v)
    for grid in grids:
        v, s, new = step(family["formulation"], grid, by_k, v, c, s)
        c = grid.affine_of(new)
    if family["transfer"] == "apic":  # the nodes of the last step, counted as those before the first one
        v = new.reshape(scenes, *[family["cells"]] * dim, -1)
        for axis in range(dim):
            boxes = np.floor((np.arange(family["cells"]) + family["moves"][axis]) / family["cells"])
            turn = np.exp(1j * phase[axis] * boxes) if phase else np.ones(family["cells"])
            v = np.roll(v, -family["moves"][axis], axis=dim - axis) * np.expand_dims(turn, [a for a in range(v.ndim) if a != dim - axis])
    period = np.concatenate([v.reshape(scenes, first * dim, n), s.reshape(scenes, particles * stresses, n)], axis=1)
    radius = np.max(np.abs(np.linalg.eigvals(period)), axis=1)
    return radius ** (1 / family["period"])


# ---- scenes as options of mpmstab ----

def options_of(family, seed, offset, jitter, k):
    rk = family["formulation"] in STAGES
    options = {"formulation": "rk" if rk else family["formulation"], **({"rk": family["formulation"]} if rk else {}),
               "dim": family["dim"], "cells": family["cells"], "basis": family["basis"], "transfer": family["transfer"],
               "gradient": family["gradient"], "offset": f"{offset:.3f}", "jitter": f"{jitter:.2f}", "seed": int(seed),
               "drift": ",".join(f"{m}/{family['period']}" for m in family["moves"]), "courant": f"{k:.4g}"}
    options.update({"counts": ",".join(map(str, family["counts"]))} if family["counts"] else
                   {"ppc": ",".join(map(str, family["ppc"]))})
    if family["dim"] == 2:
        options["poisson"] = POISSON
    return options


def by_program(options):
    """Returns growth by mpmstab, and its verdict."""
    status, found, error = launch("spectrum", options=options)
    if status:
        refuse(f"{options}: {error}")
    return found["growth"], found["verdict"]


def search(formulation, scenes, seed, dims, drifts, only=None, basis=None, least=0.2, phases=1):
    """Yields the family, its numbers, k and growth of each batch of scenes."""
    rng = np.random.default_rng(seed)
    while scenes > 0:
        n = min(BATCH, scenes)
        family = draw(rng, formulation, dims, drifts, only, basis)
        numbers = [rng.integers(1, 2 ** 31, n), np.round(rng.uniform(0, 1, n), 3) % 1,
                   np.where(rng.random(n) < 0.15, 0, np.round(rng.uniform(0, 1, n), 2))]
        k, growth = growths(family, *numbers, rng.uniform(least, 0.97, n), phases)
        yield family, numbers, k, growth
        scenes -= n


def interval(found):
    """The 95 % interval of a share (Wilson 1927). found: the shares of the batches, whose scenes are alike and count as fewer."""
    z, p = 1.96, float(np.mean(found))
    spread = float(np.var(found, ddof=1)) if len(found) > 1 else 0
    of = len(found) if spread == 0 else min(BATCH * len(found), p * (1 - p) / (spread / len(found)))
    middle, width = p + z * z / 2 / of, z * math.sqrt(p * (1 - p) / of + z * z / 4 / of / of)
    return max(0, (middle - width) / (1 + z * z / of)), (middle + width) / (1 + z * z / of)


def validate(formulation, scenes, seed, dims, drifts, only=None):
    """Refuses where mpmstab finds another growth. One scene of each batch is compared."""
    worst = 0
    for family, numbers, k, growth in search(formulation, scenes * BATCH, seed, dims, drifts, only):
        options = options_of(family, *(column[0] for column in numbers), k[0])
        found, _ = by_program(options)
        error = abs(found - growth[0])
        worst = max(worst, error)
        if error > 1e-6 * max(1, growth[0] - 1):
            refuse(f"{' '.join(f'-{name} {value}' for name, value in options.items())}: growth {growth[0]:.10f}, "
                   f"mpmstab's {found:.10f}")
    print(f"{formulation}: {scenes} scenes agree with mpmstab spectrum to {worst:.1e}", flush=True)


def tell(formulation, batches, most):
    """Prints shares, the largest growths, and the worst scenes."""
    classes, worst, least = {}, [], math.inf
    for family, numbers, k, growth in batches:
        ppc = "voids" if family["counts"] else "x".join(map(str, family["ppc"]))
        drift = math.hypot(*family["moves"]) / family["period"]
        size = "to 0.05" if drift <= 0.05 else "to 0.2" if drift <= 0.2 else "above"
        for name in ("all", f"{family['dim']}-D", f"{family['dim']}-D ppc {ppc}", f"basis {family['basis']}",
                     f"{family['transfer']} {family['gradient']}", f"drift {size}"):
            one = classes.setdefault(name, [0, 0, 0.0, []])
            one[0] += len(k)
            one[1] += int(np.sum(growth > 1 + GROWS))
            one[2] = max(one[2], float(np.max(growth)) - 1)
            one[3].append(float(np.mean(growth > 1 + GROWS)))
        if np.any(growth > 1 + GROWS):
            least = min(least, drift)
        worst += [(growth[i] - 1, options_of(family, *(column[i] for column in numbers), k[i]))
                  for i in np.flatnonzero(growth > 1 + GROWS)]
        worst = sorted(worst, key=lambda scene: -scene[0])[:most]
    for name in ["all", *sorted(name for name in classes if name != "all")]:
        of, found, largest, shares = classes[name]
        low, high = interval(shares)
        print(f"{formulation} {name}: {found} of {of} grow, {100 * found / of:.3g} % ({100 * low:.2g} to {100 * high:.2g}), "
              f"by at most {largest if largest > GROWS else 0:.1e}")
    if worst:
        print(f"{formulation}: the smallest drift with growth is {least:.4g}")
    for growth, options in worst:
        found, verdict = by_program(options)
        print(f"{growth:.2e} {found - 1:.2e} {verdict} " + " ".join(f"-{name} {value}" for name, value in options.items()))


# ---- the tables of the page ----

# What the page says, in which {share}, {count}, {largest} and {drift} are computed: formulation, dimension, number of scenes, and the
# arguments of search() that differ.
STUDIES = {
    **{f"| {step}, 1-D | {{share}} of 8,000{{largest}} |": (step, 1, 8000, {}) for step in ("usl", "musl", "rk4", "kg5")},
    **{f"| {step}, 2-D | {{share}} of 800{{largest}} |": (step, 2, 800, {}) for step in ("usl", "musl", "rk4", "kg5")},
    "| verlet, 1-D | {share} of 80,000{largest} |": ("verlet", 1, 80000, {}),
    "| verlet, 2-D | {share} of 16,000{largest} |": ("verlet", 2, 16000, {"seed": 2}),
    "Of 4,000 more scenes of verlet in two dimensions {count} grew{largest}.": ("verlet", 2, 4000, {}),
    "of 20,000 more with drifts from 0.15 to 0.3 {count} did": ("verlet", 1, 20000, {"seed": 3, "drifts": (0.15, 0.3)}),
    "of 8,000 scenes on hats with k from 0.8 of the limit and drifts from 1/16 to 1/8 {count} grew{largest}, from a drift of {drift} on":
        ("verlet", 1, 8000, {"drifts": (1 / 16, 1 / 8), "only": "flip", "basis": "linear", "least": 0.8}),
    **{f"| {step}, 1-D | {n} | {{share}} of 1,600{{largest}} |": (step, 1, 1600, {"phases": n})
       for step in ("usl", "musl", "verlet") for n in (1, 2, 4, 8)},
    "rk4 grows in {share} of 2,000 scenes": ("rk4", 1, 2000, {"only": "hats"}),
    "verlet in {share}": ("verlet", 1, 2000, {"only": "hats"}),
    "aflip grows in {share} of 480 scenes": ("rk4", 1, 480, {"only": "aflip", "drifts": (0.05, 0.5)}),
    "tpic in {count} of 200 on quadratic splines": ("rk4", 1, 200, {"only": "tpic", "basis": "quadratic", "drifts": (0.05, 0.5)}),
}


def words_of(template):
    """Returns what the page says of a study."""
    formulation, dim, scenes, more = STUDIES[template]
    found, least = [], math.inf
    for family, _, _, growth in search(formulation, scenes, **{"seed": 1, "dims": [dim], "drifts": (0.01, 0.5), **more}):
        found.append(growth)
        if np.any(growth > 1 + GROWS):
            least = min(least, math.hypot(*family["moves"]) / family["period"])
    low, high = interval([float(np.mean(growth > 1 + GROWS)) for growth in found])
    growth = np.concatenate(found)
    count = int(np.sum(growth > 1 + GROWS))
    share = f"{100 * count / scenes:.2g}% ({100 * low:.2g} to {100 * high:.2g})" if count else f"none (to {100 * high:.2g}%)"
    largest = f", by at most {np.max(growth) - 1:.1e}".replace("e-0", "e-") if count else ""
    return template.format(share=share, count=count, largest=largest, drift=f"{least:.3g}")


ROWS = [(step, transfer) for step in ("usl", "musl", "verlet") for transfer in ("flip", "blend", "xpic", "pic", "apic", "mls")]
TABLE_SCENES = 1600
NAMES = {"apic": "apic", "mls": "apic, gradient mls"}


def share_of(found, digits=2):
    """Says which share of scenes grows, with its interval, and by how much at most."""
    def percent(share):
        return f"{float(f'{100 * share:.{digits}g}'):g}"  # 100, not 1e+02
    low, high = interval([float(np.mean(growth > 1 + GROWS)) for growth in found])
    growth = np.concatenate(found)
    if np.max(growth) <= 1 + GROWS:
        return f"0 % (to {percent(high)})"
    return f"{percent(np.mean(growth > 1 + GROWS))} % ({percent(low)} to {percent(high)}), {np.max(growth) - 1:.1e}"


def row_of(step, transfer):
    """Returns the cells of a row: on hats and on splines."""
    found = {True: [], False: []}
    for family, _, _, growth in search(step, TABLE_SCENES, 1, [1], (0.01, 0.5), transfer):
        found[family["basis"] == "linear"].append(growth)
    return f"{step}, {NAMES.get(transfer, transfer)}", share_of(found[True]), share_of(found[False])


def check_phases():
    """Refuses where a lattice in a box has other growth, over the phases from a box to the next, than in a box twice as long."""
    for dim, transfer, formulation in ((1, "flip", "musl"), (1, "apic", "usl"), (2, "flip", "usl"), (2, "apic", "usl")):
        found = []
        for cells, phases in ((4, 2), (8, 1)) if dim == 1 else ((3, 2), (6, 1)):
            family = {"formulation": formulation, "dim": dim, "basis": "linear", "transfer": transfer, "gradient": "basis", "period": 8 // dim,
                      "moves": [1, 2][:dim], "counts": None, "cells": cells, "ppc": [2, 1][:dim]}
            found.append(growths(family, np.array([1]), np.array([0.3]), np.array([0.0]), np.array([0.7]), phases))
        apart = max(abs(a[0] - b[0]) for a, b in zip(*found))
        if apart > 1e-9 or found[0][1] < 1 + GROWS:
            refuse(f"{formulation} {transfer} {dim}-D: k and growth {found[0]} by phases, {found[1]} in a box twice as long")


def check(path, whole):
    """Compares scenes with mpmstab, and refuses a page that has other numbers."""
    check_phases()
    for formulation in EDGE:
        for dim, transfer in ((1, None), (2, None), *((1, transfer) for transfer in OWN[2:])):
            validate(formulation, 4, 1, [dim], (0.2, 0.5), transfer)
    with open(path, encoding="utf-8") as file:
        text = " ".join(file.read().split())
    for template in STUDIES if whole else [*STUDIES][:1]:
        if words_of(template) not in text:
            refuse(f"{path}: it does not say '{words_of(template)}'")
    for row in ROWS if whole else (("usl", "flip"), ("verlet", "flip")):
        if f"| {' | '.join(row_of(*row))} |" not in text:
            refuse(f"{path}: no row {' | '.join(row_of(*row))}")


def main():
    parser = Parser(__doc__)
    parser.add_argument("formulation", nargs="?", choices=list(EDGE), default="verlet")
    parser.add_argument("--scenes", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--dim", type=int, choices=(1, 2), help="by default four of five scenes are one-dimensional")
    parser.add_argument("--from", type=float, default=0.01, dest="least")
    parser.add_argument("--to", type=float, default=0.5, dest="most")
    parser.add_argument("--transfer", help="this one alone; hats: apic on hats")
    parser.add_argument("--basis", choices=("linear", "quadratic", "cubic"), help="this one alone")
    parser.add_argument("--share", type=float, default=0.2, help="the least k over the limit")
    parser.add_argument("--phases", type=int, default=1, help="boxes in a row whose waves are looked at")
    parser.add_argument("--worst", type=int, default=10)
    parser.add_argument("--validate", type=int, metavar="N")
    parser.add_argument("--table", action="store_true")
    parser.add_argument("--check", metavar="FILE")
    parser.add_argument("--all", action="store_true")
    args = parser.parse_args()
    require_program()
    dims = [args.dim] if args.dim else [1, 1, 1, 1, 2]
    drifts = (args.least, args.most)
    if args.table:
        for template in STUDIES:
            print(words_of(template), flush=True)
        for row in ROWS:
            print(f"| {' | '.join(row_of(*row))} |", flush=True)
        return
    if args.check:
        require_input(args.check, "a file with the tables")
        check(args.check, args.all)
        return
    if args.validate:
        validate(args.formulation, args.validate, args.seed, dims, drifts, args.transfer)
        return
    tell(args.formulation, search(args.formulation, args.scenes, args.seed, dims, drifts, args.transfer, args.basis, args.share,
                                  args.phases), args.worst if args.phases == 1 else 0)


if __name__ == "__main__":
    end_in_one_line(main)
    sys.exit(0)
