#!/usr/bin/python3
"""Prints what cures ringing, from the schemes that grow least on, and what each cure costs.

cures.py [--check FILE [--all]]

The table is that of docs/ringing-tables.md. It begins with musl with flip on hats, two particles a cell, at Courant number 1/2; each
row changes what its options say. Its first columns have the largest growth - 1 per time h / c at four velocities of the
particles, over all waves ('symbol -refine -mach'). The price is in the last two: the share of the amplitude that a wave
of 16 cells keeps after 10 periods at rest ('symbol -damping'), and the largest stable Courant number at rest
('critical'). --check FILE refuses a file whose rows have other numbers; it computes the two larger velocities,
or with --all each, and the price. The environment variable MPMSTAB names the program.
"""
import math
import os

import moving
from program import cells_of, end_in_one_line, launch, print_or_check, refuse, side_by_side

CELLS, PERIODS = 16, 10
SPEEDS = [mach for mach in moving.MACH if mach != (1, 1)]
FASTER = SPEEDS[2:]
FIRST = {"formulation": "musl", "transfer": "flip", "basis": "linear", "gradient": "basis", "courant": "1/2"}
CURES = ["", "-courant 1/8", "-formulation usl", "-basis gimp", "-basis quadratic", "-basis cubic", "-transfer blend",
         "-transfer blend -basis quadratic", "-transfer xpic", "-transfer xpic -basis quadratic", "-transfer pic",
         "-formulation usl -basis quadratic", "-formulation usl -basis cubic",
         "-formulation usl -transfer blend -basis quadratic", "-formulation usl -transfer xpic -basis quadratic",
         "-formulation usl -transfer apic -basis quadratic",
         "-formulation usl -transfer apic -gradient mls -basis quadratic", "-formulation usl -transfer pic -basis quadratic"]


def scheme_of(cure):
    words = cure.split()
    return {**FIRST, **{name[1:]: value for name, value in zip(words[::2], words[1::2])}}


def found(task, options):
    status, result, error = launch(task, options=options)
    if status:
        refuse(f"{task} of {options}: {error}")
    return result


def growth_of(case):
    """Returns growth - 1 per time h / c."""
    cure, mach = case
    scheme = scheme_of(cure)
    courant = tuple(int(part) for part in scheme["courant"].split("/"))
    transfer = scheme["transfer"] + (" mls" if scheme["gradient"] == "mls" else "")
    return moving.per_time(moving.growth_of(((scheme["formulation"], transfer, scheme["basis"]), mach, courant)), courant)


def price_of(cure):
    """Returns the share of the amplitude that is kept, and the limit at rest."""
    scheme = scheme_of(cure)
    damping = found("symbol", ["-damping", "-damping_divisors", "1", "-cells", str(CELLS),
                               *(word for name, value in scheme.items() for word in (f"-{name}", value))])
    limit = found("critical", scheme)["critical"]["critical_courant"]
    return math.exp(-damping["symbol"]["damping"]["decay"][0][0] * CELLS * PERIODS), limit


def rows(speeds):
    """Returns the cells of each row: its options, growth at these speeds, what is kept, and the limit."""
    cases = [(cure, mach) for cure in CURES for mach in speeds]
    with side_by_side(os.cpu_count()) as workers:
        growth = dict(zip(cases, workers.map(growth_of, cases)))
        prices = dict(zip(CURES, workers.map(price_of, CURES)))

    def rank(cure):
        return cure != CURES[0], -max(growth[cure, mach] for mach in speeds), -prices[cure][0]

    return [[f"`{cure}`" if cure else "none", *(moving.cell(growth[cure, mach]).strip() for mach in speeds),
             f"{prices[cure][0]:.3g}", f"{prices[cure][1]:.4g}"] for cure in sorted(CURES, key=rank)]


def lines_of(found):
    return ["| options | " + " | ".join(f"c/{mach[1]}" for mach in SPEEDS) + " | kept | limit |", "|---|" + "---|" * (len(SPEEDS) + 2),
            *(f"| {' | '.join(cells)} |" for cells in found)]


def check(path, lines, whole):
    """Refuses a page in which a row has other numbers, or which has another number of rows."""
    speeds = SPEEDS if whole else FASTER
    found = [cells_of(line) for line in lines if line.startswith(("| `-", "| none"))]
    printed = {cells[0]: cells[1 + SPEEDS.index(speeds[0]):] for cells in found}
    for name, *cells in rows(speeds):
        if printed.get(name) != cells:
            refuse(f"{path}: the row {name} ends with {printed.get(name)}, not with {cells}")
    if len(found) != len(CURES):
        refuse(f"{path}: {len(found)} rows, not {len(CURES)}")


def main():
    print_or_check(__doc__, lambda: rows(SPEEDS), lines_of, check)


if __name__ == "__main__":
    end_in_one_line(main)
