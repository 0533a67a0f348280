#!/usr/bin/python3
"""Bars that move into empty cells: what schemes do, over Courant number, particles per cell, drift and offset.

entering.py [--check FILE]

A bar of 8 cells drifts through a periodic grid of 14, with flip. For each scheme, basis and number of particles a cell a
row has the largest growth per step over a period, and the largest norm(A^n) of up to 200 steps in the energy's norm. Each
is the largest over the set below, with the Courant number k, drift and offset where it was found. --check computes the
two cases of each row of FILE anew, and fails if a number differs. MPMSTAB names the program (build/mpmstab).
"""
import itertools
import re
import sys

from program import Parser, end_in_one_line, launch, refuse, require_input, require_program, say

COURANTS, DRIFTS, OFFSETS = ("0.1", "0.3", "0.5"), ("1/16", "1/64", "1/100"), ("1/4", "1/2")
SCHEMES = list(itertools.product(("usl", "musl"), ("linear", "gimp", "quadratic", "cubic"), ("1", "2")))
ROW = re.compile(r"\| (\w+) \| (\w+) \| (\d) \| ([\d.]+) at (\S+), (\S+), (\S+) \| ([\d.e+]+) at (\S+), (\S+), (\S+) \|")


def measure(scheme, case):
    """Returns growth per step and the largest norm of powers of a step, as they are printed."""
    courant, drift, offset = case
    status, found, said = launch("spectrum", None, {
        "formulation": scheme[0], "basis": scheme[1], "transfer": "flip", "cells": 14, "fill": "0,8", "measure": "false",
        "powers": 200, "courant": courant, "ppc": scheme[2], "drift": drift, "offset": offset})
    if status:
        refuse(f"{scheme} at {case}: status {status}: {said}")
    return found["growth"], max(found["transient"]["norm"])


def print_table():
    print("| scheme | basis | ppc | growth per step at k, drift, offset | norm(A^n) at k, drift, offset |")
    print("|---|---|---|---|---|")
    for scheme in SCHEMES:
        found = [(*measure(scheme, case), ", ".join(case))
                 for case in itertools.product(COURANTS, DRIFTS, OFFSETS)]
        growth, norm = max(found, key=lambda f: round(f[0], 6)), max(found, key=lambda f: f[1])
        print(f"| {' | '.join(scheme)} | {growth[0]:.5f} at {growth[2]} | {norm[1]:.2e} at {norm[2]} |", flush=True)


def check_table(path):
    """Says whether each row of a file has the numbers of its two cases."""
    require_input(path, "a file with the table that this script prints")
    with open(path, encoding="utf-8") as file:
        rows = ROW.findall(file.read())
    if [row[:3] for row in rows] != SCHEMES:
        say(f"{path} has other rows than {SCHEMES}")
        return False
    good = True
    for row in rows:
        growth, norm = measure(row[:3], row[4:7])[0], measure(row[:3], row[8:])[1]
        if abs(growth - float(row[3])) > 1e-5 or abs(norm / float(row[7]) - 1) > 0.01:
            say(f"{path}: {' '.join(row[:3])} has growth {growth:.5f} and norm {norm:.2e} now")
            good = False
    return good


def main():
    parser = Parser(__doc__)
    parser.add_argument("--check", metavar="FILE", help="fail unless the numbers of FILE's table are those found now")
    arguments = parser.parse_args()
    require_program()
    if not arguments.check:
        print_table()
    elif not check_table(arguments.check):
        sys.exit(1)


if __name__ == "__main__":
    end_in_one_line(main)
