"""Makes all of docs/work-precision.md that is computed, and checks some of its numbers again."""
import itertools
import math
import os
import re

import precision_dots
from precision_costs import COSTS, seconds_of
from picture_style import save
from precision_study import LOUD, SCENES, SCHEMES, TRANSFERS, USUAL, Runs, courants_of, growth_of, point_of, rows_of, standing
from program import ROOT, refuse, say, write_whole

PAGE = os.path.join(ROOT, "docs", "work-precision.md")
SCENES_SHOWN = ("line-rest", "line-slow", "line-fast", "jitter-fast", "plane-rest", "plane-fast", "finite-line")
CHECKED = ("line-rest", "line-fast")  # scenes of the table of errors, which needs no times
PERIODS, CELLS = 10.37, 64
HEAD = "scheme   transfer        k   at rest   Mach 1/10"
SHOWN = ("flip", "apic", "fmpm")
# Tables of more scenes, at the usual step alone: the head of a column, scene, cells and periods.
MORE = ((("hats, Mach 1/10", "hats-fast", 64, 10.37), ("cubic splines, Mach 1/10", "cubic-fast", 64, 10.37),
         ("disordered, at rest", "jitter-rest", 64, 10.37), ("disordered, Mach 1/100", "jitter-slow", 64, 10.37)),
        (("2-D, Mach 1/100", "plane-slow", 24, 1.37), ("2-D, disordered, Mach 1/10", "plane-jitter", 24, 1.37),
         ("2-D, strain up to 19 %", "finite-plane", 24, 1.37), ("2-D, Mach 1/10, 100.37 periods", "plane-fast", 24, 100.37)))
MORE_CHECKED = (("usl", "flip"), ("verlet", "apic"))  # rows that --check computes again; --check all: each
LOST = 10    # an error above is said to be infinite
SAME = 0.01  # three digits are printed


def errors_of(runs, scheme, transfer, courant):
    """Returns the errors that the table has of a scheme, as it prints them."""
    row = {"scheme": scheme, "transfer": transfer, "cells": CELLS, "errors": []}
    for scene in map(SCENES.get, CHECKED):
        step = {**SCHEMES[scheme], **TRANSFERS[transfer], **scene.options, "courant": courant}
        point_of(runs, scene, step, PERIODS, CELLS, scene.layouts[1:2], row)
    return [f"{error if error < LOST else math.inf:.3g}" for error in row["errors"]]


def error_lines(runs):
    """Yields the lines of the table of errors: each scheme and transfer at half its limit."""
    for scheme in SCHEMES:
        for transfer in SHOWN:
            for courant, share in courants_of(runs, SCENES[CHECKED[0]], scheme, transfer).items():
                if share == USUAL:
                    errors = errors_of(runs, scheme, transfer, f"{courant:g}")
                    yield f"{scheme:<9}{transfer:<10}{courant:>7g}{errors[0]:>10}{errors[1]:>12}"


def more_of(runs, scene, scheme, transfer, cells, periods):
    """Returns the row of a scheme at its usual step (implicit: k = 1) in all layouts, or None if it is refused."""
    courants = courants_of(runs, scene, scheme, transfer)
    courant = 1 if scheme == "implicit" else next((k for k, share in courants.items() if share == USUAL), None)
    if not courants or courant is None:
        return None
    step = {**SCHEMES[scheme], **TRANSFERS[transfer], **scene.options, "courant": f"{courant:g}"}
    row = {"scheme": scheme, "transfer": transfer, "cells": cells, "errors": [], "status": "ok"}
    row["steps"] = math.ceil(cells * periods * scene.period / courant)
    if math.log10(growth_of(runs, scene, step)) * row["steps"] > LOUD:
        row["status"] = "grows"
    else:
        point_of(runs, scene, step, periods, cells, scene.layouts, row)
    return row


def more_cell(row, unit):
    """Says the median error over the layouts, the least and the largest, and the time over that of usl with flip."""
    if row is None or row["status"] == "refused":
        return "-"
    if row["status"] == "grows":
        return "grows"
    low, *middle, high = sorted(100 * error for error in row["errors"])
    if high > 100 * LOST:
        return "(above 1000 %)"
    spread = "" if f"{low:.2g}" == f"{high:.2g}" else f" ({low:.2g} to {high:.2g})"
    return f"{middle[0] if middle else low:.2g}{spread}; {row['seconds'] / unit:.1f}"


def more_lines(runs, number, wanted=None):
    """Yields a table of MORE: all of it, or the rows of these schemes with transfers."""
    columns = MORE[number]
    units = []
    for _, name, cells, periods in columns:
        scene = SCENES[name]
        courant = next(k for k, share in courants_of(runs, scene, "usl", "flip").items() if share == USUAL)
        row = {"scheme": "usl", "transfer": "flip", "cells": cells, "iterations": 0}
        row["steps"] = math.ceil(cells * periods * scene.period / courant)
        units.append(seconds_of(row, scene.options))
    if wanted is None:
        yield f"| | {' | '.join(head for head, *_ in columns)} |"
        yield "|---" * (1 + len(columns)) + "|"
    for scheme, transfer in wanted or itertools.product(SCHEMES, TRANSFERS):
        cells = [more_cell(more_of(runs, SCENES[name], scheme, transfer, cells, periods), unit)
                 for (_, name, cells, periods), unit in zip(columns, units)]
        yield f"| {scheme}, {transfer} | {' | '.join(cells)} |"


def cost_lines():
    """Yields the table of costs: a step in steps of usl with flip, and of implicit that for n iterations."""
    yield f"| | {' | '.join(SCHEMES)} |"
    yield "|---" * (1 + len(SCHEMES)) + "|"
    for dim, transfer in itertools.product(COSTS, TRANSFERS):
        costs = [COSTS[dim][f"{scheme} {transfer}"] for scheme in SCHEMES]
        texts = [f"{cost['step']:.1f}" + (f" + {cost['iteration']:.1f} n" if "iteration" in cost else "") for cost in costs]
        yield f"| {dim}-D, {transfer} | {' | '.join(texts)} |"


def check_errors(runs, text):
    """Refuses a page whose table of errors is not what the program finds at the Courant numbers of the page."""
    found = re.search(re.escape(HEAD) + r"\n(.*?)\n```", text, re.DOTALL)
    if not found:
        refuse(f"{PAGE}: no table of errors; allowed: one that begins with '{HEAD}'")
    rows = [line.split() for line in found.group(1).splitlines()]
    if [tuple(row[:2]) for row in rows] != list(itertools.product(SCHEMES, SHOWN)):
        refuse(f"{PAGE}: the table of errors has other rows; allowed: each of {', '.join(SCHEMES)} with {', '.join(SHOWN)}")
    for scheme, transfer, courant, *printed in rows:
        errors = errors_of(runs, scheme, transfer, courant)
        pairs = [sorted(map(float, pair)) for pair in zip(errors, printed, strict=True)]
        if any(low < high and high - low > SAME * low for low, high in pairs):
            refuse(f"{PAGE}: {scheme} {transfer}: the page has {' '.join(printed)}, the program finds {' '.join(errors)}")


def check(folder, names):
    """Refuses a page on which the errors, or the rows of these scenes in the table of times, are not what comes out."""
    with open(PAGE, encoding="utf-8") as file:
        text = file.read()
    runs = Runs(folder)
    check_errors(runs, text)
    rows = [row for name in names for row in precision_dots.summary_rows(SCENES[name], tables_of(runs, SCENES[name]))]
    for number in range(len(MORE)):
        rows += more_lines(runs, number, None if names == list(SCENES_SHOWN) else MORE_CHECKED)
    for row in [*cost_lines(), *rows]:
        if row not in text.split("\n"):
            refuse(f"{PAGE}: no row '{row}'")


def tables_of(runs, scene):
    """Returns what standing() finds, for each end time."""
    rows = rows_of(runs, scene)
    return {periods: standing(rows, periods, wanted) for periods, wanted in scene.errors.items()}


def make(folder, names):
    """Runs the scenes, and writes for each a picture and a table, and for the page what it shows of them."""
    os.makedirs(folder, exist_ok=True)
    runs = Runs(folder)
    page = precision_dots.summary_head()
    for name in names:
        tables = tables_of(runs, SCENES[name])
        save(precision_dots.draw(SCENES[name], tables), os.path.join(folder, f"work-precision-{name}"))
        write_whole(os.path.join(folder, f"{name}.txt"), precision_dots.table(SCENES[name], tables))
        page += precision_dots.summary_rows(SCENES[name], tables)
        say(f"{name}: done")
    page += ["", *cost_lines(), "", "```", HEAD, *error_lines(runs), "```"]
    for number in range(len(MORE)):
        page += ["", *more_lines(runs, number)]
    write_whole(os.path.join(folder, "page.md"), "\n".join(page) + "\n")
