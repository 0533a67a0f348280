"""Makes all of docs/work-precision.md that is computed, and checks some of its numbers again."""
import itertools
import os
import re

import precision_dots
from picture_style import save
from precision_study import SCENES, SCHEMES, TRANSFERS, Runs, courants_of, point_of, rows_of, standing, USUAL
from program import ROOT, refuse, say, write_whole

PAGE = os.path.join(ROOT, "docs", "work-precision.md")
CHECKED = ("line-rest", "line-fast")  # scenes of the table of errors, which needs no times
PERIODS, CELLS = 10.37, 64
HEAD = "scheme  transfer        k   at rest   Mach 1/10"
SHOWN = ("flip", "apic", "fmpm")
SAME = 0.01  # three digits are printed


def errors_of(runs, scheme, transfer, courant):
    """Returns the errors that the table has of a scheme, as it prints them."""
    row = {"errors": []}
    for scene in map(SCENES.get, CHECKED):
        step = {**SCHEMES[scheme], **TRANSFERS[transfer], **scene.options, "courant": courant}
        point_of(runs, scene, step, PERIODS, CELLS, scene.layouts[1:2], row)
    return [f"{error:.3g}" for error in row["errors"]]


def error_lines(runs):
    """Yields the lines of the table of errors: each scheme and transfer at half its limit."""
    for scheme in SCHEMES:
        for transfer in SHOWN:
            for courant, share in courants_of(runs, SCENES[CHECKED[0]], scheme, transfer).items():
                if share == USUAL:
                    errors = errors_of(runs, scheme, transfer, f"{courant:g}")
                    yield f"{scheme:<8}{transfer:<10}{courant:>7g}{errors[0]:>10}{errors[1]:>12}"


def check(folder):
    """Refuses a page whose table of errors is not what the program finds at the Courant numbers of the page."""
    with open(PAGE, encoding="utf-8") as file:
        text = file.read()
    found = re.search(re.escape(HEAD) + r"\n(.*?)\n```", text, re.DOTALL)
    if not found:
        refuse(f"{PAGE}: no table of errors; allowed: one that begins with '{HEAD}'")
    rows = [line.split() for line in found.group(1).splitlines()]
    if [tuple(row[:2]) for row in rows] != list(itertools.product(SCHEMES, SHOWN)):
        refuse(f"{PAGE}: the table of errors has other rows; allowed: each of {', '.join(SCHEMES)} with {', '.join(SHOWN)}")
    runs = Runs(folder)
    for scheme, transfer, courant, *printed in rows:
        errors = errors_of(runs, scheme, transfer, courant)
        if any(abs(float(one) - float(other)) > SAME * float(other) for one, other in zip(errors, printed, strict=True)):
            refuse(f"{PAGE}: {scheme} {transfer}: the page has {' '.join(printed)}, the program finds {' '.join(errors)}")


def make(folder, names):
    """Runs the scenes, and writes for each a picture and a table, and for the page what it shows of them."""
    os.makedirs(folder, exist_ok=True)
    runs = Runs(folder)
    page = precision_dots.summary_head()
    for name in names:
        scene = SCENES[name]
        rows = rows_of(runs, scene)
        tables = {periods: standing(rows, periods, wanted) for periods, wanted in scene.errors.items()}
        save(precision_dots.draw(scene, tables), os.path.join(folder, name))
        write_whole(os.path.join(folder, f"{name}.txt"), precision_dots.table(scene, tables))
        page += precision_dots.summary_rows(scene, tables)
        say(f"{name}: done")
    page += ["", "```", HEAD, *error_lines(runs), "```"]
    write_whole(os.path.join(folder, "page.md"), "\n".join(page) + "\n")
