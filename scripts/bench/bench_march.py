#!/usr/bin/python3
"""Marches schemes beside plain C loops that do the same, interleaved, and prints best times and their ratios.

The speed of a machine drifts by tens of per cent within minutes, so only ratios of runs that alternate mean anything.
All programs end with the same energy, which is checked to 1e-9, so they do the same work. The script adds a line with
the results to scripts/bench/history.jsonl.
"""
import itertools
import statistics
import sys

import bench_others
import bench_runs
from bench_runs import listed

PARTICLES, DRIFTS = (10_000, 1_000_000, 8_000_000), ("0", "0.01", "0.3")
WORK, MOST_STEPS, LEAST_STEPS = 4e7, 1000, 20  # particles x steps of a run
MIGRATES = 250  # steps, in which particles move 75 cells and leave the ghost layer of 64 cells
SAME = 1e-9
BOX_WORK, SPEED_UP, BOX_BYTES = 1e7, 1.85, 200  # particles x steps; targets in more dimensions
MOST_BOX_STEPS = 200  # of a small box, which is run for its energy and not for its time
LINE_TARGETS, LINE_BYTES = {"gas2": 0.8, "usl": 0.8}, 80  # ratio to plain C, where it is not 1; bytes a particle
FINITE_TARGET, FINITE_DRIFTS = 0.7, ("0", "0.01")
LAW_TARGET, LAW_SPEED_UP = 2.0, 1.6  # ratio to the elastic law; two ranks beside one
STEP_TARGETS = {"verlet": 1.35, "rk4": 2.6, "rk4 nodes": 2.6}  # ratio to usl
STEP_CELLS, STEP_WORK = {2: 256, 3: 32}, 40  # cells along each direction; steps
BOUND_CELLS, BOUND_STEPS = {2: 96, 3: 20}, 100
WATCH_TARGET, CERTIFICATE_TARGET = 0.35, 0.15  # of a step, for each step of a run
BOX_COLUMNS = f"d {'cells':>5} {'':4} {'basis':9} {'drift':>5} {'jitter':>6} {'plain C':>7} {'1 rank':>7} {'2 ranks':>7}" \
              f"  {'ratio':>5} {'target':>6} {'':7} {'speed-up':>8} {'pair':>5}"
COLUMNS = f"{'scheme':8} {'basis':9} {'particles':>9} {'drift':>5}  {'plain C':>13} {'1 rank':>13} {'2 ranks':>13}" \
          f" {'numba':>6}  {'1/plain':>14} {'speed-up':>8} {'pair':>4} {'waits':>5}  {'bytes':>5} {'GB/s':>5} {'share':>5} {'c t / h':>7}"


def arguments():
    parser = bench_runs.parser(__doc__, 5)
    parser.add_argument("--schemes", type=listed(bench_runs.SCHEMES), default=bench_runs.SCHEMES)
    parser.add_argument("--bases", type=listed(bench_runs.BASES), default=bench_runs.BASES)
    parser.add_argument("--particles", type=listed((), int), default=(1_000_000,), help="two a cell")
    parser.add_argument("--drifts", type=listed(DRIFTS), default=("0", "0.3"), help=f"some of {','.join(DRIFTS)}")
    parser.add_argument("--all", action="store_true", help="every row: particles and drifts too; half an hour")
    parser.add_argument("--no-memory", action="store_true", help="leave out gas2 with 8e6 particles, for its memory")
    parser.add_argument("--no-numba", action="store_true", help="leave out numba, for gas2")
    parser.add_argument("--boxes", type=listed(("1e3", "1e6", "4e6")), default=("1e6",), help="particles in 2-D and 3-D")
    parser.add_argument("--finite", action="store_true", help="only marches at finite strain, in two and three dimensions, and laws that flow")
    parser.add_argument("--bounds", action="store_true", help="only what bounds of the step cost in a run with courant auto")
    parser.add_argument("--only-boxes", action="store_true", help="leave out one dimension")
    parser.add_argument("--only-steps", action="store_true", help="only the steps of momentum beside one another")
    parser.add_argument("--others", action="store_true", help="beside Taichi and Warp too, which it installs for the time")
    args = parser.parse_args()
    if args.all:
        args.particles, args.drifts, args.boxes = PARTICLES, DRIFTS, ("1e6", "4e6")
    if min(args.particles) < 1000:
        parser.error("--particles: less than 1000")
    return args


def steps_for(particles):
    return int(min(MOST_STEPS, max(LEAST_STEPS, WORK // particles)))


def measure(row, repeats, python):
    """Fills a row with best and median times, ratios and bytes."""
    programs = {"plain": bench_runs.run_plain, "1": lambda r: bench_runs.run_mpmstab(r, 1),
                "2": bench_runs.run_two_ranks}
    if python and row["scheme"] == "gas2":
        programs["numba"] = lambda r: bench_runs.run_numba(python, r)
    times, waits = {name: [] for name in programs}, []
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
            waits += more[1:]
        times.setdefault("pair", []).append(bench_runs.run_pair(row))
    row["best"] = {name: min(values) for name, values in times.items()}
    row["median"] = {name: statistics.median(values) for name, values in times.items()}
    row["ratio"] = row["best"]["1"] / row["best"]["plain"]
    row["ratio_median"] = statistics.median(a / b for a, b in zip(times["1"], times["plain"]))
    row["speed_up"] = row["best"]["1"] / row["best"]["2"]
    row["speed_up_pair"] = row["best"]["1"] / row["best"]["pair"]
    row["waits"] = statistics.median(waits)


def show(row, triad):
    """Prints a row of the table. The share of the memory's bandwidth is there when the arrays fit into no cache."""
    best, median = row["best"], row["median"]
    cells = " ".join(f"{best[name]:6.2f} ({median[name]:4.1f})" for name in ("plain", "1", "2"))
    rate = row["bytes"] / best["1"]
    share = f"{rate / triad:5.2f}" if row["particles"] >= 8_000_000 else f"{'-':>5}"
    covered = bench_runs.covered(row["scheme"], row["basis"], row["drift"] != "0", best["1"], row["particles"])
    covered = f"{'-':>7}" if covered is None else f"{covered:7.1f}"
    numba = f"{best['numba']:6.1f}" if "numba" in best else f"{'-':>6}"
    print(f"{row['scheme']:8} {row['basis']:9} {row['particles']:9} {row['drift']:>5}  {cells} {numba}  "
          f"{row['ratio']:6.2f} ({row['ratio_median']:4.2f}) {row['speed_up']:8.2f} {row['speed_up_pair']:4.2f} "
          f"{row['waits']:5.2f}  {row['bytes']:5.0f} {rate:5.1f} {share} {covered}", flush=True)


def show_targets(rows):
    """Prints on how many rows the march meets its targets, where there are particles enough for a target."""
    large = [row for row in rows if row["particles"] >= 1_000_000]
    if large:
        fast = sum(row["ratio"] <= LINE_TARGETS.get(row["scheme"], 1.0) for row in large)
        print(f"\nbeside plain C, from 1e6 particles: target 1.0, gas2 and usl 0.8: met on {fast} of {len(large)} rows")
    largest = [row for row in rows if row["particles"] >= 8_000_000]
    if largest:
        parallel = sum(row["speed_up"] >= min(SPEED_UP, row["speed_up_pair"]) for row in largest)
        print(f"2 ranks, from 8e6 particles: target {SPEED_UP} or the speed-up of a pair: met on {parallel} of {len(largest)} rows")


def box_target(row):
    """The share of plain C's time that a row may take on one rank."""
    if row["jitter"] != "0":
        return 0.5
    return 0.2 if row["dim"] == 3 and row["basis"] == "quadratic" else 0.3


def box_rows(args):
    for dim, size, basis in itertools.product(bench_runs.BOXES, args.boxes, bench_runs.NODES):
        steps = min(MOST_BOX_STEPS, max(6, int(BOX_WORK // float(size))))
        row = {"dim": dim, "cells": bench_runs.BOXES[dim][size], "basis": basis, "steps": steps}
        few = steps == MOST_BOX_STEPS  # of a small box the time says nothing: one row of each loop
        for drift, jitter in itertools.product(("0", "0.01"), ("0", "0.4")):
            if not few or drift != "0":
                yield row | {"transfer": "flip", "drift": drift, "jitter": jitter}
            if basis != "linear" and drift == "0" and not (few and basis == "cubic"):
                yield row | {"transfer": "apic", "drift": drift, "jitter": jitter}


def measure_box(row, repeats):
    """Measures a row in more dimensions beside a plain C loop of the same, and prints it."""
    programs = {"plain": bench_runs.run_plain_box, "1": lambda r: bench_runs.run_box(r, 1),
                "2": lambda r: bench_runs.run_box(r, 2)}
    times = {name: [] for name in (*programs, "pair")}
    for _ in range(repeats):
        for name, run in programs.items():
            ns, energy = run(row)
            times[name].append(ns)
            if name == "plain":
                expected = energy
            elif abs(energy - expected) > SAME * expected:
                sys.exit(f"bench: {name} does not do what plain C does: {row}: energy {energy} and {expected}")
        times["pair"].append(bench_runs.run_box_pair(row))
    best = row["best"] = {name: min(values) for name, values in times.items()}
    row["ratio"], row["target"] = best["1"] / best["plain"], box_target(row)
    row["speed_up"], row["speed_up_pair"] = best["1"] / best["2"], best["1"] / best["pair"]
    fast = bench_runs.met(row["ratio"] <= row["target"])
    parallel = bench_runs.met(row["speed_up"] >= min(SPEED_UP, row["speed_up_pair"]))
    print(f"{row['dim']} {row['cells']:5} {row['transfer']:4} {row['basis']:9} {row['drift']:>5} {row['jitter']:>6} "
          + " ".join(f"{best[name]:7.1f}" for name in ("plain", "1", "2"))
          + f"  {row['ratio']:5.2f} {row['target']:6.1f} {fast:7} {row['speed_up']:8.2f} {row['speed_up_pair']:5.2f} "
          f"{parallel}", flush=True)
    return row


def measure_finite(args):
    """Measures marches at finite strain beside plain C loops of the same, and prints them."""
    rows = []
    print(f"usl at finite strain, neo, quadratic, {bench_runs.PPC} particles a cell in each direction\n"
          f"ns per particle and step, best of {args.repeats}; ratio of 1 rank to plain C\n\n"
          f"d {'cells':>5} {'drift':>5} {'plain C':>7} {'1 rank':>7}  {'ratio':>5} {'target':>6}")
    for dim, size, drift in itertools.product(bench_runs.BOXES, args.boxes, FINITE_DRIFTS):
        row = {"dim": dim, "cells": bench_runs.BOXES[dim][size], "drift": drift, "amplitude": "0.1",
               "steps": min(MOST_BOX_STEPS, max(20, int(BOX_WORK // float(size))))}
        times = {"plain": [], "1": []}
        for _ in range(args.repeats):
            ns, expected = bench_runs.run_plain_finite(row)
            times["plain"].append(ns)
            ns, energy = bench_runs.run_finite(row, 1)
            times["1"].append(ns)
            if abs(energy - expected) > SAME * expected:
                sys.exit(f"bench: 1 does not do what plain C does: {row}: energy {energy} and {expected}")
        best = row["best"] = {name: min(values) for name, values in times.items()}
        row["ratio"], row["target"] = best["1"] / best["plain"], FINITE_TARGET
        print(f"{dim} {row['cells']:5} {drift:>5} {best['plain']:7.1f} {best['1']:7.1f}  {row['ratio']:5.2f} "
              f"{FINITE_TARGET:6.1f} {bench_runs.met(row['ratio'] <= FINITE_TARGET)}", flush=True)
        rows.append(row)
    return rows


def measure_laws(args):
    """Measures laws that flow beside an elastic one in turn, on one rank and on two, in three dimensions."""
    rows = []
    print(f"\nlaws that flow: usl at finite strain, quadratic, 3-D, {bench_runs.PPC} particles a cell in each direction\n"
          f"ns per particle and step, best of {args.repeats}; ratio of 1 rank to neo; speed-up of 2 ranks\n\n"
          f"{'cells':>5} {'law':6} {'1 rank':>7} {'2 ranks':>7}  {'ratio':>5} {'target':>6} {'':7} {'speed-up':>8} {'target':>6}")
    for size in args.boxes:
        row = {"dim": 3, "cells": bench_runs.BOXES[3][size], "drift": "0.01", "amplitude": "0.1",
               "steps": min(MOST_BOX_STEPS, max(20, int(BOX_WORK // float(size))))}
        times = {law: {1: [], 2: []} for law in bench_runs.LAWS}
        for _, law, ranks in itertools.product(range(args.repeats), bench_runs.LAWS, (1, 2)):
            times[law][ranks].append(bench_runs.run_finite(row | {"law": {"material": law, **bench_runs.LAWS[law]}}, ranks)[0])
        for law, found in times.items():
            best = {str(ranks): min(ns) for ranks, ns in found.items()}
            rows.append(row | {"law": law, "best": best, "ratio": best["1"] / min(times["neo"][1]), "speed_up": best["1"] / best["2"]})
            print(f"{row['cells']:5} {law:6} {best['1']:7.1f} {best['2']:7.1f}  {rows[-1]['ratio']:5.2f} {LAW_TARGET:6.1f} "
                  f"{bench_runs.met(rows[-1]['ratio'] <= LAW_TARGET):7} {rows[-1]['speed_up']:8.2f} {LAW_SPEED_UP:6.1f} "
                  f"{bench_runs.met(rows[-1]['speed_up'] >= LAW_SPEED_UP)}", flush=True)
    return rows


def measure_bounds(args):
    """Measures the bounds of a run that chooses its steps beside its passes, sums over ranks and migrations, in the same run."""
    rows = []
    print(f"bounds with courant auto: usl apic, neo, {bench_runs.PPC} particles a cell in each direction, jittered, Mach {bench_runs.MACH}\n"
          f"in steps, least of {args.repeats}: a watch, watches for each step of the run, certificates for each step; a certificate\n\n"
          f"d {'cells':>5} {'basis':9} {'watch':>6} {'a step':>7} {'target':>6} {'':7} {'certified':>9} {'target':>6} {'':7} {'one':>6}")
    for dim, size, basis in itertools.product(bench_runs.BOXES, args.boxes, bench_runs.BASES):
        row = {"dim": dim, "cells": min(bench_runs.BOXES[dim][size], BOUND_CELLS[dim]), "basis": basis, "steps": BOUND_STEPS}
        found = [bench_runs.run_bounds(row) for _ in range(args.repeats)]
        steps = [sum(one[name] for name in ("MpmPass", "MpmGridSum", "MpmMigrate")) for one in found]
        row["watches"] = min(one["MpmWatch"] / step for one, step in zip(found, steps))
        row["certificates"] = min(one["MpmCertificate"] / step for one, step in zip(found, steps))
        row["watch"] = row["watches"] * BOUND_STEPS / found[0]["looks"]
        row["certificate"] = row["certificates"] * BOUND_STEPS / found[0]["certificates"]
        print(f"{dim} {row['cells']:5} {basis:9} {row['watch']:6.2f} {row['watches']:7.3f} {WATCH_TARGET:6.2f} "
              f"{bench_runs.met(row['watches'] <= WATCH_TARGET):7} {row['certificates']:9.3f} {CERTIFICATE_TARGET:6.2f} "
              f"{bench_runs.met(row['certificates'] <= CERTIFICATE_TARGET):7} {row['certificate']:6.1f}", flush=True)
        rows.append(row)
    return rows


def measure_boxes(args):
    print(f"usl, {bench_runs.PPC} particles a cell in each direction, nu 0.3; apic has the gradients of MLS-MPM.\n"
          f"ns per particle and step, best of {args.repeats}; ratio of 1 rank to plain C; speed-up of 2 ranks, target "
          f"{SPEED_UP} or that of a pair of programs\n")
    print(BOX_COLUMNS)
    return [measure_box(row, args.repeats) for row in box_rows(args)]


def measure_steps(args):
    """Measures steps of momentum in turn, and prints their times over that of usl, and what a second of run time covers."""
    print(f"steps beside usl, flip, {bench_runs.PPC} particles a cell in each direction, nu 0.3\n"
          f"ns per particle and step, best of {args.repeats}; ratio to usl. c t / h: what a second covers at the largest k without "
          f"growth in one\ndimension, at rest or at Mach {bench_runs.MACH}\n\n"
          f"d {'cells':>5} {'basis':9} {'drift':>5} {'jitter':>6} {'step':9} {'plain C':>7} {'1 rank':>7}  {'ratio':>5} {'target':>6} "
          f"{'':7} {'c t / h':>7}")
    rows = []
    for dim, basis, drift, jitter in itertools.product(STEP_CELLS, bench_runs.BASES, ("0", "0.01"), ("0", "0.4")):
        cells = min(STEP_CELLS[dim], *(bench_runs.BOXES[dim][size] for size in args.boxes))
        row = {"dim": dim, "cells": cells, "basis": basis, "transfer": "flip", "drift": drift, "jitter": jitter,
               "steps": STEP_WORK}
        times = {step: {"plain": [], "1": []} for step in bench_runs.STEPS}
        for _, step in itertools.product(range(args.repeats), bench_runs.STEPS):
            ns, energy = bench_runs.run_step(row, step)
            times[step]["1"].append(ns)
            name = "flip" if step == "usl" else step
            if name not in bench_runs.PLAIN_STEPS:
                continue
            ns, expected = bench_runs.run_plain_box(row, name)
            times[step]["plain"].append(ns)
            if abs(energy - expected) > SAME * expected:
                sys.exit(f"bench: {step} does not do what plain C does: {row}: energy {energy} and {expected}")
        rows += [show_step(row, step, times) for step in bench_runs.STEPS]
    return rows


def show_step(row, step, times):
    best = {name: min(values) for name, values in times[step].items() if values}
    ratio, target = best["1"] / min(times["usl"]["1"]), STEP_TARGETS.get(step)
    particles = (bench_runs.PPC * row["cells"]) ** row["dim"]
    covered = bench_runs.covered(step, row["basis"], row["drift"] != "0", best["1"], particles)
    plain = f"{best['plain']:7.1f}" if "plain" in best else f"{'-':>7}"
    verdict = f"{target:6.2f} {bench_runs.met(ratio <= target):7}" if target else f"{'-':>6} {'':7}"
    print(f"{row['dim']} {row['cells']:5} {row['basis']:9} {row['drift']:>5} {row['jitter']:>6} {step:9} {plain} {best['1']:7.1f}  "
          f"{ratio:5.2f} {verdict} {covered:7.1f}", flush=True)
    return row | {"step": step, "best": best, "ratio": ratio, "covered": covered}


def box_memory():
    """Measures the bytes that a particle takes in three dimensions: of 4e6 beyond those of a few."""
    row = {"dim": 3, "basis": "quadratic", "transfer": "flip", "drift": "0", "jitter": "0.4", "steps": 2}
    many, few = (bench_runs.BOXES[3]["4e6"], 8)
    peaks = [bench_runs.peak_bytes(bench_runs.box_options(row | {"cells": cells}), 1) for cells in (many, few)]
    found = (peaks[0] - peaks[1]) / (bench_runs.PPC * many) ** 3
    print(f"memory: usl quadratic, jittered, {(bench_runs.PPC * many) ** 3} particles in three dimensions: {found:.0f} "
          f"bytes a particle; target {BOX_BYTES}: {bench_runs.met(found <= BOX_BYTES)}", flush=True)
    return found


def memory(ranks):
    """Measures bytes per particle, in all and beyond a march of few particles. Both marches migrate."""
    many, few = ({"scheme": "gas2", "basis": "linear", "particles": n, "drift": "0.3", "steps": MIGRATES}
                 for n in (8_000_000, 1000))
    peak, least = (bench_runs.peak_bytes(bench_runs.options(row), ranks) for row in (many, few))
    entry = {"ranks": ranks, "bytes": peak / many["particles"], "without_program": (peak - least) / many["particles"]}
    print(f"memory: gas2, 8000000 particles, ranks {ranks}: {entry['bytes']:.1f} bytes a particle at its largest, "
          f"{entry['without_program']:.1f} without what the program itself takes; target {LINE_BYTES}: "
          f"{bench_runs.met(entry['bytes'] <= LINE_BYTES)}", flush=True)
    return entry


def main():
    args = arguments()
    result = bench_runs.begin("march", args)
    if args.finite:
        bench_runs.compile_finite()
        result["finite"] = measure_finite(args)
        result["laws"] = measure_laws(args)
        bench_runs.keep(result, args)
        return
    if args.bounds:
        result["bounds"] = measure_bounds(args)
        bench_runs.keep(result, args)
        return
    bench_runs.compile_all()
    if args.only_steps:
        result["steps"] = measure_steps(args)
        bench_runs.keep(result, args)
        return
    python, why = (None, "not asked") if args.no_numba else bench_runs.numba_python()
    if not python:
        print(f"no numba: {why}")
    result |= {"triad_gb_per_s": [max(bench_runs.triad(n) for _ in range(3)) for n in (1, 2)], "rows": []}
    print("triad: {:.1f} GB/s for one process, {:.1f} for two together".format(*result["triad_gb_per_s"]))
    print(f"The times are ns per particle and step: the best of {args.repeats}, and in brackets the median.\n"
          "1/plain is the time on 1 rank over that of plain C: of the best, and in brackets the median of pairs.\n"
          "speed-up is that of 2 ranks. pair is that of two programs side by side, each with half the particles: they\n"
          "send no messages. waits is the part of its steps that a rank of two waits for the other, the median. A step moves\n"
          "so many bytes per particle, on 1 rank at this rate; share is the rate over triad's. c t / h is what a second of\n"
          "run time on 1 rank covers at the largest k without growth, at rest or at Mach 1/10.\n")
    print(COLUMNS)
    lines = () if args.only_boxes else itertools.product(args.particles, args.schemes, args.bases, args.drifts)
    for particles, scheme, basis, drift in lines:
        row = {"scheme": scheme, "basis": basis, "particles": particles, "drift": drift, "steps": steps_for(particles)}
        measure(row, args.repeats, python)
        show(row, result["triad_gb_per_s"][0])
        result["rows"].append(row)
    show_targets(result["rows"])
    print()
    result["boxes"] = measure_boxes(args)
    print()
    result["steps"] = measure_steps(args)
    print()
    result["bounds"] = measure_bounds(args)
    if args.others:
        result["others"] = bench_others.measure(args.repeats)
    if not args.no_memory:
        result["box_memory"] = box_memory()
    if not args.no_memory and not args.only_boxes:
        result["memory"] = [memory(ranks) for ranks in (1, 2)]
    bench_runs.keep(result, args)


if __name__ == "__main__":
    main()
