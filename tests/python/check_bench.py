#!/usr/bin/python3
"""Checks a part of the benchmark on tiny sizes, by what it finds and by its formulas, never by how long it takes.

check_bench.py spectrum|phases|startup|growth|scaling|boxes|targets. MPMSTAB names the program. Silent when all is well.
"""
import argparse
import contextlib
import io
import json
import math
import os
import sys
import tempfile

import numpy

from checks import check, run_script
import bench_boxes
import bench_growth
import bench_march
import bench_scaling
import bench_spectrum
import scipy_spectrum

K = 0.5  # the Courant number of bench_spectrum's scenes
CSV = """Stage Name,Event Name,Rank,Count,Time,Num Messages,Message Length,Num Reductions,FLOP
Main Stage,summary,0,1,0.1,{},{},{},5.
Main Stage,MpmMigrate,0,{},0.1,{},{},{},0.
Main Stage,summary,1,1,0.1,1.,8.,1.,5.
Main Stage,MpmMigrate,1,0,0.1,0.,0.,0.,0.
"""


def near(a, b, within=1e-12):
    return abs(a - b) <= within * max(abs(a), abs(b))


def run(part, *options):
    """Runs a part and returns the line of JSON that it adds to a history of its own."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "history.jsonl")
        done = run_script(f"bench/bench_{part}.py", "--history", path, *options)
        check(done.returncode == 0 and done.stderr == "", f"{part}: status {done.returncode}: {done.stderr}")
        with open(path, encoding="utf-8") as file:
            lines = [json.loads(line) for line in file]
    check(len(lines) == 1, f"{part}: {len(lines)} lines of history")
    found = lines[0]
    check(found["part"] == part and all(found[name] for name in ("date", "processor", "compiler", "revision")),
          f"{part}: does not say what was run where: {found}")
    return found


def check_matrix():
    """The matrix for other solvers must be the operator of gas2: G + 1/G = 2 - k^2 sin^2 beta, particles centred."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "A")
        bench_spectrum.write_matrix(96, path)
        values = numpy.linalg.eigvals(scipy_spectrum.read(path).toarray())
    for m in range(24):
        real = 1 - (K * math.sin(2 * math.pi * m / 24)) ** 2 / 2
        distance = min(abs(values - complex(real, math.sqrt(1 - real**2))))
        check(distance < 1e-6, f"matrix: no eigenvalue at phase {m}, the nearest is {distance:.3g} away")


def check_spectrum():
    check_matrix()
    found = run("spectrum", "--orders", "8000", "--dense", "200", "--restarts", "3", "--symbol", "1000", "--map", "8",
                "--bar", "80", "--plane", "8", "--space", "4", "--layouts", "4", "--repeats", "1")
    row = found["near"][0]
    expected = complex(1 - K**2 / 2, math.sqrt(1 - (1 - K**2 / 2) ** 2))  # at beta = pi / 2, 8000 / 4 cells have it
    theirs = row["arpack_found"]
    check(abs(complex(*row["target"]) - expected) < 1e-8, f"target {row['target']}, not {expected}")
    check(abs(complex(*row["mpmstab_found"]) - expected) < 1e-8, f"mpmstab: {row['mpmstab_found']}, not {expected}")
    check("why" not in theirs, f"ARPACK gave no answer: {theirs.get('why')}")
    check(abs(complex(theirs["re"], theirs["im"]) - expected) < 1e-8, f"ARPACK: {theirs}, not {expected}")
    check(row["same"] and row["nonzeros"] == 92000, f"spectrum: {row}")
    check(near(row["ratio"], row["arpack"]["best"] / row["mpmstab"]["best"]), f"ratio: {row}")
    check(row["arpack_alone"]["restarts"] == 3 and row["arpack_alone"]["converged"] in (0, 1), f"ARPACK alone: {row}")
    dense = found["all"][0]
    check(dense["same"] and dense["listed"] == 200 and abs(dense["numpy_radius"] - 1) < 1e-6, f"all: {dense}")
    check([sum(row["task"] == task for row in found["tasks"]) for task in ("symbol", "critical", "map")] == [3, 12, 1],
          f"tasks: {found['tasks']}")
    check([row["nodal_unknowns"] for row in found["nodal"]] == [160, 4 * 64, 4 * 64, None, 6 * 64],  # None: modes of the symbol
          f"{found['nodal']}")
    check(found["powers"]["same"] and found["powers"]["apart"] < 1e-11, f"powers: {found['powers']}")
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        bench_spectrum.show_near(row | {"same": False, "difference": 0.25})
    check("another eigenvalue, 0.25 away: not compared" in said.getvalue() and "times as fast" not in said.getvalue(),
          f"two eigenvalues are compared: {said.getvalue()}")


def check_phases():
    found = run("phases", "--plane", "8", "--space", "4", "--turns", "4", "--dims", "2", "--drifts", "0", "--repeats", "1")
    check([(row["task"], row["ranks"], row["target_s"]) for row in found["tasks"]] ==
          [("symbol", 1, 1), ("symbol", 2, 60), *[("symbol", 1, None)] * 7, ("critical", 1, 0.1)], f"{found['tasks']}")
    check([row["order"] for row in found["factors"]] == [4, 20, 72, 144], f"{found['factors']}")
    for row in found["factors"]:
        rates = 40 * row["order"]**3 / row["own_s"], 2 * row["dgemm_order"]**3 / row["dgemm_s"]
        check(near(row["rate"], rates[0] / rates[1], 1e-9), f"rate: {row}")


def check_startup():
    rows = run("startup", "--repeats", "2")["rows"]
    check([row["launcher"] for row in rows] == ["without mpirun", "mpirun -n 1", "mpirun -n 2"], f"startup: {rows}")
    for row in rows:
        for task in ("list", "symbol"):
            beyond = row["seconds"][task]["best"] - row["seconds"]["SLEPc alone"]["best"]
            check(near(row["beyond"][task], beyond) and row["seconds"][task]["best"] > 0, f"startup: {row}")


def check_growth():
    sizes = [10, 1000, 2000, 5000, 10_000]
    seconds = [7.0] + [3e-9 * n**1.5 for n in sizes[1:]]
    check(near(bench_growth.exponent(sizes, seconds, 1000), 1.5), "exponent: not 1.5 of n^1.5 beyond the start")
    check(bench_growth.exponent(sizes, seconds, 1) < 0, "exponent: all sizes are not fitted when asked for")
    check(bench_growth.exponent(sizes, seconds, 10_000) is None, "exponent: of a single size")
    found = run("growth", "--particles", "1000,2000,8000", "--orders", "1000,8000,12000", "--from", "2000,8000",
                "--per-rank", "1000", "--repeats", "1")
    rows = found["march"]["rows"]
    check([row["particles"] for row in rows] == [1000, 2000, 8000], f"march: {rows}")
    slope = numpy.polyfit(numpy.log([2000, 8000]), numpy.log([row["best"] for row in rows[1:]]), 1)[0]
    check(near(found["march"]["fit"]["exponent"], slope, 1e-8), f"march: {found['march']}, not {slope}")
    rows = found["spectrum"]["rows"]
    check([(row["unknowns"], row["what"]) for row in rows] ==
          [(1000, "all"), (8000, "near a target"), (12000, "near a target")], f"spectrum: {rows}")
    slope = numpy.polyfit(numpy.log([8000, 12000]), numpy.log([row["solve"]["best"] for row in rows[1:]]), 1)[0]
    check(near(found["spectrum"]["fit"]["solve"]["exponent"], slope, 1e-8), f"solve: {found['spectrum']}, not {slope}")
    weak = found["weak"]
    check(weak["per_rank"] == 1000 and near(weak["efficiency"], weak["one"]["best"] / weak["two"]["best"]), f"{weak}")


def check_formulas():
    """Checks the counts and the model on made-up numbers."""
    few, many = (bench_scaling.read_counts(CSV.format(*counts).splitlines()) for counts in
                 ((30, 1000, 22, 0, 0, 0, 0), (30 + 1600 + 24, 1000 + 192_000 + 5760, 22 + 50 + 24, 2, 24, 5760, 24)))
    counts = bench_scaling.per_step(few, many, 100)
    check(counts == {"messages": 8, "bytes": 120, "reductions": 0.5, "migrations": 0.02,
                     "migration": {"messages": 6, "bytes": 240, "reductions": 12}}, f"counts: {counts}")
    network = {"latency": 1e-6, "bandwidth": 1e9}
    model = {"t0": 1e-6, "tp": 1e-9, "counts": {"3": counts, "2": counts | {"messages": 4}}}
    expected = 1e-6 + 1e-3 / 1024 + 8 * 1.12e-6 + 0.5 * 10e-6 + 0.02 * (6 * 1.24e-6 + 12 * 10e-6)
    time = bench_scaling.step_time(model, 1e6, 1024, network)
    check(near(time, expected), f"model: {time} on 1024 ranks, not {expected}")
    check(near(bench_scaling.step_time(model, 1e6, 1, network), 1e-6 + 1e-3), "model: messages on one rank")
    check(near(bench_scaling.messages_time(model, 2, network),
               4 * 1.12e-6 + 0.5e-6 + 0.02 * (6 * 1.24e-6 + 12e-6)), "model: not the counts of 2 ranks")
    check(near(bench_scaling.efficiency(model, 1e6, 1024, network), (1e-6 + 1e-3) / 1024 / expected), "efficiency")
    half = bench_scaling.half_messages(model, 1e6, network)
    shares = [bench_scaling.messages_time(model, p, network) / bench_scaling.step_time(model, 1e6, p, network)
              for p in (half - 1, half)]
    check(shares[0] < 0.5 <= shares[1], f"half of the time is messages from {half} ranks on, with shares {shares}")
    check(bench_scaling.half_messages(model | {"t0": 1.0}, 1e6, network) is None, "messages are never half of a second")


def check_scaling():
    check_formulas()
    check([bench_scaling.cells_needed(*scheme) for scheme in (("gas2", "linear"), ("elastic", "quadratic"))] == [1, 3],
          "cells that a rank needs")
    found = run("scaling", "--particles", "10000", "--count-steps", "256", "--repeats", "1")
    rest, drifting = found["models"]
    for model in (rest, drifting):
        two, three = model["counts"]["2"], model["counts"]["3"]
        check(three["messages"] == 2 * two["messages"] >= 4, f"both neighbours are one on 2 ranks: {model['counts']}")
        both = [counts["messages"] * counts["bytes"] for counts in (two, three)]  # but for migrations, to 1e-5
        check(abs(both[0] - both[1]) <= 1e-4 * both[0], f"bytes: {model['counts']}")
        check(0 <= three["reductions"] <= 1 and model["tp"] > 0, f"model: {model}")
        check([(row["particles"], row["ranks"]) for row in model["check"]] ==
              [(n, p) for n in (1000, 10_000) for p in (1, 2)], f"check: {model['check']}")
        strong = model["rows"][0]["ranks"]["1000"]["seconds"]
        check(near(strong, bench_scaling.step_time(model, 8e6, 1000, found["network"])), f"rows: {model['rows']}")
    still = rest["counts"]["3"]
    check(still["migrations"] == 0 and still["bytes"] % 8 == 0, f"at rest: {still}")
    migrations = drifting["counts"]["3"]["migrations"]
    check(0.5 * 0.3 / 64 <= migrations <= 2 * 0.3 / 64 and drifting["counts"]["3"]["migration"]["messages"] > 0, f"drifting: {drifting}")


def check_boxes():
    """Checks the model on made-up numbers, and that the counted bytes are those of the nodes that ranks share."""
    network = {"latency": 1e-6, "bandwidth": 1e9}
    shapes = {"slabs": {"messages": 2, "fields": 4, "reductions": 0}, "blocks": {"messages": 8, "fields": 4, "reductions": 0.5}}
    model = {"dim": 2, "width": 2, "tp": 1e-9, "t0": 1e-6, "shapes": shapes}
    cells = 512  # 4e6 / 4 particles on 16 ranks: slabs of 512 x 32, blocks of 128 x 128
    sides, corners = 4 * 4 * (128 + 4), 4 * 4 * 4
    time = {"slabs": 2e-6 + 8 * 4 * 2 * 4 * cells / 1e9, "blocks": 8e-6 + 8 * 4 * (sides + corners) / 1e9 + 0.5 * 4e-6}
    for shape, sent in time.items():
        expected = 1e-6 + 1e-9 * 4 * cells ** 2 / 16 + sent
        found = bench_boxes.step_time(model, shape, 4 * cells ** 2, 16, network)
        check(near(found, expected), f"boxes: {shape}: {found}, not {expected}")
    check(bench_boxes.fits(model, "slabs", 4 * 64 ** 2, 32) and not bench_boxes.fits(model, "slabs", 4 * 64 ** 2, 33),
          "boxes: slabs may be as thin as their ghosts")
    check(bench_boxes.width_of(2) == 2, "boxes: quadratic splines have ghosts two wide")
    for along, neighbours in (((1, 3), 2), ((3, 1), 2), ((3, 3), 8)):
        counts = bench_boxes.counts_of(2, along)
        part = [(bench_boxes.COUNTED_CELLS[2] / n, n > 1) for n in along]
        fields = counts["bytes"] / 8 / bench_boxes.shared_nodes(part, 2)
        check(near(fields, 4) and counts["messages"] == neighbours, f"boxes: {along}: {counts}, {fields} fields")
    bench_boxes.bench_runs.BOXES[2]["1e6"] = 24
    once = argparse.Namespace(repeats=1)
    small = bench_boxes.make_model(2, once)
    rows = bench_boxes.check(small, once, network)["rows"]
    check([row["particles"] for row in rows] == [48 ** 2, 48 ** 2, 48 ** 2 // 2], f"boxes: {rows}")


def check_targets():
    """Checks how many rows of made-up times meet the march's targets: of few particles none is asked for one."""
    rows = [{"scheme": scheme, "particles": particles, "ratio": ratio, "speed_up": two, "speed_up_pair": pair}
            for scheme, particles, ratio, two, pair in (("gas1", 8_000_000, 0.9, 1.8, 1.9), ("usl", 8_000_000, 0.9, 1.9, 2.0),
                                                        ("gas2", 1_000_000, 0.8, 1.0, 2.0), ("gas2", 1000, 0.1, 2.0, 1.0),
                                                        ("musl", 8_000_000, 1.1, 1.5, 1.4))]
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        bench_march.show_targets(rows)
    lines = said.getvalue().split("\n")
    check(lines[1].endswith("met on 2 of 4 rows") and lines[2].endswith("met on 2 of 3 rows"), f"targets: {lines}")
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        bench_march.show_targets(rows[3:4])
    check(said.getvalue() == "", f"targets of few particles: {said.getvalue()}")


if __name__ == "__main__":
    parts = {"spectrum": check_spectrum, "phases": check_phases, "startup": check_startup, "growth": check_growth,
             "scaling": check_scaling, "boxes": check_boxes, "targets": check_targets}
    parts[sys.argv[1]]()
