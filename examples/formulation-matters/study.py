#!/usr/bin/python3
"""The slides' first conclusion: does the underlying formulation matter for stability, and for error against run time?

study.py [--quick] [-o FOLDER]: growth of all formulations and transfers on one gas and one bar, at rest and drifting an
eighth of a cell per step, by symbol and by marching, and the largest over 120 drifts; then their errors against run
time (scripts/work_precision.py), of which FOLDER (results) keeps tables and pictures. --quick: fewer schemes, grids.
"""
import csv
import os
import re
import subprocess
import sys
import tempfile
from fractions import Fraction

HERE = os.path.dirname(os.path.abspath(__file__))
SCRIPTS = os.path.join(HERE, os.pardir, os.pardir, "scripts")
sys.path.insert(0, SCRIPTS)
from program import (Parser, end_in_one_line, launch, require_outputs,  # noqa: E402 (the path comes first)
                     require_program)

PROBLEMS = {"gas": ("scene.yaml", "gas-drifts.yaml", ("gas1", "gas2"), ("flip", "pic", "blend", "xpic", "nullspace")),
            "bar": ("bar.yaml", "bar-drifts.yaml", ("elastic", "usl", "usf", "musl", "usavg"),
                    ("flip", "pic", "blend", "xpic", "nullspace", "apic"))}
QUICK = ("gas1", "gas2", "usl", "musl"), ("flip", "pic")
LINE = "{:<8} {:<9}  {:>7}  {:>9} {:>8}  {:>9} {:>8} {:>9}  {:>9} {:>6} {:>9} {:>6}"


def growth(scene, options):
    """By symbol, and of random data marched."""
    status, found, said = launch("spectrum", os.path.join(HERE, scene), {**options, "cells": 32})
    if status not in (0, 3):
        sys.exit(f"study.py: {scene} {options}: {said}")
    return found["predicted"]["symbol"], found["run"].get("growth_measured")


def limit(scene, options):
    """Largest stable Courant number at rest."""
    _, found, said = launch("critical", os.path.join(HERE, scene), options)
    if not found:
        sys.exit(f"study.py: critical {scene} {options}: {said}")
    value = found["critical"]["critical_courant"]
    return "none" if value is None else f"{value:.4f}"


def over_drifts(options):
    """The largest growth at k = 0.5 that is not lost to rounding, over drifts n/240, n = 1 to 120, and its drift."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "map.csv")
        status, _, said = launch("map", None, {**options, "phases": 256, "map_axes": "drift,courant", "csv": path,
                                               "map_drift": "0,1/2", "map_courant": "0.25,0.5", "map_points": "121,2"})
        if status:
            sys.exit(f"study.py: map {options}: {said}")
        with open(path, encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file) if float(row["courant"]) == 0.5 and float(row["drift"]) > 0]
    grow = [row for row in rows if row["verdict"] == "unstable"]
    if not grow:
        return ("?" if any(row["verdict"] == "undecided" for row in rows) else "1.000000"), "-"
    worst = max(grow, key=lambda row: float(row["growth"]))
    return f"{float(worst['growth']):.6f}", str(Fraction(float(worst["drift"])).limit_denominator(240))


def growth_table(formulations, transfers):
    print("growth per step at k = 0.5, ppc 2, 32 cells; limit: largest stable Courant number at rest, hats;\n"
          "1/8: drifting an eighth of a cell per step; measured: random data marched;\n"
          "any: the largest over drifts n/240 to 1/2 at 256 phases, and the drift that has it\n")
    print(LINE.format("", "", "", "at rest", "", "1/8", "", "1/8", "any", "", "any", "").rstrip())
    print(LINE.format("scheme", "transfer", "limit", "hats", "measured", "hats", "measured", "quadratic", "hats", "at",
                      "quadratic", "at"))
    for rest, drifts, schemes, ways in PROBLEMS.values():
        for scheme in filter(formulations.__contains__, schemes):
            for way in filter(transfers.__contains__, ways):
                if scheme == "elastic" and way == "apic":
                    continue  # no momentum to carry an affine velocity
                options = {"formulation": scheme, "transfer": way}
                at_rest, moving = growth(rest, options), growth(drifts, options)
                splines, _ = growth(drifts, {**options, "basis": "quadratic"})
                print(LINE.format(scheme, way, limit(rest, options), f"{at_rest[0]:.6f}", f"{at_rest[1]:.4f}",
                                  f"{moving[0]:.6f}", f"{moving[1]:.4f}", f"{splines:.6f}", *over_drifts(options),
                                  *over_drifts({**options, "basis": "quadratic"})), flush=True)


def run_times(formulations, transfers, quick, folder):
    """What work_precision.py says of the four scenes."""
    for problem, (rest, drifts, schemes, ways) in PROBLEMS.items():
        for scene, name in ((rest, problem), (drifts, f"{problem}-drifts")):
            print(f"\n{'-' * 30} {name}", flush=True)
            done = subprocess.run(
                [sys.executable, os.path.join(SCRIPTS, "work_precision.py"), os.path.join(HERE, scene),
                 "--cells", "16,32" if quick else "32,64,128,256", "--basis", "linear" if quick else "linear,quadratic",
                 "--formulation", ",".join(filter(formulations.__contains__, schemes)),
                 "--transfer", ",".join(filter(transfers.__contains__, ways)),
                 "--error", "1e-1" if quick else "1e-2,1e-3", "--courant", "0.5",
                 "--repeats", "1" if quick else "6", *(["--most", "1"] if quick else []), "-o", os.path.join(folder, name)], stdout=subprocess.PIPE, text=True, check=False)
            if done.returncode:
                sys.exit(done.returncode)  # it has said why
            print(done.stdout[re.search("^(for )?error [0-9]", done.stdout, re.MULTILINE).start():].strip())


def main():
    parser = Parser(__doc__)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("-o", "--output", metavar="FOLDER", default="results")
    arguments = parser.parse_args()
    require_program()
    os.makedirs(arguments.output, exist_ok=True)
    require_outputs([os.path.join(arguments.output, f"{name}{drifts}.{ending}") for name in PROBLEMS
                     for drifts in ("", "-drifts") for ending in ("csv", "png", "svg", "runs.jsonl")])
    everything = [{name for problem in PROBLEMS.values() for name in problem[part]} for part in (2, 3)]
    formulations, transfers = QUICK if arguments.quick else everything
    growth_table(formulations, transfers)
    run_times(formulations, transfers, arguments.quick, arguments.output)


if __name__ == "__main__":
    end_in_one_line(main)
