#!/usr/bin/python3
"""Marches schemes beside plain C loops that do the same, interleaved, and prints best times and their ratios.

The speed of a machine drifts by tens of per cent within minutes, so only ratios of runs that alternate mean anything.
All programs end with the same energy, which is checked to 1e-9, so they do the same work. The script adds a line with
the results to scripts/bench/history.jsonl.
"""
import itertools
import statistics
import sys

import bench_runs
from bench_runs import listed

PARTICLES, DRIFTS = (10_000, 1_000_000, 8_000_000), ("0", "0.01", "0.3")
WORK, MOST_STEPS, LEAST_STEPS = 4e7, 1000, 20  # particles x steps of a run
MIGRATES = 250  # steps, in which particles move 75 cells and leave the ghost layer of 64 cells
SAME = 1e-9
COLUMNS = f"{'scheme':8} {'basis':9} {'particles':>9} {'drift':>5}  {'plain C':>13} {'1 rank':>13} {'2 ranks':>13}" \
          f" {'numba':>6}  {'1/plain':>14} {'speed-up':>8} {'pair':>4}  {'bytes':>5} {'GB/s':>5} {'share':>5}"


def arguments():
    parser = bench_runs.parser(__doc__, 5)
    parser.add_argument("--schemes", type=listed(bench_runs.SCHEMES), default=bench_runs.SCHEMES)
    parser.add_argument("--bases", type=listed(bench_runs.BASES), default=bench_runs.BASES)
    parser.add_argument("--particles", type=listed((), int), default=(1_000_000,), help="two a cell")
    parser.add_argument("--drifts", type=listed(DRIFTS), default=("0", "0.3"), help=f"some of {','.join(DRIFTS)}")
    parser.add_argument("--all", action="store_true", help="every row: particles and drifts too; half an hour")
    parser.add_argument("--no-memory", action="store_true", help="leave out gas2 with 8e6 particles, for its memory")
    parser.add_argument("--no-numba", action="store_true", help="leave out numba, for gas2")
    args = parser.parse_args()
    if args.all:
        args.particles, args.drifts = PARTICLES, DRIFTS
    if min(args.particles) < 1000:
        parser.error("--particles: less than 1000")
    return args


def steps_for(particles):
    return int(min(MOST_STEPS, max(LEAST_STEPS, WORK // particles)))


def measure(row, repeats, python):
    """Fills a row with best and median times, ratios and bytes."""
    programs = {"plain": bench_runs.run_plain, "1": lambda r: bench_runs.run_mpmstab(r, 1),
                "2": lambda r: bench_runs.run_mpmstab(r, 2)}
    if python and row["scheme"] == "gas2":
        programs["numba"] = lambda r: bench_runs.run_numba(python, r)
    times = {name: [] for name in programs}
    for _ in range(repeats):
        for name, run in programs.items():
            ns, energy, *more = run(row)
            times[name].append(ns)
            if name == "plain":
                expected = energy
            elif abs(energy - expected) > SAME * expected:
                sys.exit(f"bench: {name} does not do what plain C does: {row}: energy {energy} and {expected}")
            if more:
                row["bytes"] = more[0]
        times.setdefault("pair", []).append(bench_runs.run_pair(row))
    row["best"] = {name: min(values) for name, values in times.items()}
    row["median"] = {name: statistics.median(values) for name, values in times.items()}
    row["ratio"] = row["best"]["1"] / row["best"]["plain"]
    row["ratio_median"] = statistics.median(a / b for a, b in zip(times["1"], times["plain"]))
    row["speed_up"] = row["best"]["1"] / row["best"]["2"]
    row["speed_up_pair"] = row["best"]["1"] / row["best"]["pair"]


def show(row, triad):
    """Prints a row of the table. The share of the memory's bandwidth is there when the arrays fit into no cache."""
    best, median = row["best"], row["median"]
    cells = " ".join(f"{best[name]:6.2f} ({median[name]:4.1f})" for name in ("plain", "1", "2"))
    rate = row["bytes"] / best["1"]
    share = f"{rate / triad:5.2f}" if row["particles"] >= 8_000_000 else f"{'-':>5}"
    numba = f"{best['numba']:6.1f}" if "numba" in best else f"{'-':>6}"
    print(f"{row['scheme']:8} {row['basis']:9} {row['particles']:9} {row['drift']:>5}  {cells} {numba}  "
          f"{row['ratio']:6.2f} ({row['ratio_median']:4.2f}) {row['speed_up']:8.2f} {row['speed_up_pair']:4.2f}  "
          f"{row['bytes']:5.0f} {rate:5.1f} {share}", flush=True)


def measure_box(dim, repeats):
    """Prints and returns a row for usl on quadratics in more dimensions, at rest, beside a plain C loop of the same."""
    steps = 20
    programs = {"plain": lambda: bench_runs.run_plain_box(dim, steps),
                "1": lambda: bench_runs.run_box(dim, steps, 1), "2": lambda: bench_runs.run_box(dim, steps, 2)}
    times = {name: [] for name in programs}
    for _ in range(repeats):
        for name, run in programs.items():
            ns, energy = run()
            times[name].append(ns)
            if name == "plain":
                expected = energy
            elif abs(energy - expected) > SAME * expected:
                sys.exit(f"bench: {name} does not do what plain C does in {dim} dimensions: {energy} and {expected}")
    row = {"dim": dim, "cells": bench_runs.BOXES[dim], "best": {name: min(values) for name, values in times.items()},
           "median": {name: statistics.median(values) for name, values in times.items()}}
    row["ratio"] = row["best"]["1"] / row["best"]["plain"]
    cells = " ".join(f"{row['best'][name]:6.1f} ({row['median'][name]:5.1f})" for name in programs)
    print(f"usl quadratic, dim {dim}, {row['cells']} cells and {bench_runs.PPC} particles in each direction: "
          f"plain C, 1 rank, 2 ranks {cells}; 1/plain {row['ratio']:.2f}", flush=True)
    return row


def memory(ranks):
    """Measures bytes per particle, in all and beyond a march of few particles. Both marches migrate."""
    many, few = ({"scheme": "gas2", "basis": "linear", "particles": n, "drift": "0.3", "steps": MIGRATES}
                 for n in (8_000_000, 1000))
    peak, least = bench_runs.peak_bytes(many, ranks), bench_runs.peak_bytes(few, ranks)
    entry = {"ranks": ranks, "bytes": peak / many["particles"], "without_program": (peak - least) / many["particles"]}
    print(f"memory: gas2, 8000000 particles, ranks {ranks}: {entry['bytes']:.1f} bytes a particle at its largest, "
          f"{entry['without_program']:.1f} without what the program itself takes", flush=True)
    return entry


def main():
    args = arguments()
    result = bench_runs.begin("march", args)
    bench_runs.compile_all()
    python, why = (None, "not asked") if args.no_numba else bench_runs.numba_python()
    if not python:
        print(f"no numba: {why}")
    result |= {"triad_gb_per_s": [max(bench_runs.triad(n) for _ in range(3)) for n in (1, 2)], "rows": []}
    print("triad: {:.1f} GB/s for one process, {:.1f} for two together".format(*result["triad_gb_per_s"]))
    print(f"ns per particle and step, best (median) of {args.repeats}; ratio to plain C of best (of pairs, median)\n"
          "speed-up of 2 ranks, and of a pair of programs of 1 rank, each with half the particles, side by side: what\n"
          "two cores here do without a message; bytes that a step moves per particle, their rate on 1 rank over triad's"
          "\n")
    print(COLUMNS)
    for particles, scheme, basis, drift in itertools.product(args.particles, args.schemes, args.bases, args.drifts):
        row = {"scheme": scheme, "basis": basis, "particles": particles, "drift": drift, "steps": steps_for(particles)}
        measure(row, args.repeats, python)
        show(row, result["triad_gb_per_s"][0])
        result["rows"].append(row)
    print()
    result["boxes"] = [measure_box(dim, args.repeats) for dim in bench_runs.BOXES]
    if not args.no_memory:
        result["memory"] = [memory(ranks) for ranks in (1, 2)]
    bench_runs.keep(result, args)


if __name__ == "__main__":
    main()
