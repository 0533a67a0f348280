#!/usr/bin/python3
"""The slides' second question: how does the source term contribute to stability?

study.py [--quick] [-o PICTURE]: an independent march of nodes and particles in numpy, one Bloch wave at a time, in
which the source term of the slides stands by itself and is multiplied by a factor: with 1 it must give mpmstab's
growth, with 0 the term is gone. PICTURE (.png): growth over drift with and without it. --quick: fewer cases.

    gas1  u' = u + s sum_p (S' - S) u_p + k sum_p S' (r_{i+1} - r_i),   r' likewise from the old u
    gas2  u' = u + s sum_p (S - S-) u_p + k sum_p S (r_{i+1} - r_i),
          r' = r + s sum_p (S' - S) r_p + k sum_p S' (u'_{i+1} - u'_i)     (u with the weights before the move)

S-, S, S': weights where particles were, are and will be. With s = 0 the nodes go on by themselves, as C1, C2 say. The
step may also be split with the weights S at both places of k; 'same place' below is that split without its term.
"""
import math
import os
import sys
import tempfile
from fractions import Fraction

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, os.pardir, os.pardir, "scripts"))
from program import (Parser, end_in_one_line, launch, require_outputs,  # noqa: E402 (the path comes first)
                     require_program, write_whole)

CELLS = 64
WAVES = 2 * math.pi * numpy.arange(1, CELLS // 2 + 1) / CELLS
CASES = [(k, drift, ppc) for k in (0.1, 0.5) for drift in ("1/100", "1/8", "1/3") for ppc in (1, 2, 4, 8)]


def shape(basis, d):
    """phi and dphi/dx at the distance d of a particle from a node, in cells; for the hat left-closed cells."""
    a, sign = abs(d), math.copysign(1, d)
    if basis == "linear":
        return (1 - a, -1 if d >= 0 else 1) if -1 <= d < 1 else (0, 0)
    if basis == "quadratic":
        return (0.75 - d * d, -2 * d) if a < 0.5 else ((1.5 - a) ** 2 / 2, -sign * (1.5 - a)) if a < 1.5 else (0, 0)
    return ((2 / 3 - d * d + a**3 / 2, -2 * d + 1.5 * d * a) if a < 1
            else ((2 - a) ** 3 / 6, -sign * (2 - a) ** 2 / 2) if a < 2 else (0, 0))


def maps(scene, step):
    """P2G as a row and GRAD as a column of the Bloch wave for each of WAVES: particles of a cell, one node."""
    ppc, drift, basis = scene["ppc"], Fraction(scene["drift"]), scene.get("basis", "linear")
    gather = numpy.zeros((len(WAVES), ppc), complex)
    gradient = numpy.zeros((len(WAVES), ppc), complex)
    mass = 0
    for j in range(ppc):
        place = Fraction(2 * j + 1, 2 * ppc) + step * drift
        cell = math.floor(place)
        for node in range(cell - 1, cell + 3):
            phi, slope = shape(basis, float(place - node))
            gather[:, j] += phi * numpy.exp(-1j * WAVES * node)
            gradient[:, j] += slope * numpy.exp(1j * WAVES * node)
            mass += phi
    return gather / mass, gradient


def identity(size):
    return numpy.tile(numpy.eye(size, dtype=complex), (len(WAVES), 1, 1))


def step_matrix(scene, step, factor):
    """One step of (u_i, r_i, u_p, r_p), the source term multiplied by the factor."""
    ppc, k = scene["ppc"], scene["courant"]
    was, now, will = (maps(scene, step + shift) for shift in (-1, 0, 1))
    u, r = slice(2, 2 + ppc), slice(2 + ppc, None)

    def update(matrix, node, field, other, weights, before):
        matrix[:, node, field] += factor * (weights - before)
        matrix[:, node, other] += k * numpy.einsum("bj,bj->b", weights, now[1])
        matrix[:, field, other] += k * now[1]

    first, second = identity(2 + 2 * ppc), identity(2 + 2 * ppc)
    if scene["formulation"] == "gas1":
        update(first, 0, u, 1, will[0], now[0])
        update(first, 1, r, 0, will[0], now[0])
        return first
    update(first, 0, u, 1, now[0], was[0])
    update(second, 1, r, 0, will[0], now[0])
    return second @ first


def same_place(scene, step):
    """One step of (u_i, r_i) alone with the weights where the particles are: mu = e (1 - cos beta) + i sin beta."""
    gather, gradient = maps(scene, step)
    mu = scene["courant"] * numpy.einsum("bj,bj->b", gather, gradient)
    first, second = identity(2), identity(2)
    first[:, 0, 1] = mu
    if scene["formulation"] == "gas1":
        first[:, 1, 0] = mu
        return first
    second[:, 1, 0] = mu
    return second @ first


def growth(scene, matrix_of_step):
    """Largest growth per step over WAVES: of a period, after which particles have moved whole cells (Floquet)."""
    drift = Fraction(scene["drift"])
    period = drift.denominator
    product = 1
    for step in range(period):
        product = matrix_of_step(step) @ product if step else matrix_of_step(0)
    product[:, 2:] *= numpy.exp(-1j * WAVES * drift.numerator)[:, None, None]
    return float(abs(numpy.linalg.eigvals(product)).max() ** (1 / period))


def with_and_without(scene):
    return (growth(scene, lambda step: step_matrix(scene, step, 1)),
            growth(scene, lambda step: step_matrix(scene, step, 0)[:, :2, :2]),
            growth(scene, lambda step: same_place(scene, step)))


def symbol(scene, **more):
    status, found, said = launch("symbol", None, {"cells": CELLS, **scene, **more})
    if status:
        sys.exit(f"study.py: {scene} {more}: {said}")
    return found["growth"]


def removed(cases):
    """The term with factors 1 and 0, beside mpmstab; the largest difference to mpmstab."""
    print("largest growth per step over 64 waves, hats, flip; with: numpy with the term, without: the slides' split\n"
          "without it, same place: the other split without it; nullspace: mpmstab with that transfer\n")
    line = "{:<5} {:>4} {:>6} {:>4}  {:>9} {:>9}  {:>9} {:>10}  {:>9}"
    print(line.format("", "k", "drift", "ppc", "mpmstab", "with", "without", "same place", "nullspace"))
    off = 0
    for formulation in ("gas1", "gas2"):
        for k, drift, ppc in cases:
            scene = {"formulation": formulation, "courant": k, "drift": drift, "ppc": ppc}
            program, null = symbol(scene), symbol(scene, transfer="nullspace", pic_filter="before")
            found = with_and_without(scene)
            off = max(off, abs(found[0] - program))
            print(line.format(formulation, k, drift, ppc, f"{program:.6f}", *(f"{value:.6f}" for value in found),
                              f"{null:.6f}"), flush=True)
    return off


def frozen():
    """Particles held where drifting ones pass, against drifting ones."""
    print("\ngrowth per step, hats, flip, ppc 2, drift 1/8: particles held at each offset they pass, and drifting\n")
    line = "{:<5} {:>4}  {:>9} {:>9} {:>9} {:>9}  {:>14}  {:>9}"
    offsets = ("0", "1/4", "1/2", "3/4")
    print(line.format("", "k", *(f"at {offset}" for offset in offsets), "geometric mean", "drifting"))
    for formulation in ("gas1", "gas2"):
        for k in (0.1, 0.5):
            scene = {"formulation": formulation, "courant": k, "ppc": 2}
            held = [symbol(scene, offset=float(Fraction(offset))) for offset in offsets]
            print(line.format(formulation, k, *(f"{value:.6f}" for value in held),
                              f"{math.exp(numpy.log(held).mean()):.6f}", f"{symbol(scene, drift='1/8'):.6f}"),
                  flush=True)


def worst_held():
    """Slow flow against the worst of all places, particles on the nodes: C1 - C2 = -1 / ppc."""
    print("\ngrowth per step, hats, flip, k = 0.1: particles held at the worst place (offset 0), and drift 1/100\n")
    line = "{:<5} {:>4}  {:>9} {:>9}"
    print(line.format("", "ppc", "held", "drifting"))
    for formulation in ("gas1", "gas2"):
        for ppc in (2, 4, 8):
            scene = {"formulation": formulation, "courant": 0.1, "ppc": ppc}
            held, moves = symbol(scene, offset=0), symbol(scene, drift="1/100")
            print(line.format(formulation, ppc, f"{held:.6f}", f"{moves:.6f}"), flush=True)


def calmer(quick):
    """Smoother bases, with and without the term; other transfers."""
    print("\ngrowth per step, ppc 2; with and without the term (slides' split), and other transfers by mpmstab\n")
    line = "{:<5} {:>4} {:>6} {:<9}  {:>9} {:>9}  {:>9} {:>9} {:>9} {:>9}"
    print(line.format("", "k", "drift", "basis", "with", "without", "pic", "blend", "xpic", "nullspace"))
    off = 0
    for formulation in ("gas2",) if quick else ("gas1", "gas2"):
        for k, drift in ((0.1, "1/100"), (0.5, "1/8")):
            for basis in ("linear", "quadratic", "cubic"):
                scene = {"formulation": formulation, "courant": k, "drift": drift, "ppc": 2, "basis": basis}
                found = with_and_without(scene)
                off = max(off, abs(found[0] - symbol(scene)))
                others = [symbol(scene, transfer=way, pic_filter="before")
                          for way in ("pic", "blend", "xpic", "nullspace")]
                print(line.format(formulation, k, drift, basis, *(f"{value:.6f}" for value in (*found[:2], *others))),
                      flush=True)
    return off


def samples(options):
    """The columns of a run's CSV, and its growth."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "run.csv")
        status, found, said = launch("run", None, {"source_term": "true", "ringing": "true", **options, "csv": path})
        if status:
            sys.exit(f"study.py: {options}: {said}")
        return numpy.genfromtxt(path, delimiter=",", names=True), found.get("growth", math.nan)


def measured():
    """The term's size in a smooth wave, where it is advection, and in what grows."""
    print("\nthe term by mpmstab run -source_term true, over the nodes' values: gas2, hats, flip, k = 0.1, 64 cells\n"
          "smooth: mode 1 at its first step, beside K U0 dt; growing: from random data, mean of the last quarter of "
          "2000 steps\n")
    line = "{:>4} {:>6}  {:>9} {:>9}  {:>9} {:>9} {:>9}"
    print(line.format("ppc", "drift", "smooth", "K U0 dt", "growing", "ringing", "growth"))
    for ppc in (2, 8):
        for drift in ("1/100", "1/8", "1/3"):
            scene = {"formulation": "gas2", "courant": 0.1, "drift": drift, "ppc": ppc}
            smooth, _ = samples({**scene, "steps": 10})
            random, rate = samples({**scene, "initial": "random", "steps": 2000})
            late = len(random) * 3 // 4
            print(line.format(ppc, drift, f"{smooth['source_u'][0]:.3e}",
                              f"{2 * math.pi / CELLS * float(Fraction(drift)):.3e}",
                              *(f"{numpy.mean(random[name][late:]):.3f}" for name in ("source_u", "ringing_u")),
                              f"{rate:.4f}"), flush=True)


def picture(path, quick):
    """Growth over drift with and without the term."""
    import picture_style as style  # here: without -o no picture is drawn
    figure = style.Figure(figsize=(5.2, 7), constrained_layout=True)
    *panels, below = figure.subplots(3, 1, height_ratios=[1, 1, 0.2])
    drifts = sorted({Fraction(n, d) for d in ((16,) if quick else (16, 100)) for n in range(1, d // 2 + 1)})
    for axes, ppc in zip(panels, (2, 8)):
        found = numpy.array([with_and_without({"formulation": "gas2", "courant": 0.1, "drift": str(drift), "ppc": ppc})
                             for drift in drifts])
        for column, (label, colour, marker) in enumerate((("with the source term", 0, "o"),
                                                          ("without it (the slides' split)", 1, "s"),
                                                          ("without it (same place)", 3, "^"))):
            axes.semilogy(drifts, numpy.maximum(found[:, column] - 1, 1e-7), color=style.COLOURS[colour],
                          marker=marker, markersize=4, linestyle="none", label=label)
        axes.set_title(f"gas2, linear, flip, k = 0.1, ppc {ppc}", fontsize=10)
        axes.set_ylabel("growth per step - 1\n(stable: at the bottom)")
        axes.set_ylim(0.7e-7, 1)
        axes.grid(True, alpha=0.3)
    panels[1].set_xlabel("drift / cells per step")
    below.axis("off")
    below.legend(*panels[0].get_legend_handles_labels(), loc="center")
    write_whole(path, style.encoded(figure, "png"))


def main():
    parser = Parser(__doc__)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("-o", "--output", metavar="PICTURE")
    arguments = parser.parse_args()
    require_program()
    if arguments.output:
        require_outputs([arguments.output])
    off = removed([case for case in CASES if not arguments.quick or case[2] == 2])
    frozen()
    worst_held()
    off = max(off, calmer(arguments.quick))
    measured()
    print(f"\nnumpy with the term and mpmstab differ by {'less than 1e-9' if off < 1e-9 else format(off, '.1e')}")
    if arguments.output:
        picture(arguments.output, arguments.quick)


if __name__ == "__main__":
    end_in_one_line(main)
