#!/usr/bin/python3
"""Prints and draws the largest Courant number without growth over the Mach number of the particles, for five steps.

quiet_mach.py [-o NAME] [--check FILE [--all]]

A number is the least over lattices of 1 to 4 particles a cell. In each of these it is the largest k up to which nothing grows
by more than 1e-6 a step, of the k that 'critical -mach' looks at. A moving lattice meets all offsets within a cell, so that its
own one hardly matters. 'per cost' is k over what a step costs where particles move, beside usl (docs/dev/speed.md). The
tables are those of docs/ringing.md (ten minutes). With -o NAME the script also draws NAME.png and NAME.svg. --check FILE
computes the column of Mach 1/10, or with --all all of them, and refuses a file that has other numbers. The environment variable MPMSTAB names
the program.
"""
import os

from program import cells_of, end_in_one_line, launch, print_or_check, refuse, side_by_side

STEPS = {"usl": "-formulation usl", "musl": "-formulation musl", "verlet": "-formulation verlet",
         "rk4": "-formulation rk -rk rk4", "kg5": "-formulation rk -rk kg5"}
COST = {"usl": 1, "musl": 1.49, "verlet": 1.29, "rk4": 2.8, "kg5": 3.59}  # flip, quadratic, moving: docs/dev/speed.md
KINDS = {"flip": ("flip, quadratic splines", "-basis quadratic"),
         "MLS-MPM": ("MLS-MPM (apic, gradient mls, quadratic splines)", "-basis quadratic -transfer apic -gradient mls")}
MACH = [(1, 100), (1, 30), (1, 10), (1, 3), (1, 1)]
PPC = (1, 2, 3, 4)
CHECKED = (1, 10)


def text_of(mach):
    return f"{mach[0]}/{mach[1]}" if mach[1] > 1 else str(mach[0])


def limit_of(case):
    """Returns the largest k up to which nothing grows; 0 where the least k that was looked at grows."""
    kind, step, mach, ppc = case
    words = [*STEPS[step].split(), *KINDS[kind][1].split(), "-mach", text_of(mach), "-ppc", str(ppc)]
    status, found, error = launch("critical", options=words)
    if status:
        refuse(f"critical {' '.join(words)}: {error}")
    return found["critical"].get("critical_courant", 0)


def compute(machs):
    """Returns the least limit over the lattices, and in which it is, by kind, step and Mach number."""
    cases = [(kind, step, mach, ppc) for mach in machs for kind in KINDS for step in STEPS for ppc in PPC]
    with side_by_side(os.cpu_count()) as workers:
        limits = dict(zip(cases, workers.map(limit_of, cases)))
    return {case[:3]: min((limits[(*case[:3], ppc)], ppc) for ppc in PPC) for case in limits}


def cell(limit):
    return "none" if limit == 0 else f"{limit:.3g}"


def rows(least, machs):
    """Yields the cells of each row of the table of a kind."""
    for kind, (title, _) in KINDS.items():
        for step in STEPS:
            yield [f"{kind}, {step}", *(cell(least[kind, step, mach][0]) for mach in machs)]


def lines_of(least):
    return [f"| Mach number | {' | '.join(map(text_of, MACH))} |", "|---|" + "---|" * len(MACH),
            *(f"| {' | '.join(cells)} |" for cells in rows(least, MACH))]


def check(path, lines, whole):
    """Refuses a page in which a column has other numbers: that of one Mach number, or each."""
    machs = MACH if whole else [CHECKED]
    printed = {cells[0]: cells[1:] for cells in map(cells_of, lines) if len(cells) == len(MACH) + 1}
    for name, *cells in rows(compute(machs), machs):
        shown = [printed.get(name, [""] * len(MACH))[MACH.index(mach)] for mach in machs]
        if shown != cells:
            refuse(f"{path}: the row {name} has {shown} at Mach {', '.join(map(text_of, machs))}, not {cells}")


def draw(least):
    from picture_quiet import draw_quiet
    return draw_quiet(least, KINDS, COST, MACH)


def main():
    print_or_check(__doc__, lambda: compute(MACH), lines_of, check, draw)


if __name__ == "__main__":
    end_in_one_line(main)
