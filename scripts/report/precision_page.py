"""Makes all of docs/work-precision.md that is computed, and checks some of its numbers again."""
import itertools
import math
import os
import re

import precision_dots
from precision_costs import COSTS
from picture_style import save
from precision_study import SCENES, SCHEMES, TRANSFERS, Runs, courants_of, point_of, rows_of, standing, USUAL
from program import ROOT, refuse, say, write_whole

PAGE = os.path.join(ROOT, "docs", "work-precision.md")
SCENES_SHOWN = ("line-rest", "line-slow", "line-fast", "jitter-fast", "plane-rest", "plane-fast", "finite-line")
CHECKED = ("line-rest", "line-fast")  # scenes of the table of errors, which needs no times
PERIODS, CELLS = 10.37, 64
HEAD = "scheme   transfer        k   at rest   Mach 1/10"
SHOWN = ("flip", "apic", "fmpm")
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
    write_whole(os.path.join(folder, "page.md"), "\n".join(page) + "\n")
