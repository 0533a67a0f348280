#!/usr/bin/python3
"""How the largest stable step changes when particles move: what -courant auto's certificates live by.

Random layouts of CELLS^2 cells with 2^2 particles each, 40 % of the cells empty or none. Particles move all alike, each its own
way, or in a smooth flow with waves of 10 cells. For each distance in cells, and of all layouts, it prints the least of

    then  k / k0, the largest step by the largest Ritz value of many products, over that at the start
    watch k / (k0 min(1, P / P0)), P the bound 'particle': how much too large a step is that goes down with P

step_moved.py [--layouts N] [--cells N] [--basis quadratic,hats] [--check PAGE]   --check: the page has these lines
"""
import argparse
import sys
from pathlib import Path

import numpy

sys.path.insert(0, str(Path(__file__).resolve().parent / "python"))
from mpmstab import dt  # noqa: E402

DISTANCES = (0.1, 0.25, 0.5, 1, 2, 4, 6)
STRIDE = 0.05  # of the flow, in cells
WAVES = 10     # the length of the flow's waves, in cells


def layout(random, cells, voids):
    """Uniformly random places in the cells that are not empty."""
    kept = numpy.flatnonzero(random.random(cells * cells) >= voids)
    at = numpy.repeat(numpy.stack([kept % cells, kept // cells], 1), 4, axis=0)
    return at + random.random(at.shape)


def largest(x, cells, basis):
    """The largest step, and by bound 'particle'; c = h = 1."""
    of = dict(h=1, lame=3 / 7, mu=2 / 7, scheme="musl", basis=basis, nodes=cells, origin=0, periodic=True)
    found = dt.step(x, 0.25, 0.25, products=60, **of)
    return 2 / numpy.sqrt(found.omega2_least), dt.step(x, 0.25, 0.25, bound="particle", **of).dt


def flow(random):
    """A velocity of largest size 1, made of waves along both axes."""
    phases = 2 * numpy.pi * random.random((2, 2, 2))
    waves = lambda x: numpy.stack([sum(numpy.sin(2 * numpy.pi / WAVES * x[:, b] + phases[a, b, 0]) for b in (0, 1)) / 2
                                   for a in (0, 1)], 1)
    return lambda x: waves(x) / numpy.sqrt(2)


def places(random, x, motion):
    """The places at each of the distances."""
    angle = 2 * numpy.pi * random.random(1 if motion == "alike" else len(x))
    way, velocity, at, gone = numpy.stack([numpy.cos(angle), numpy.sin(angle)], -1), flow(random), x, 0
    for distance in DISTANCES:
        while motion == "flow" and gone < distance - 1e-9:
            at, gone = at + STRIDE * velocity(at), gone + STRIDE
        yield x + distance * way if motion != "flow" else at


def main():
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--layouts", type=int, default=8)
    parser.add_argument("--cells", type=int, default=20)
    parser.add_argument("--basis", default="quadratic,hats")
    parser.add_argument("--check")
    chosen = parser.parse_args()
    page = Path(chosen.check).read_text(encoding="utf-8") if chosen.check else ""
    line = "| basis | empty | motion | | " + " | ".join(f"{d:g}" for d in DISTANCES) + " |\n"
    print(line + "|---" * (4 + len(DISTANCES)) + "|")
    missing = [] if line in page or not page else [line]
    for basis in chosen.basis.split(","):
        for voids in (0, 0.4):
            for motion in ("alike", "own", "flow"):
                least = numpy.full((2, len(DISTANCES)), numpy.inf)
                for seed in range(chosen.layouts):
                    random = numpy.random.default_rng(seed)
                    x = layout(random, chosen.cells, voids)
                    k0, P0 = largest(x, chosen.cells, basis)
                    for i, at in enumerate(places(random, x, motion)):
                        k, P = largest(at, chosen.cells, basis)
                        least[:, i] = numpy.minimum(least[:, i], [k / k0, k / (k0 * min(1, P / P0))])
                for row, name in zip(least, ("then", "watch")):
                    line = f"| {basis} | {voids} | {motion} | {name} | " + " | ".join(f"{v:.3f}" for v in row) + " |"
                    print(line, flush=True)
                    missing += [] if line in page or not page else [line]
    if missing:
        sys.exit("step_moved: the page has other lines than\n" + "\n".join(missing))


main()
