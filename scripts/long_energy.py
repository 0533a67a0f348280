#!/usr/bin/python3
"""Prints how much of its energy a vibrating body keeps over a long time, at finite strain, and draws it over time.

long_energy.py [-o NAME] [--check]

A periodic square of 8 x 8 cells of a neo-Hookean solid (quadratic splines, 2 particles a cell in each direction) moves
through the grid at a tenth of the speed of sound c, and shakes with a wave and with a shear, each of a velocity a c. A
row has the largest energy of the particles up to t = 300 h / c and that at the end, over the energy at the start;
that of the uniform motion is not counted. The wave and the shear are two runs, whose energies are added. With -o NAME
the script also draws NAME.png and NAME.svg for the largest a. --check runs a part of the table, and fails unless rk4
on particles keeps its energy and musl makes some. The environment variable MPMSTAB names the program (by default
build/mpmstab).
"""
import csv
import os
import sys
import tempfile

from program import Parser, end_in_one_line, launch, refuse, require_outputs, require_program, side_by_side

SCENE = {"kinematics": "finite", "material": "neo", "dim": 2, "poisson": 0.3, "cells": 8, "ppc": 2, "basis": "quadratic",
         "cell_width": 1, "mach": "0.1,0", "initial": "mode", "mode": "1,0"}
TIME, MACH = 300, 0.1
AMPLITUDES = (1e-3, 0.1, 0.3)
ON_NODES = {"formulation": "rk", "rk_on": "nodes"}
APIC = {"transfer": "apic", "gradient": "mls"}
# The name of a row, its Courant number, and its scheme.
ROWS = [("usl", 0.15, {"formulation": "usl"}),
        ("usl", 0.6, {"formulation": "usl"}),
        ("musl", 0.6, {"formulation": "musl"}),
        ("verlet", 0.6, {"formulation": "verlet"}),
        ("rk4 on nodes", 0.6, ON_NODES),
        ("rk4 on particles", 0.6, {"formulation": "rk"}),
        ("rk4 on particles, relaxed", 0.6, {"formulation": "rk", "rk_relax": "true"}),
        ("rk4 on particles", 1.2, {"formulation": "rk"}),
        ("kg5 on particles", 1.2, {"formulation": "rk", "rk": "kg5"}),
        ("usl, apic with mls", 0.15, {"formulation": "usl", **APIC}),
        ("usl, apic with mls", 0.6, {"formulation": "usl", **APIC}),
        ("rk4 on nodes, apic with mls", 0.6, {**ON_NODES, **APIC}),
        ("usl, fmpm of order 4", 0.6, {"formulation": "usl", "transfer": "fmpm", "xpic_order": 4}),
        ("usl, blend with 0.99 of flip", 0.6, {"formulation": "usl", "transfer": "blend", "blend_ratio": 0.99})]
QUICK = [row for row in ROWS if row[0] in ("musl", "rk4 on particles, relaxed") or row[:2] == ("rk4 on particles", 0.6)]


def energies(courant, scheme, amplitude, polarisation):
    """Returns times and energies of a run, without the energy of the uniform motion; fewer where a particle failed."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "series.csv")
        scene = {**SCENE, **scheme, "courant": courant, "steps": round(TIME / courant), "amplitude": amplitude,
                 "polarisation": polarisation, "csv": path}
        status, _, said = launch("run", options=scene)
        if status and " particle " not in said:
            refuse(f"{scene}: {said}")
        with open(path, encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    mean = (SCENE["cells"] * MACH) ** 2 / 2
    return [float(row["time"]) for row in rows], [float(row["energy"]) - mean for row in rows]


def series(case):
    """Returns times, and energies over the first, of wave and shear together. An energy that is lost counts as infinite."""
    (_, courant, scheme), amplitude = case
    both = [energies(courant, scheme, amplitude, polarisation) for polarisation in "ps"]
    steps = max(len(times) for times, _ in both)
    first = sum(values[0] for _, values in both)
    total = [sum(values[i] if i < len(values) else float("inf") for _, values in both) / first for i in range(steps)]
    return max((times for times, _ in both), key=len), total


def text_of(values):
    if values[-1] == float("inf"):
        return "a particle fails"
    return f"{max(values):.4f}; {values[-1]:.3f}"


def draw(rows, found, name):
    """Draws energy over time at the largest amplitude."""
    from picture_style import COLOURS, new_figure, save
    figure = new_figure(4, f"neo-Hookean, wave and shear of {AMPLITUDES[-1]} c at Mach {MACH}", width=7.5)
    axes = figure.add_subplot()
    for number, row in enumerate(rows):
        times, values = found[row[:2], AMPLITUDES[-1]]
        axes.plot(times, values, color=COLOURS[number % 6], linestyle=("-", "--", ":")[number // 6 % 3],
                  label=f"{row[0]}, k = {row[1]}", linewidth=1.2)
    axes.set(xlabel="time in h / c", ylabel="energy over its start", ylim=(0, 1.25), xlim=(0, TIME))
    axes.grid(True, alpha=0.3)
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1), borderaxespad=0)
    save(figure, name)


def check(found):
    faults = [f"{name}, k = {courant}, a = {amplitude}: {text_of(values)}"
              for ((name, courant), amplitude), (_, values) in found.items()
              if not (max(values) > 1.05 if name == "musl" else max(values) < 1.001 and values[-1] > 0.9)
              or ("relaxed" in name and max(values) > 1 + 1e-12)]
    if faults:
        print("\n".join(faults), file=sys.stderr)
        sys.exit(1)


def main():
    parser = Parser(__doc__)
    parser.add_argument("-o", "--output", metavar="NAME")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    require_program()
    if arguments.output:
        require_outputs([arguments.output + end for end in (".png", ".svg")])
    rows, amplitudes = (QUICK, AMPLITUDES[-1:]) if arguments.check else (ROWS, AMPLITUDES)
    cases = [(row, amplitude) for row in rows for amplitude in amplitudes]
    with side_by_side(1 if arguments.check else os.cpu_count()) as workers:
        found = {(row[:2], amplitude): one for (row, amplitude), one in zip(cases, workers.map(series, cases))}
    if arguments.check:
        check(found)
        return
    print("| scheme | k |" + "".join(f" a = {amplitude} |" for amplitude in amplitudes))
    print("|---|---|" + "---|" * len(amplitudes))
    for row in rows:
        print(f"| {row[0]} | {row[1]} | " + " | ".join(text_of(found[row[:2], a][1]) for a in amplitudes) + " |")
    if arguments.output:
        draw(rows, found, arguments.output)


if __name__ == "__main__":
    end_in_one_line(main)
