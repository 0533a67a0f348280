#!/usr/bin/python3
"""What the warning of 'run -tangent' is worth: nonlinear runs that fail and runs that do not, and which it warns of.

run_warnings.py [--window 320] [--above 5] [--rows 0,17] [--check FILE]

The runs are bars in a ring, neo-Hookean and stretched uniformly. They start from noise of 1e-6, or swing in their longest
wave. A run has failed when the program ends it (a particle is turned inside out, or goes a cell or more in a step), when
noise has grown 10000 times, or when the energy of the swing, which is that above the uniform bar's, has doubled: nothing gives
energy to the bar. A warning counts if it comes before that.

With --rows it takes these runs alone, counted from 0. With --check it fails unless each row that it prints is a row of FILE. The
environment variable MPMSTAB names the program (by default build/mpmstab).
"""
import csv
import itertools
import os
import re
import subprocess
import sys
import tempfile

from program import PROGRAM, Parser, end_in_one_line, refuse, require_input, require_program, say

CELLS, WAVES = 32, 240  # a run has so many steps that a wave travels WAVES cells
NOISE, DOUBLED = 1e4, 2
RING = {"kinematics": "finite", "material": "neo", "cells": CELLS}
LINE = "{:<10} {:<10} {:<9} {:<8} {:>7} {:>7} {:<7} {:>6} {:>6}  {}"


def cases():
    """The options of all runs."""
    for (name, move), basis, stretch, courant in itertools.product(
            (("usl", "grid"), ("usf", "grid"), ("musl", "grid"), ("musl", "projected")), ("quadratic", "cubic"),
            (0.6, 1, 2), (0.3, 0.9)):
        yield {"formulation": name, "move": move, "basis": basis, "transfer": "flip", "stretch": stretch,
               "courant": courant, "initial": "random", "amplitude": 1e-6}
    for name, transfer, stretch, courant in itertools.product(("usl", "musl"), ("flip", "apic"), (1, 1.5),
                                                              (0.3, 0.8, 1.3)):
        yield {"formulation": name, "move": "grid", "basis": "quadratic", "transfer": transfer, "stretch": stretch,
               "courant": courant, "initial": "mode", "amplitude": 0.15}


def march(options):
    """Returns what a run says, where the program has ended it (None: nowhere), and samples of step, norm and energy."""
    with tempfile.TemporaryDirectory() as folder:
        table = os.path.join(folder, "run.csv")
        words = [word for name, value in {**RING, **options, "csv": table}.items() for word in (f"-{name}", str(value))]
        done = subprocess.run([PROGRAM, "run", *words], capture_output=True, text=True, check=False)
        ended = re.search(r"step (\d+): particle", done.stderr)
        if done.returncode and not ended:
            refuse(f"run of {options}: {done.stderr.strip()}")
        if ended:
            return done.stdout, int(ended.group(1)), []
        with open(table, encoding="utf-8") as file:
            return done.stdout, None, [(int(row["step"]), float(row["norm"]), float(row["energy"])) for row in csv.DictReader(file)]


def failure(options, ended, samples):
    """Returns the step at which a run has failed, or None."""
    if samples and options["initial"] == "mode":
        _, _, ((_, _, rest), *_) = march({**options, "initial": "random", "amplitude": 1e-9, "steps": 1})
        samples = [(step, energy - rest, energy) for step, _, energy in samples]
        most = DOUBLED * samples[0][1]
    elif samples:
        most = NOISE * samples[0][1]
    return next((step for step, size, _ in samples if size > most), ended)


def judge(options, arguments):
    """Returns the steps of the failure and of the first warning, None where there is none, and a word for both."""
    said, ended, samples = march({**options, "steps": int(WAVES / options["courant"]), "tangent": "random",
                                  "window": arguments.window, "warn_above": arguments.above})
    failed, warned = failure(options, ended, samples), re.search(r"warning at step (\d+)", said)
    warned = int(warned.group(1)) if warned else None
    if failed is None:
        return failed, warned, "false alarm" if warned else "quiet"
    return failed, warned, "hit" if warned is not None and warned <= failed else "miss"


def main():
    parser = Parser(__doc__)
    parser.add_argument("--window", type=int, default=320, help="steps of a window")
    parser.add_argument("--above", type=float, default=5, help="warn above this times 1 + c t / h")
    parser.add_argument("--rows", help="take these runs alone, counted from 0, with commas between them")
    parser.add_argument("--check", metavar="FILE", help="fail unless this page has the rows that come out")
    arguments = parser.parse_args()
    require_program()
    page = None
    if arguments.check:
        require_input(arguments.check, "the page with the table that this script prints")
        with open(arguments.check, encoding="utf-8") as file:
            page = file.read().splitlines()
    counts = dict.fromkeys(("hit", "miss", "false alarm", "quiet"), 0)
    wrong = 0
    print(LINE.format("scheme", "moves", "basis", "transfer", "stretch", "courant", "initial", "failed", "warned", ""))
    taken = list(cases())
    if arguments.rows:
        try:
            taken = [taken[int(row)] for row in arguments.rows.split(",")]
        except (ValueError, IndexError):
            refuse(f"--rows {arguments.rows}: allowed: numbers below {len(taken)} with commas between them")
    for options in taken:
        failed, warned, word = judge(options, arguments)
        counts[word] += 1
        row = LINE.format(*(options[name] for name in ("formulation", "move", "basis", "transfer", "stretch", "courant",
                                                       "initial")),
                          *("-" if step is None else step for step in (failed, warned)), word)
        print(row, flush=True)
        if page is not None and row not in page:
            say(f"{arguments.check} has no such row: {row}")
            wrong += 1
    print(f"{sum(counts.values())} runs: " + ", ".join(f"{n} {word}" for word, n in counts.items()))
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    end_in_one_line(main)
