"""Draws error over run time on log axes: lines for families, a heavy efficient frontier, crosses for unstable runs."""
import textwrap

from matplotlib import ticker
from matplotlib.figure import Figure

import picture_style as style
from precision_table import SCHEME, families, frontier, name_of, seconds, usable, varying

UNSTABLE, *COLOURS = *style.COLOURS, "#000000"
MARKERS = style.MARKERS + "<>*h"


def draw_family(axes, number, members, names):
    points = [row for row in members if usable(row)]
    if not points:
        return
    points.sort(key=lambda row: row["best_s"])
    order = points[-1]["order"] if "courant" in names or len({row["courant"] for row in points}) == 1 else None
    label = name_of(points[0], names) + ("" if order is None else f", order {order:.2f}")
    axes.loglog([row["best_s"] for row in points], [row["error_l2"] for row in points], color=COLOURS[number % 6],
                marker=MARKERS[number % 10], linestyle=("-", "--", ":")[number // 6 % 3], label=label, linewidth=1.2,
                zorder=3)


def draw_unstable(axes, rows, names, top):
    """Draws unstable runs as crosses at their error, or at the top when it is far beyond the others'."""
    shown = [row for row in rows if row["status"] == "unstable" and row["best_s"]]
    if not shown:
        return
    heights = [min(row["error_l2"] or top, top) for row in shown]
    axes.plot([row["best_s"] for row in shown], heights, linestyle="none", marker="X", markersize=9, color=UNSTABLE,
              markerfacecolor="none", zorder=4, clip_on=False,
              label=textwrap.fill("unstable: " + ", ".join(dict.fromkeys(name_of(row, names) for row in shown))
                                  + " (at the top: error beyond the scale)" * (top in heights), 40))


def draw(rows, title, searched=False):
    """Returns the figure. searched: a line joins the rows of a scheme, which are at different Courant numbers."""
    figure = Figure(constrained_layout=True)
    grid = figure.add_gridspec(2, 1)
    axes, below = figure.add_subplot(grid[0]), figure.add_subplot(grid[1])
    below.axis("off")
    names = [name for name in varying(rows) if name != "courant" or not searched]
    for number, members in enumerate((families(rows, SCHEME) if searched else families(rows)).values()):
        draw_family(axes, number, members, names)
    best = frontier(rows)
    axes.loglog([row["best_s"] for row in best], [row["error_l2"] for row in best], color="0.75", linewidth=6, zorder=1,
                solid_capstyle="round", label="frontier: nothing faster is as accurate")
    good = [row["error_l2"] for row in rows if usable(row)]
    draw_unstable(axes, rows, names, 2 * max(good) if good else 1.0)
    ranks = sorted({row["ranks"] for row in rows})
    times = [row["best_s"] for row in rows if row["best_s"]] or [1]
    axes.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5) if max(times) < 50 * min(times) else (1,)))
    axes.xaxis.set_major_formatter(lambda value, _: seconds(value))
    axes.xaxis.set_minor_formatter(ticker.NullFormatter())
    style.plain_powers(axes.yaxis)
    axes.set_xlabel(f"run time of the loop, best of repeats ({', '.join(map(str, ranks))} rank{'s' * (ranks != [1])})")
    axes.set_ylabel("largest l2 error over the fields,\nover the exact amplitude")
    axes.set_title("\n".join(textwrap.fill(line, 62) for line in title.split("\n")), fontsize=10)
    axes.grid(True, which="major", alpha=0.3)
    handles, labels = axes.get_legend_handles_labels()
    below.legend(handles, labels, fontsize=8.5, loc="center", ncol=2, borderaxespad=0)
    lines = 1 + len(labels) // 2 + max(label.count("\n") for label in labels)  # beside one another the highest counts
    figure.set_size_inches(5.6, 4.6 + 0.2 * lines)
    grid.set_height_ratios([4.6, 0.2 * lines])
    return figure
