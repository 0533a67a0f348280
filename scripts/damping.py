#!/usr/bin/python3
"""Prints the tables of docs/damping.md: what each transfer costs a wave of 16 cells, and what smaller time steps do.

damping.py [--check FILE]

With --check it fails unless each row of a table in FILE is among the rows that it prints. The environment variable
MPMSTAB names the program (by default build/mpmstab).
"""
import math
import re
import subprocess
import sys
from fractions import Fraction

from program import PROGRAM, Parser, end_in_one_line, launch, refuse, require_input, require_program, say

CELLS, PERIODS = 16, 100
BASES = ("linear", "quadratic")
STEPS = (Fraction(1, 2), Fraction(1, 8))  # Courant numbers
SPEEDS = ((Fraction(0), "at rest"), (Fraction(1, 10), "moving at U0 = c/10"))


def ask(task, scene):
    status, found, said = launch(task, options={"formulation": "usl", "cells": CELLS, **scene})
    if status:
        refuse(f"{task} of {scene}: {said}")
    return found


def transfers():
    done = subprocess.run([PROGRAM, "list", "transfer"], capture_output=True, text=True, check=False)
    return re.findall(r"^  (\w+) ", done.stdout, flags=re.MULTILINE)


def wave(basis, transfer, courant, speed=0):
    """Returns decay per unit of time h / c, and the error of the frequency, of the longest wave."""
    scene = {"basis": basis, "transfer": transfer, "courant": float(courant), "drift": courant * speed,
             "damping": "true", "damping_divisors": 1}
    found = ask("symbol", scene)["symbol"]["damping"]
    return found["decay"][0][0], found["frequency_error"][0][0]


def ranked(basis, speed, known):
    """Returns the cells of a row for each transfer; the first keeps most nearly its amplitude at the smaller step."""
    rows = []
    for transfer in known:
        found = [wave(basis, transfer, courant, speed) for courant in STEPS]
        cells = [cell for decay, error in found
                 for cell in (f"{math.exp(-decay * CELLS * PERIODS):.3g}", f"{PERIODS * error:+.2f}")]
        rows.append((round(abs(found[-1][0]), 9), cells, transfer))  # what differs by rounding keeps its order
    return [(transfer, cells) for _, cells, transfer in sorted(rows, key=lambda row: row[0])]


def print_costs():
    known, line = transfers(), "{:<10} {:<10}" + " {:>10} {:>8}" * 2
    for speed, words in SPEEDS:
        print(f"\nusl, 2 particles a cell {words}: a wave of {CELLS} cells after {PERIODS} periods\n")
        print(line.format("", "", "k = 1/2", "", "k = 1/8", "").rstrip())
        print(line.format("basis", "transfer", *("kept", "phase") * 2))
        for basis in BASES:
            for transfer, cells in ranked(basis, speed, known):
                print(line.format(basis, transfer, *cells), flush=True)


def print_energies():
    """The energy that a standing wave keeps over one time, by runs and by the symbol."""
    line = "{:<10} {:<10} {:>6} {:>9} {:>10} {:>10}"
    print("\nusl at rest: energy of a standing wave of 16 cells after the time 128 h/c\n")
    print(line.format("basis", "transfer", "steps", "k", "run", "symbol"))
    for transfer in ("flip", "apic"):
        for steps in (256, 1024, 4096):
            courant = Fraction(128, steps)
            decay, _ = wave("quadratic", transfer, courant)
            energy = ask("run", {"basis": "quadratic", "transfer": transfer, "courant": float(courant),
                                 "steps": steps})["run"]["energy"]
            print(line.format("quadratic", transfer, steps, str(courant), f"{energy['final'] / energy['initial']:.3g}",
                              f"{math.exp(-2 * decay * 128):.3g}"), flush=True)


def main():
    parser = Parser(__doc__)
    parser.add_argument("--check", metavar="FILE", help="fail unless these rows have each row of the tables in FILE")
    arguments = parser.parse_args()
    require_program()
    if not arguments.check:
        print_costs()
        print_energies()
        return
    require_input(arguments.check, "the page with the tables that this script prints")
    with open(arguments.check, encoding="utf-8") as file:
        rows = re.findall(rf"^(?:{'|'.join(BASES)}) .*$", file.read(), flags=re.MULTILINE)
    done = subprocess.run([sys.executable, __file__], capture_output=True, text=True, check=True)
    found = done.stdout.splitlines()
    wrong = [row for row in rows if row not in found]
    for row in wrong:
        say(f"{arguments.check} has a row that does not come out: {row}")
    if len(rows) < 20:
        say(f"{arguments.check} has {len(rows)} rows only")
    sys.exit(1 if wrong or len(rows) < 20 else 0)


if __name__ == "__main__":
    end_in_one_line(main)
