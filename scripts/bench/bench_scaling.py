#!/usr/bin/python3
"""Models the step time on many ranks from counted messages and measured work, and checks it on 1 and 2 ranks.

  T(P) = t0 + tp N / P + messages (latency + bytes / bandwidth) + reductions log2(P) latency
         + migrations (as the two terms before, with what one migration sends)

There are N particles on P ranks. tp is measured on one rank with so many particles that they fit into no cache. A
rank's part may fit, and then it is faster. t0 is the time of a step without particles, from two small runs. The work of
a migration is part of tp. PETSc (-log_view) counts the messages of a step, their bytes and the reductions on 3 ranks,
and on 2, where both neighbours are the same rank and the messages fewer. The model takes the rank that sends most, as
if it sent one message after the other. Latency and bandwidth are assumptions about a network, so they are options. For
the check they are those of this machine between two ranks. Two things differ in long runs: they look at the size of the
state (a reduction) in fewer of their steps, and under drift a rank with fewer cells than its ghost layer
migrates more often than counted.
"""
import csv
import json
import math
import os
import re
import tempfile

import bench_runs
import program
from bench_runs import at_least, listed

FEW_STEPS = 1
SMALL = (200, 2000)  # particles of the runs that give t0
RANKS, TOTALS, PER_RANK = (1000, 100_000), (8e6, 1e9), (1e4, 1e6)
MOST_RANKS = 1e9


def arguments():
    parser = bench_runs.parser(__doc__, 3)
    parser.add_argument("--schemes", type=listed(bench_runs.SCHEMES), default=("gas2",))
    parser.add_argument("--bases", type=listed(bench_runs.BASES), default=("linear",))
    parser.add_argument("--drifts", type=listed(("0", "0.01", "0.3")), default=("0", "0.3"))
    parser.add_argument("--particles", type=at_least(10_000), default=2_000_000, help="for tp (2000000)")
    parser.add_argument("--count-steps", type=at_least(2), default=2048, help="steps of a counted run (2048)")
    add_network(parser)
    return parser.parse_args()


def add_network(parser):
    parser.add_argument("--latency", type=at_least(0, float), default=1.5e-6, help="seconds; assumed (1.5e-6)")
    parser.add_argument("--bandwidth", type=at_least(1, float), default=12e9, help="bytes a second; assumed (12e9)")


def networks(args):
    """Returns latency and bandwidth of the assumed network, and between two ranks here, and prints both."""
    network = {"latency": args.latency, "bandwidth": args.bandwidth}
    here = json.loads(bench_runs.said(["mpirun", "-q", "-n", "2", bench_runs.compiled("ping")]))
    for name, values in (("assumed", network), ("between two ranks here", here)):
        print(f"{name}: latency {1e6 * values['latency']:.3g} us, bandwidth {1e-9 * values['bandwidth']:.3g} GB/s")
    return network, here


def read_counts(lines):
    """Reads an event's count, messages, bytes and reductions from PETSc's ascii_csv, the most of all ranks."""
    found = {}
    for row in csv.DictReader(lines):
        now = [float(row[name]) for name in ("Count", "Num Messages", "Message Length", "Num Reductions")]
        found[row["Event Name"]] = [max(pair) for pair in zip(now, found.get(row["Event Name"], now))]
    return found


def difference(few, many, event):
    none = [0.0] * 4
    return [b - a for a, b in zip(few.get(event, none), many.get(event, none))]


def per_step(few, many, steps):
    """Returns what a step sends, from two runs. PETSc counts a message at both its ends; this counts it once."""
    migrations, moved, moved_length, moved_reductions = difference(few, many, "MpmMigrate")
    _, messages, length, reductions = difference(few, many, "summary")
    messages, length, reductions = messages - moved, length - moved_length, reductions - moved_reductions
    each = max(migrations, 1)
    return {"messages": messages / 2 / steps, "bytes": length / messages if messages else 0.0,
            "reductions": reductions / steps, "migrations": migrations / steps,
            "migration": {"messages": moved / 2 / each, "bytes": moved_length / moved if moved else 0.0,
                          "reductions": moved_reductions / each}}


def sending(counts, ranks, network):
    """Returns the seconds of messages and reductions on two or more ranks."""
    return (counts["messages"] * (network["latency"] + counts["bytes"] / network["bandwidth"])
            + counts["reductions"] * math.log2(ranks) * network["latency"])


def messages_time(model, ranks, network):
    if ranks <= 1:
        return 0.0
    counts = model["counts"]["2" if ranks <= 2 else "3"]
    return sending(counts, ranks, network) + counts["migrations"] * sending(counts["migration"], ranks, network)


def step_time(model, particles, ranks, network):
    return model["t0"] + model["tp"] * particles / ranks + messages_time(model, ranks, network)


def efficiency(model, particles, ranks, network):
    """Returns the strong efficiency: the time of one rank over that of all ranks together."""
    return step_time(model, particles, 1, network) / ranks / step_time(model, particles, ranks, network)


def first_ranks(holds):
    """Returns the least number of ranks, from 3 on, from which a condition holds, or None when it never does."""
    low, high = 2, 3
    while not holds(high):
        low, high = high, 2 * high
        if high > MOST_RANKS:
            return None
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def half_messages(model, particles, network):
    return first_ranks(lambda p: 2 * messages_time(model, p, network) >= step_time(model, particles, p, network))


def half_efficient(model, particles, network):
    return first_ranks(lambda p: efficiency(model, particles, p, network) <= 0.5)


def row_of(scheme, basis, drift, particles, steps):
    return {"scheme": scheme, "basis": basis, "drift": drift, "particles": particles, "steps": steps}


def counted(row, ranks):
    """Returns the counts of a run, whose cells fit its wave and are enough for the ghost layer of every rank."""
    words = [word for name, value in bench_runs.options(row).items() for word in (f"-{name}", str(value))]
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "log.csv")
        bench_runs.said(program.command_of(["run", *words, "-log_view", f":{path}:ascii_csv"], ranks))
        with open(path, encoding="utf-8", newline="") as file:
            return read_counts(file)


def cells_needed(scheme, basis):
    """Returns how many cells a rank needs, which the program says when it refuses one cell for each rank."""
    status, _, error = program.launch("run", options={"formulation": scheme, "basis": basis, "cells": 3}, ranks=3)
    said = re.search(r"a rank needs (\d+) cells|allowed: at least (\d+) with formulation", error)
    if status and not said:
        program.refuse(f"mpmstab ended with status {status}: {error}")
    return int(said[1] or said[2]) if said else 1


def measured_step(scheme, basis, drift, particles, ranks, repeats):
    """Returns the seconds of a step, the best of the repeats."""
    steps = int(min(4000, max(20, 4e7 // particles)))
    row = row_of(scheme, basis, drift, particles, steps)
    return 1e-9 * particles * min(bench_runs.run_mpmstab(row, ranks)[0] for _ in range(repeats))


def make_model(scheme, basis, drift, args):
    model = {"scheme": scheme, "basis": basis, "drift": drift, "counts": {}}
    model["cells_needed"] = cells_needed(scheme, basis)
    for ranks in (2, 3):
        runs = [counted(row_of(scheme, basis, drift, 3000, steps), ranks) for steps in (FEW_STEPS, args.count_steps)]
        model["counts"][str(ranks)] = per_step(*runs, args.count_steps - FEW_STEPS)
    times = [measured_step(scheme, basis, drift, n, 1, args.repeats) for n in SMALL]
    model["t0"] = max(0.0, times[0] - SMALL[0] * (times[1] - times[0]) / (SMALL[1] - SMALL[0]))
    model["tp"] = measured_step(scheme, basis, drift, args.particles, 1, args.repeats) / args.particles
    return model


def check(model, args, here):
    """Compares the model with measured steps on 1 and 2 ranks."""
    rows = []
    for particles in (args.particles // 10, args.particles):
        for ranks in (1, 2):
            time = measured_step(model["scheme"], model["basis"], model["drift"], particles, ranks, args.repeats)
            rows.append({"particles": particles, "ranks": ranks, "measured": time,
                         "model": step_time(model, particles, ranks, here)})
            print(f"    {particles:9} particles, {ranks} rank{'s' * (ranks > 1)}: measured {1e6 * time:9.1f} us, model "
                  f"{1e6 * rows[-1]['model']:9.1f} us ({rows[-1]['model'] / time:.2f})", flush=True)
    return rows


def show(model):
    print(f"\n{model['scheme']} {model['basis']}, drift {model['drift']}: tp {1e9 * model['tp']:.2f} ns, "
          f"t0 {1e6 * model['t0']:.2f} us; cells that a rank needs: {model['cells_needed']}")
    for ranks, counts in model["counts"].items():
        moved = counts["migration"]
        print(f"  on {ranks} ranks a step sends {counts['messages']:.3g} messages of {counts['bytes']:.4g} bytes and makes "
              f"{counts['reductions']:.3g} reductions" +
              (f"; every {1 / counts['migrations']:.3g} steps particles migrate, with {moved['messages']:.3g} messages of "
               f"{moved['bytes']:.4g} bytes and {moved['reductions']:.3g} reductions" if counts["migrations"] else ""))


def extrapolate(model, network):
    """Prints strong and weak scaling, without ranks that would have fewer cells than the program allows."""
    rows = []
    for kind, sizes in (("strong", TOTALS), ("weak", PER_RANK)):
        for size in sizes:
            row = {"kind": kind, "particles": size, "ranks": {}}
            for ranks in RANKS:
                total = size if kind == "strong" else size * ranks
                time = step_time(model, total, ranks, network)
                share = efficiency(model, total, ranks, network) if kind == "strong" else \
                    step_time(model, size, 1, network) / time
                fits = total / bench_runs.PPC / ranks >= model["cells_needed"]
                row["ranks"][str(ranks)] = {"seconds": time, "efficiency": share, "fits": fits}
            if kind == "strong":
                row |= {"half_messages": half_messages(model, size, network),
                        "half_efficient": half_efficient(model, size, network),
                        "most_ranks": int(size / bench_runs.PPC) // model["cells_needed"]}
            rows.append(row)
            show_row(row)
    return rows


def show_row(row):
    what = "particles in all" if row["kind"] == "strong" else "particles a rank"
    cells = "; ".join(f"{int(p):,} ranks: " + (f"{1e6 * at['seconds']:.3g} us a step, efficiency {at['efficiency']:.2f}"
                                               if at["fits"] else "too few cells for a rank")
                      for p, at in row["ranks"].items())
    print(f"  {row['kind']}, {row['particles']:.0e} {what}: {cells}")
    if row["kind"] == "strong":
        half, least = (f"at {row[name]:,} ranks" if row[name] else "at no number of ranks"
                       for name in ("half_messages", "half_efficient"))
        print(f"    messages take half of the time {half}; the efficiency is 1/2 {least}; {row['most_ranks']:,} ranks have enough cells")


def main():
    args = arguments()
    result = bench_runs.begin("scaling", args)
    network, here = networks(args)
    result |= {"network": network, "here": here, "models": []}
    for scheme, basis, drift in ((s, b, d) for s in args.schemes for b in args.bases for d in args.drifts):
        model = make_model(scheme, basis, drift, args)
        show(model)
        print("  measured on this machine, and the model with its latency and bandwidth:")
        model["check"] = check(model, args, here)
        print("  on the assumed network:")
        model["rows"] = extrapolate(model, network)
        result["models"].append(model)
    bench_runs.keep(result, args)


if __name__ == "__main__":
    program.end_in_one_line(main)
