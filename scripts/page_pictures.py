#!/usr/bin/python3
"""Draws examples/limits.png and examples/damping.png from the tables of docs/limits.md and docs/damping.md.

page_pictures.py [-o FOLDER]

Other scripts test the numbers of these tables (claims, damping.py --check), so that the pictures need no program. A second.
"""
import os
import re

from program import ROOT, Parser, end_in_one_line, refuse

import picture_style as style
from whole_files import write_whole

LATTICE, LONE, EDGE, RANGE = "#0072B2", "#E69F00", "#009E73", "#CC79A7"
BEYOND = 2.95  # where 'none' is drawn: beyond all limits of the page


def page(name):
    with open(os.path.join(ROOT, "docs", name), encoding="utf-8") as file:
        return re.sub(r"<!--.*?-->", "", file.read())


def limits():
    """Returns scheme, and limits of the lattice, its edge, a lone particle, 5, 50 and 95 % of random layouts, and the worst."""
    rows = re.findall(r"^\| ((?:usl|musl), .*?) \| (.*) \|$", page("limits.md"), flags=re.MULTILINE)
    found = [(name, [float(cell) if cell != "none" else BEYOND for cell in cells.split(" | ")]) for name, cells in rows]
    if len(found) < 6 or any(len(cells) != 7 for _, cells in found):
        refuse("docs/limits.md has no table of layouts that are no lattice")
    return found


def draw_limits():
    found = limits()
    figure = style.new_figure(4.4, "flip, one dimension, 2 particles a cell, at rest; random: 20 layouts of 24 cells")
    axes = figure.subplots()
    for place, (_, (lattice, edge, lone, few, half, most, worst)) in enumerate(reversed(found)):
        least = min(edge, lone, worst)
        axes.plot([least, lattice], [place, place], color="#bbbbbb", linewidth=3, zorder=1, solid_capstyle="butt")
        axes.plot([few, most], [place, place], color=RANGE, linewidth=11, alpha=0.55, zorder=2, solid_capstyle="butt")
        axes.plot(half, place, "|", color="black", markersize=11, zorder=3)
        for value, marker, colour in ((lattice, "s", LATTICE), (edge, "^", EDGE), (worst, "x", "black"), (lone, "o", LONE)):
            axes.plot(value, place, ">" if value == BEYOND else marker, color=colour, markersize=8, zorder=4,
                      markeredgewidth=2 if marker in "xo" else 0.5, fillstyle="none" if marker == "o" else "full")
    axes.set(yticks=range(len(found)), yticklabels=[name for name, _ in reversed(found)], xlim=(-0.06, 3.1),
             xlabel="largest stable Courant number c dt / h", title="The same scheme has another limit in each layout")
    axes.text(BEYOND, len(found) - 0.45, "no limit", ha="center", fontsize=9)
    axes.set_ylim(-0.6, len(found) - 0.1)
    axes.grid(axis="x", color="#dddddd")
    lines = [axes.plot([], [], **look)[0] for look in (
        {"color": LATTICE, "marker": "s", "linestyle": ""}, {"color": EDGE, "marker": "^", "linestyle": ""},
        {"color": LONE, "marker": "o", "linestyle": "", "fillstyle": "none"}, {"color": RANGE, "linewidth": 9, "alpha": 0.55},
        {"color": "black", "marker": "x", "linestyle": ""})]
    style.legend_below(axes, columns=3, handles=lines, labels=["lattice", "its edge", "lone particle", "random: 5 to 95 %", "worst found"])
    return figure


def kept():
    """Returns for hats and quadratic splines what transfers keep at rest at k = 1/2 and 1/8."""
    table = page("damping.md").split("usl, 2 particles a cell at rest", 1)[1].split("usl, 2 particles a cell moving", 1)[0]
    rows = re.findall(r"^(linear|quadratic) +(\w+) +(\S+) +\S+ +(\S+) +\S+$", table, flags=re.MULTILINE)
    if len(rows) < 16:
        refuse("docs/damping.md has no table of what is kept at rest")
    return [(basis, transfer, float(large), float(small)) for basis, transfer, large, small in rows]


def draw_damping():
    rows = kept()
    figure = style.new_figure(4.4, "usl at rest, one dimension, 2 particles a cell, a wave of 16 cells")
    panels = figure.subplots(1, 2, sharex=True)
    for axes, basis, title in zip(panels, ("linear", "quadratic"), ("hats", "quadratic splines")):
        some = [row for row in rows if row[0] == basis]
        for place, (_, _, large, small) in enumerate(reversed(some)):
            axes.barh(place + 0.2, large, 0.36, color="#0072B2")
            axes.barh(place - 0.2, small, 0.36, color="#E69F00", hatch="///", edgecolor="white", linewidth=0)
        axes.set(yticks=range(len(some)), yticklabels=[row[1] for row in reversed(some)], xlim=(0, 1.02), title=title)
        axes.grid(axis="x", color="#dddddd")
    handles = [panels[0].barh(0, 0, color="#0072B2"), panels[0].barh(0, 0, color="#E69F00", hatch="///", edgecolor="white")]
    panels[0].legend(handles, ["k = 1/2", "k = 1/8, a smaller step"], loc="lower right")
    figure.suptitle("What is left of a wave's amplitude after 100 periods", fontsize=10.5)
    return figure


def main():
    parser = Parser(__doc__)
    parser.add_argument("-o", "--output", metavar="FOLDER", default=os.path.join(ROOT, "examples"), help="where they are written (examples)")
    folder = parser.parse_args().output
    for name, draw in (("limits", draw_limits), ("damping", draw_damping)):
        write_whole(os.path.join(folder, f"{name}.png"), style.encoded(draw(), "png"))


if __name__ == "__main__":
    end_in_one_line(main)
