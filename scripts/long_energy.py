#!/usr/bin/python3
"""Prints how much of its energy a vibrating body keeps over a long time, and draws it over time.

long_energy.py [-o NAME] [--check FILE [--all]]

A periodic block of 8 cells a direction, of a neo-Hookean solid (2-D, quadratic splines, 2 particles a cell in each
direction, Poisson's ratio 0.3), moves through the grid at a tenth of the speed of sound c. It shakes with a wave along x and
with a shear, each of a velocity 0.3 c. Each entry has the largest energy of the particles up to t = 300 h / c and that at the
end, over the energy at the start; that of the uniform motion is not counted. The wave and the shear are two runs, whose
energies are added. The first table has scenes with flip, the second transfers, the third ways to run rk4. usl at k = 0.15
costs about what rk4 costs at 0.6 and kg5 at 0.75. The tables are those of docs/work-precision.md (two minutes).

With -o NAME the script draws NAME.png and NAME.svg. --check FILE computes three rows, or with --all each, and refuses a file
that has other numbers. The environment variable MPMSTAB names the program (by default build/mpmstab).
"""
import csv
import os
import re
import tempfile

from program import end_in_one_line, launch, print_or_check, refuse, side_by_side

from precision_study import SCHEMES, TRANSFERS

END, CELLS, MACH = 300, 8, 0.1
BLOCK = {"kinematics": "finite", "material": "neo", "dim": 2, "poisson": 0.3, "basis": "quadratic", "mode": "1,0", "amplitude": 0.3}
STEPS = {f"{scheme} {courant}": {**SCHEMES[scheme], "courant": courant}
         for scheme, courant in (("usl", 0.15), ("usl", 0.6), ("musl", 0.6), ("usavg", 0.6), ("verlet", 0.6), ("rk4", 0.6),
                                 ("rk4", 1.2), ("kg5", 0.75))}
SCENES = {  # what differs from the block
    "small strain": {"kinematics": "linear"},
    "a = 0.001": {"amplitude": 0.001},
    "a = 0.1": {"amplitude": 0.1},
    "a = 0.3": {},
    "wave alone": {"polarisation": "p"},
    "shear alone": {"polarisation": "s"},
    "oblique": {"mode": "1,1"},
    "disordered": {"jitter": 0.4},
    "hats": {"basis": "linear"},
    "cubic": {"basis": "cubic"},
    "3-D": {"dim": 3, "mode": "1,1,1"},
}
MLS = {"transfer": "apic", "gradient": "mls"}
WAYS = {
    "on particles, flip": {},
    "on particles, flip, `-rk_relax`": {"rk_relax": "true"},
    "on particles, flip, `-rk_places stages`": {"rk_places": "stages"},
    "on nodes, flip": {"rk_on": "nodes"},
    "on nodes, apic with gradient mls": {"rk_on": "nodes", **MLS},
}
AMPLITUDES = {"a = 0.001": 0.001, "a = 0.1": 0.1, "a = 0.3": 0.3}
TABLES = [  # the head, the rows and the columns, each with the options that they add
    ("flip", SCENES, STEPS),
    ("transfer", TRANSFERS, STEPS),
    ("rk4 0.6", {name: {**STEPS["rk4 0.6"], **way} for name, way in WAYS.items()},
     {name: {"amplitude": value} for name, value in AMPLITUDES.items()}),
]
QUICK = ("a = 0.3", "blend", "on particles, flip, `-rk_relax`")
NUMBER = re.compile(r"\d+\.\d{3}")
SAME = 0.003  # the last digits depend on rounding where noise grows


def energies(options):
    """Returns times, and energies of the particles without that of the uniform motion; fewer where a particle failed."""
    dim = options["dim"]
    linear = options["kinematics"] == "linear"
    scene = {name: value for name, value in options.items() if not (name == "stagger" or (linear and name == "material"))}
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "series.csv")
        status, _, said = launch("run", options={
            **scene, "cells": ",".join([str(CELLS)] * dim), "cell_width": 1, "ppc": 2, "time": END,
            "mach": ",".join([str(MACH)] + ["0"] * (dim - 1)), "csv": path})
        if status and " particle " not in said:
            refuse(f"{scene}: {said}")
        with open(path, encoding="utf-8") as file:
            rows = [(float(row["time"]), float(row["energy"] or "inf")) for row in csv.DictReader(file)]
    moving = 0 if linear else CELLS**dim * MACH**2 / 2
    return [time for time, _ in rows], [energy - moving for _, energy in rows]


def series(options):
    """Returns times, and energies over the first, of wave and shear together. An energy that is lost counts as infinite."""
    both = [energies({**options, "polarisation": one}) for one in options.get("polarisation", "ps")]
    times = max((times for times, _ in both), key=len)
    first = sum(values[0] for _, values in both)
    return times, [sum(values[i] if i < len(values) else float("inf") for _, values in both) / first for i in range(len(times))]


def entry(values):
    if not max(values) < 100:
        return "grows"
    return f"{max(values):.3f}; {values[-1]:.3f}"


def row_of(name, options):
    """Returns the line of a row, of which options has the column's."""
    with side_by_side(os.cpu_count()) as workers:
        found = [values for _, values in workers.map(series, options)]
    if "rk_relax" in name and max(map(max, found)) > 1 + 1e-12:
        refuse(f"{name}: the energy rises to {max(map(max, found)):.15g} of its start")
    return f"| {name} | {' | '.join(map(entry, found))} |"


def lines_of(chosen=None):
    """Yields the lines of the tables, or the rows that are chosen."""
    for head, rows, columns in TABLES:
        yield from [] if chosen else [f"| {head} | {' | '.join(columns)} |", "|---" * (1 + len(columns)) + "|"]
        for name, row in rows.items():
            if not chosen or name in chosen:
                yield row_of(name, [{**BLOCK, **column, **row} for column in columns.values()])
        yield from [] if chosen else [""]


def alike(line, other):
    """Says whether two lines have the same words, and numbers that differ by at most SAME."""
    words, numbers = zip(*((NUMBER.sub("", text), map(float, NUMBER.findall(text))) for text in (line, other)))
    return words[0] == words[1] and all(abs(one - two) <= SAME * max(1, two) for one, two in zip(*numbers))


def check(path, printed, whole):
    """Refuses a page that lacks a line."""
    for line in lines_of(None if whole else QUICK):
        if not any(alike(line, other) for other in printed):
            refuse(f"{path}: no line '{line}'")


def draw(_):
    """Draws energy over time: the schemes in one scene."""
    import picture_style as style
    figure = style.new_figure(4.6, "2-D neo-Hookean block, P wave and shear of 0.3 c at Mach 1/10,\n8 x 8 cells, 2 x 2 particles "
                              "a cell, quadratic splines, flip", width=5.2)
    axes = figure.add_subplot()
    colours, kinds = (*style.COLOURS, "#000000", style.GREY), ("-", "--", "-.", ":")
    for number, (step, options) in enumerate(STEPS.items()):
        times, values = series({**BLOCK, **options})
        axes.plot(times, values, color=colours[number], linestyle=kinds[number % 4], linewidth=1.8,
                  label=f"{step.replace(' ', ', k = ')}: {100 * values[-1]:.0f} % left")
    axes.axhline(1, color="0.7", linewidth=0.8, zorder=0)
    axes.set(xlim=(0, END), ylim=(0, 2), xlabel="time, in h / c (the wave has a period of 8)", ylabel="energy of the vibration over its start")
    axes.set_title("what a vibrating block keeps of its energy")
    axes.grid(True, alpha=0.3)
    style.legend_below(axes, fontsize=9, columnspacing=0.8)
    return figure


def main():
    print_or_check(__doc__, lambda: None, lambda _: lines_of(), check, draw)


if __name__ == "__main__":
    end_in_one_line(main)
