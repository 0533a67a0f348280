#!/usr/bin/python3
"""The slides' first conclusion: does the underlying formulation matter for stability, and for error against run time?

study.py [--quick] [-o FOLDER]: growth of all formulations and transfers on one gas and one bar, at rest and drifting an
eighth of a cell per step, by symbol and by marching; then their errors against run time (scripts/work_precision.py),
of which FOLDER (results) keeps tables and pictures. --quick: fewer schemes and grids.
"""
import os
import re
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SCRIPTS = os.path.join(HERE, os.pardir, os.pardir, "scripts")
sys.path.insert(0, SCRIPTS)
from program import Parser, end_in_one_line, launch, require_program  # noqa: E402 (the path comes first)

PROBLEMS = {"gas": ("scene.yaml", "gas-drifts.yaml", ("gas1", "gas2"), ("flip", "pic", "blend", "xpic", "nullspace")),
            "bar": ("bar.yaml", "bar-drifts.yaml", ("elastic", "usl", "usf", "musl", "usavg"),
                    ("flip", "pic", "blend", "xpic", "nullspace", "apic"))}
QUICK = ("gas1", "gas2", "usl", "musl"), ("flip", "pic")
LINE = "{:<8} {:<9}  {:>7}  {:>9} {:>8}  {:>9} {:>8}  {:>9}"


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


def growth_table(formulations, transfers):
    print("growth per step at k = 0.5, ppc 2, 32 cells; limit: largest stable Courant number at rest, hats;\n"
          "drifting: an eighth of a cell per step; measured: random data marched\n")
    print(LINE.format("", "", "", "at rest", "", "drifting", "", "drifting"))
    print(LINE.format("scheme", "transfer", "limit", "hats", "measured", "hats", "measured", "quadratic"))
    for rest, drifts, schemes, ways in PROBLEMS.values():
        for scheme in filter(formulations.__contains__, schemes):
            for way in filter(transfers.__contains__, ways):
                if scheme == "elastic" and way == "apic":
                    continue  # no momentum to carry an affine velocity
                options = {"formulation": scheme, "transfer": way}
                at_rest, moving = growth(rest, options), growth(drifts, options)
                splines, _ = growth(drifts, {**options, "basis": "quadratic"})
                print(LINE.format(scheme, way, limit(rest, options), f"{at_rest[0]:.6f}", f"{at_rest[1]:.4f}",
                                  f"{moving[0]:.6f}", f"{moving[1]:.4f}", f"{splines:.6f}"), flush=True)


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
                 "--error", "1e-1" if quick else "1e-2,1e-3", "--repeats", "1" if quick else "5",
                 "-o", os.path.join(folder, name)], stdout=subprocess.PIPE, text=True, check=False)
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
    everything = [{name for problem in PROBLEMS.values() for name in problem[part]} for part in (2, 3)]
    formulations, transfers = QUICK if arguments.quick else everything
    growth_table(formulations, transfers)
    run_times(formulations, transfers, arguments.quick, arguments.output)


if __name__ == "__main__":
    end_in_one_line(main)
