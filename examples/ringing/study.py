#!/usr/bin/python3
"""The slides' third question: how are ringing instability and formulation instability connected?

study.py [--quick]: the symbol of particles off the middle of their cells; growth per time as the time step shrinks, at
rest and in slow flow, what places alone have in it, and a closed form of its limit for many particles; which waves
grow; growth over drift and Courant number; the share in the null space of P2G, and what transfers and bases do to it.
--quick: fewer cases.
"""
import math
import os
import sys
import tempfile
from fractions import Fraction

import h5py
import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, os.pardir, os.pardir, "scripts"))
from program import Parser, end_in_one_line, launch, require_program  # noqa: E402 (the path comes first)


def ask(task, options, scene=None):
    status, found, said = launch(task, scene, options)
    if status not in (0, 3) or not found:
        sys.exit(f"study.py: {task} {options}: {said}")
    return found


def read(task, options, suffix, scene=None):
    """JSON of a task, and its CSV as columns or its HDF5 factors as complex numbers (phases x size)."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "out" + suffix)
        found = ask(task, {**options, "csv" if suffix == ".csv" else "output": path}, scene)
        if suffix == ".csv":
            columns = range(4) if task == "map" else None  # the last is the verdict, a word
            return found, numpy.genfromtxt(path, delimiter=",", names=True, usecols=columns)
        with h5py.File(path) as file:
            pairs = file["symbol/factors"][:]
            return file["symbol/beta"][:], pairs[:, ::2] + 1j * pairs[:, 1::2]


def closed(formulation, k, e, beta):
    """The two factors of the slides' analysis with C1 - C2 = e."""
    mu = e * (1 - numpy.cos(beta)) + 1j * numpy.sin(beta)
    if formulation == "gas1":
        return 1 + k * mu, 1 - k * mu
    trace = 2 + (k * mu) ** 2
    root = numpy.sqrt(trace**2 - 4 + 0j)
    return (trace + root) / 2, (trace - root) / 2


def mechanism():
    """Closed form against the program, ppc 1, at rest; e = C1 - C2 = 2 offset - 1."""
    print("ppc 1 at rest, hats, flip: largest growth over 64 waves; C1 - C2 = e = 2 offset - 1,\n"
          "mu = e (1 - cos beta) + i sin beta; gas1 G = 1 +- k mu, gas2 G^2 - (2 + k^2 mu^2) G + 1 = 0\n")
    line = "{:>4} {:>6} {:>5}  {:>9} {:>9}"
    print(line.format("k", "offset", "e", "gas1", "gas2"))
    off = other = 0
    for k in (0.02, 0.1, 0.5):
        for offset in ("1/2", "5/8", "3/4", "1/4", "0"):
            e, shown = 2 * float(Fraction(offset)) - 1, []
            for formulation in ("gas1", "gas2"):
                scene = {"formulation": formulation, "ppc": 1, "offset": offset, "courant": k}
                beta, factors = read("symbol", scene, ".h5")
                shown.append(f"{abs(factors).max():.6f}")
                for sign in (1, -1):
                    a, b = closed(formulation, k, sign * e, beta)
                    far = numpy.minimum(abs(factors - numpy.stack([a, b], 1)).max(1),
                                        abs(factors - numpy.stack([b, a], 1)).max(1)).max()
                    off, other = (max(off, far), other) if sign == 1 else (off, max(other, far))
            print(line.format(k, offset, e, *shown), flush=True)
    print(f"\nfactors and closed form differ by {'less than 1e-7' if off < 1e-7 else format(off, '.1e')} (a double "
          f"root is known to the root of rounding);\nwith the sign of e turned round by {other:.2f}")


STEPS = [Fraction(1, inverse) for inverse in (2, 10, 50, 100)]


def rates(quick):
    """(growth - 1) / k, the rate per h / c, as k shrinks while flow and grid stay."""
    print("\n(growth - 1) / k, growth per time h / c, hats, flip; flow at U0 / c of 0 and above, drift = k U0 / c; "
          "?: lost to\nrounding\n")
    line = "{:<5} {:>4} {:>7} " + " {:>9}" * 4
    print(line.format("", "ppc", "U0 / c", *(f"k = {k}" for k in STEPS)))
    for formulation in ("gas1", "gas2"):
        for ppc in (1, 2) if quick else (1, 2, 4, 8):
            for speed in ("0", "1/10") if quick else ("0", "1/100", "1/20", "1/10", "1/5", "3/10", "1/2", "1"):
                shown = []
                for k in STEPS:
                    found = ask("symbol", {"formulation": formulation, "ppc": ppc, "courant": float(k),
                                           "drift": k * Fraction(speed)})
                    excess = found["growth"] - 1
                    shown.append("?" if found["verdict"] == "undecided" else
                                 f"{excess / k:.4f}" if excess > 1e-6 else "0")
                print(line.format(formulation, ppc, speed, *shown), flush=True)


def places_alone(formulation, ppc, k, drift):
    """Growth of nodes without source term: each step the closed form with e of the places, largest over 64 waves."""
    beta = 2 * math.pi * numpy.arange(1, 33) / 64
    starts = [Fraction(2 * j + 1, 2 * ppc) for j in range(ppc)]
    product, log = numpy.eye(2), numpy.zeros(len(beta), complex)
    for step in range(drift.denominator):
        e = float(sum(2 * ((start + step * drift) % 1) - 1 for start in starts)) / ppc
        mu = e * (1 - numpy.cos(beta)) + 1j * numpy.sin(beta)
        if formulation == "gas1":  # u + r and u - r go by themselves: factors multiply
            log = log + numpy.log([1 + k * mu, 1 - k * mu])
        else:
            one, a = numpy.ones(len(beta)), k * mu
            product = numpy.moveaxis(numpy.array([[one, a], [a, 1 + a * a]]), 2, 0) @ product
    if formulation == "gas1":
        return math.exp(log.real.max() / drift.denominator)
    return float(abs(numpy.linalg.eigvals(product)).max() ** (1 / drift.denominator))


def sweep(quick):
    """What is left of growth off the middle when particles pass all places."""
    print("\nthe same of the nodes by their places alone (the closed form with e as particles pass, no source term)\n")
    line = "{:<5} {:>4} {:>7} " + " {:>9}" * 4
    print(line.format("", "ppc", "U0 / c", *(f"k = {k}" for k in STEPS)))
    for formulation in ("gas1", "gas2"):
        for ppc in (1, 2) if quick else (1, 2, 4):
            for speed in ("1/10",) if quick else ("1/100", "1/20", "1/10", "1/5"):
                shown = [(places_alone(formulation, ppc, float(k), k * Fraction(speed)) - 1) / k for k in STEPS]
                print(line.format(formulation, ppc, speed, *(f"{value:.4f}" for value in shown)), flush=True)


def closed_rate(speed):
    """Of the wave of two cells, small steps, many particles: s h / c = 2 M z, M = U0 / c = (z - tanh z) / z^3."""
    if speed >= 1 / 3:
        return 0
    low, high = 1e-2, 1e3  # M falls with z
    for _ in range(100):
        z = math.sqrt(low * high)
        low, high = (z, high) if (z - math.tanh(z)) / z**3 > speed else (low, z)
    return 2 * speed * low


def limit(quick):
    """Growth per time of the wave of two cells against its closed form."""
    print("\n(growth - 1) / k of the wave of two cells, hats, flip, k = 1/50 (last column 1/100), and closed\n")
    line = "{:>7}  {:>7} " + " {:>11}" * 5
    cases = (("gas2", 2, 50), ("gas2", 8, 50), ("gas1", 16, 50), ("gas2", 16, 50), ("gas2", 32, 100))
    print(line.format("U0 / c", "closed", *(f"{formulation} ppc {ppc}" for formulation, ppc, _ in cases)))
    speeds = ("1/100", "1/20", "1/10", "1/6", "1/5", "3/10", "8/25", "33/100", "17/50")
    for speed in speeds[1:-1:3] if quick else speeds:
        shown = []
        for formulation, ppc, inverse in cases:
            scene = {"formulation": formulation, "ppc": ppc, "courant": 1 / inverse, "cells": 2,
                     "drift": Fraction(speed) / inverse}
            shown.append(f"{(ask('symbol', scene)['growth'] - 1) * inverse:.4f}")
        print(line.format(speed, f"{closed_rate(float(Fraction(speed))):.4f}", *shown), flush=True)


def waves():
    """Which waves grow."""
    print("\nwaves that grow by more than 1e-6 per step, of 64 cells, hats, flip, ppc 4\n")
    line = "{:<5} {:>5} {:>7}  {:>6}  {:>16}  {:>9} {:>12}"
    print(line.format("", "k", "drift", "waves", "longest, cells", "growth", "of cells"))
    for formulation, k, drift in (("gas1", 0.1, "0"), ("gas1", 0.1, "1/100"), ("gas2", 0.1, "0"),
                                  ("gas2", 0.1, "1/100"), ("gas2", 0.5, "1/20"), ("gas2", 0.5, "1/8")):
        scene = {"formulation": formulation, "courant": k, "drift": drift, "ppc": 4}
        found, curve = read("symbol", scene, ".csv")
        grow = curve["growth"] > 1 + 1e-6
        longest = f"{2 * math.pi / curve['beta'][grow].min():.3g}" if grow.any() else "-"
        most = f"{2 * math.pi / curve['beta'][curve['growth'].argmax()]:.3g}" if grow.any() else "-"
        print(line.format(formulation, k, drift, f"{grow.sum()}/32", longest, f"{found['growth']:.6f}", most),
              flush=True)


def maps():
    """Growth over drift and Courant number."""
    print("\ngrowth over Courant number and drift (mpmstab map -map_axes courant,drift), 64 waves, ppc 2\n")
    line = "{:<5} {:<10} {:<9}  {:>7} {:>9} {:>8} {:>8}  {:>16}"
    print(line.format("", "basis", "transfer", "points", "unstable", "share", "largest", "at rest"))
    for formulation in ("gas1", "gas2"):
        for basis, transfer in (("linear", "flip"), ("quadratic", "flip"), ("cubic", "flip"), ("linear", "blend"),
                                ("linear", "xpic"), ("linear", "nullspace"), ("linear", "pic")):
            _, table = read("map", {"formulation": formulation, "basis": basis, "transfer": transfer, "map_axes":
                                    "courant,drift", "map_courant": "0.05,0.6", "map_points": "24,33"}, ".csv")
            unstable, rest = table["growth"] > 1 + 1e-6, table["drift"] == 0
            print(line.format(formulation, basis, transfer, len(table), unstable.sum(), f"{unstable.mean():.0%}",
                              f"{table['growth'].max():.4f}", f"{unstable[rest].sum()} of {rest.sum()} grow"),
                  flush=True)


def content(quick):
    """The share in the null space of P2G, and the error, in a smooth wave."""
    print("\na smooth wave (low-speed.yaml): share of u in the null space of P2G, at times 0, 1 and 2, and the error at 2\n")
    line = "{:<18} {:<10} {:<9}  {:>9}  {:>9} {:>9} {:>9}  {:>9}"
    print(line.format("", "basis", "transfer", "symbol", "time 0", "time 1", "time 2", "error"))
    scene = os.path.join(HERE, "low-speed.yaml")
    cases = [("gas2 drift 1/100", {}, basis, "flip") for basis in ("linear", "quadratic", "cubic")]
    cases += [("gas2 drift 1/100", {}, "linear", way) for way in ("blend", "xpic", "nullspace", "pic")]
    cases += [("gas2 at rest", {"drift": 0}, "linear", "flip"),
              ("gas1 at rest", {"drift": 0, "formulation": "gas1", "courant": 0.5, "steps": 256}, "linear", "flip")]
    for name, more, basis, transfer in cases[::4] if quick else cases:
        options = {**more, "basis": basis, "transfer": transfer}
        found, table = read("run", {**options, "ringing": "true"}, ".csv", scene)
        ringing = table["ringing_u"]
        growth = ask("symbol", {key: value for key, value in options.items() if key != "steps"}, scene)["growth"]
        error = max(field["l2"] for field in found["run"]["error"].values())
        print(line.format(name, basis, transfer, f"{growth:.6f}",
                          *(f"{value:.1e}" for value in (ringing[0], ringing[len(ringing) // 2], ringing[-1])),
                          f"{error:.1e}"), flush=True)


def main():
    parser = Parser(__doc__)
    parser.add_argument("--quick", action="store_true")
    arguments = parser.parse_args()
    require_program()
    mechanism()
    rates(arguments.quick)
    sweep(arguments.quick)
    limit(arguments.quick)
    waves()
    maps()
    content(arguments.quick)


if __name__ == "__main__":
    end_in_one_line(main)
