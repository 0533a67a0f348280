#!/usr/bin/python3
"""Prints how fast the schemes that codes run grow when particles move, over their velocity U0 and the Courant number k.

moving.py [-o NAME] [--check FILE [--all]]

The tables are those of docs/ringing-tables.md (eight minutes). Each number is the largest growth over all waves: the phases are
refined until it stops moving ('mpmstab symbol -refine'). With -o NAME the script also draws NAME.png and NAME.svg.
--check FILE computes some forty of the numbers, or with --all all, and refuses a file whose tables have others.
The environment variable MPMSTAB names the program (by default build/mpmstab).
"""
import math
import os

from program import end_in_one_line, launch, print_or_check, refuse, side_by_side

BASES = ("linear", "gimp", "quadratic", "cubic")
SCHEMES = [*((formulation, transfer, basis) for formulation in ("usl", "musl", "usf")
             for transfer in ("flip", "pic", "blend", "xpic", "apic") for basis in BASES),
           *(("usl", "apic mls", basis) for basis in BASES)]
SMALLER = [*((formulation, "flip", basis) for basis in BASES[:3] for formulation in ("usl", "musl", "usf")),
           *(("usl", transfer, basis) for transfer in ("pic", "apic mls") for basis in BASES[:3])]  # those whose smaller steps are shown
MACH = [(1, 1000), (1, 100), (1, 10), (1, 4), (1, 1)]
COURANT = [(1, 2), (1, 4), (1, 8)]
CHECKED = [*((scheme, (1, 4), (1, 2)) for scheme in SCHEMES[::3]),
           *((scheme, (1, 10), (1, 2)) for scheme in SMALLER),
           *((("musl", "flip", "linear"), mach, (1, 2)) for mach in MACH),
           *((("usl", "flip", "gimp"), (1, 10), courant) for courant in COURANT[1:])]
ALL = [(scheme, mach, courant) for courant in COURANT for mach in MACH for scheme in (SCHEMES if courant == COURANT[0] else SMALLER)]
NONE, ROUNDING = 1e-8, 1e-7  # growth - 1 counts as none below this; the second where rounding hides the first


def text_of(fraction):
    return f"{fraction[0]}/{fraction[1]}" if fraction[1] > 1 else str(fraction[0])


def symbol_of(case, tolerance):
    """Returns what 'symbol -refine' finds."""
    (formulation, transfer, basis), mach, courant = case
    options = {"formulation": formulation, "transfer": transfer.split()[0], "basis": basis,
               "gradient": "mls" if transfer.endswith("mls") else "basis",
               "mach": text_of(mach), "courant": text_of(courant), "tolerance": tolerance}
    words = ["-refine", *(word for name, value in options.items() for word in (f"-{name}", str(value)))]
    status, found, error = launch("symbol", options=words)
    if status:
        refuse(f"{' '.join(words)}: {error}")
    return found


def growth_of(case):
    """Returns growth - 1 per step; 0 where there is none, and NaN where it is not decided or still moves."""
    found = symbol_of(case, NONE)
    if found["verdict"] == "undecided":
        found = symbol_of(case, ROUNDING)
    if found["verdict"] == "undecided" or not found["refined"]["settled"]:
        return math.nan
    return found["growth"] - 1 if found["verdict"] == "unstable" else 0.0


def per_time(growth, courant):
    """Turns growth - 1 per step into growth - 1 per time h / c, which is 1 / k steps."""
    return math.expm1(math.log1p(growth) * courant[1] / courant[0])


def cell(value):
    return f"{'?' if math.isnan(value) else '0' if value == 0 else f'{value:.1e}':>9}"


def table_of(growth, schemes, courant, per, turn):
    """Returns the lines of a table, which has a column for each velocity."""
    lines = [f"growth - 1 per {per}, k = {text_of(courant)}",
             "scheme transfer basis     " + "".join(f"{'c/' + str(m[1]) if m[1] > 1 else 'c':>9}" for m in MACH)]
    for scheme in schemes:
        values = [growth.get((scheme, mach, courant), math.nan) for mach in MACH]
        lines.append(f"{scheme[0]:<6} {scheme[1]:<8} {scheme[2]:<9} " + "".join(cell(turn(value)) for value in values))
    return [*lines, ""]


def tables_of(growth):
    """Returns the lines of all tables: of all schemes per step, and of smaller steps per time."""
    lines = table_of(growth, SCHEMES, COURANT[0], "step", lambda value: value)
    for courant in COURANT:
        lines += table_of(growth, SMALLER, courant, "time h/c", lambda value, k=courant: per_time(value, k))
    return [*lines[:-1], "0: below 1e-7, and below 1e-8 where rounding lets that be told; ?: not decided"]


def compute(cases):
    """Runs the program for each case."""
    with side_by_side(os.cpu_count()) as workers:
        return dict(zip(cases, workers.map(growth_of, cases)))


def check(path, printed, whole):
    """Refuses a page that lacks one of the numbers in their places."""
    growth = compute(ALL if whole else CHECKED)
    expected = tables_of(growth)
    heads = [i for i, line in enumerate(printed) if line == expected[0]]
    if len(heads) != 1:
        refuse(f"{path}: {len(heads)} lines '{expected[0]}'; allowed: the tables that this script prints")
    for i, line in enumerate(expected):
        wrong = printed[heads[0] + i]
        for at in range(0, len(MACH) * 9, 9):
            wanted = line[26 + at:35 + at] if len(line) > 26 else ""
            if "?" not in wanted and wanted != (wrong[26 + at:35 + at] if wanted else ""):
                refuse(f"{path}: '{wrong}' where the program finds '{line}' (? is not compared)")


def draw(growth):
    from picture_moving import draw_moving
    return draw_moving(growth, SMALLER, MACH, COURANT)


def main():
    print_or_check(__doc__, lambda: compute(ALL), tables_of, check, draw)


if __name__ == "__main__":
    end_in_one_line(main)
