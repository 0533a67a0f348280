"""Draws and prints how long schemes take for an error: a panel for each end time, a row for each scheme."""
import math

from matplotlib import ticker
from matplotlib.figure import Figure

import picture_style as style
from precision_study import SCHEMES, TRANSFERS

LOOK = dict(zip(TRANSFERS, zip(("#0072B2", "#E69F00", "#009E73", "#CC79A7"), "osD^")))  # colour-blind people tell these apart
REFERENCE = "usl"
NEVER = 8.0   # times the slowest: where schemes stand that do not reach the error
BESIDE = 0.16  # of a row: the transfers of a scheme stand beside one another


def per_cent(value):
    return f"{100 * value:.3g} %"


def draw_panel(axes, found, periods, wanted):
    """One end time: the best step as a symbol, the spread of layouts as a line, the usual step as a tick."""
    times = [time for one in found for time in (one["low"], one["high"], one["usual"]) if time < math.inf] or [1e-3]
    never = max(times) * NEVER
    for one in found:
        colour, marker = LOOK[one["transfer"]]
        row = list(SCHEMES).index(one["scheme"]) + BESIDE * (list(TRANSFERS).index(one["transfer"]) - 1.5)
        if one["seconds"] == math.inf:
            axes.plot([never], [row], marker=marker, color=colour, markerfacecolor="white", markersize=4.5, linestyle="none")
            continue
        axes.plot([one["low"], min(one["high"], never)], [row, row], color=colour, linewidth=3, alpha=0.45)
        axes.plot([one["seconds"]], [row], marker=marker, color=colour, markersize=5, linestyle="none")
        if one["usual"] < math.inf:
            axes.plot([one["seconds"], one["usual"]], [row, row], color=colour, linewidth=0.8)
            axes.plot([one["usual"]], [row], marker="|", color=colour, markersize=6, linestyle="none")
    axes.set_xscale("log")
    axes.set_xlim(min(times) / 1.6, never * 2.2)
    axes.axvspan(never / 2.2, never * 2.2, color="0.92", zorder=0)
    axes.text(never, -0.62, "not\nreached", ha="center", va="bottom", fontsize=8, color="#444444")
    axes.set_ylim(len(SCHEMES) - 0.4, -0.6)
    axes.set_yticks(range(len(SCHEMES)), list(SCHEMES))
    for row in range(len(SCHEMES) - 1):
        axes.axhline(row + 0.5, color="0.85", linewidth=0.6, zorder=0)
    axes.xaxis.set_major_locator(ticker.LogLocator(numticks=8))
    axes.xaxis.set_major_formatter(lambda value, _: duration(value) if value < never / 2.2 else "")
    axes.xaxis.set_minor_formatter(ticker.NullFormatter())
    axes.grid(True, axis="x", alpha=0.4)
    axes.set_title(f"error {per_cent(wanted)} after {periods:g} periods", fontsize=10, loc="left")


def duration(value):
    for unit, factor in (("s", 1), ("ms", 1e3)):
        if value * factor >= 0.9999:
            return f"{value * factor:.3g} {unit}"
    return f"{value * 1e6:.3g} µs"


def draw(scene, tables):
    """Returns the picture of a scene; tables has what standing() found for each end time."""
    figure = Figure(figsize=(4.6, 1.6 + 2.35 * len(tables)), constrained_layout=True)
    panels = figure.subplots(len(tables), 1, squeeze=False)[:, 0]
    for axes, (periods, found) in zip(panels, tables.items()):
        draw_panel(axes, found, periods, scene.errors[periods])
    panels[-1].set_xlabel("run time on one core: steps times the cost of a step\n(left is better)")
    figure.suptitle(f"{scene.title}: time for an error\na standing wave, quadratic splines, 2 particles a cell\n"
                    "and direction; each scheme at its best step", fontsize=10.5)
    for name, (colour, marker) in LOOK.items():
        panels[-1].plot([], [], marker=marker, color=colour, linestyle="none", label=name)
    panels[-1].plot([], [], color="0.4", linewidth=3, alpha=0.45, label="least to most\nover layouts")
    panels[-1].plot([], [], color="0.4", linewidth=0.8, marker="|", markersize=6, label="a usual step: half\nthe limit; implicit k = 5")
    panels[-1].legend(loc="upper center", bbox_to_anchor=(0.45, -0.36), ncol=3, fontsize=8, columnspacing=0.8)
    return figure


def cell(one, unit, least):
    """A scheme's best transfer, with its time at the best step and at a usual one over the best time of usl, which is unit.

    usl itself has seconds, and so has each scheme where usl does not reach the error. The cheapest is bold. A scheme that does not
    reach the error has the smallest that it reaches. A star: one of the layouts does not reach the error at the best step.
    """
    if one["seconds"] == math.inf:
        return "grows" if one["rings"] else f"({per_cent(one['smallest'])})" if one["smallest"] < 10 else "(above 1000 %)"
    absolute = unit == math.inf or one["scheme"] == REFERENCE
    best, usual = ("-" if time == math.inf else duration(time) if absolute else f"{float(f'{time / unit:.2g}'):g}"
                   for time in (one["seconds"], one["usual"]))
    star = "\\*" if one["high"] == math.inf else ""
    bold = "**" if one["seconds"] == least else ""
    return f"{bold}{best}{star}{bold} / {usual} {one['transfer']}"


def summary_rows(scene, tables):
    """Returns the lines of the page's table for a scene: a column for each scheme, at its best step and transfer."""
    lines = []
    for periods, found in tables.items():
        best = {}
        for one in found:
            best.setdefault(one["scheme"], one)
        cells = [cell(best[name], best[REFERENCE]["seconds"], found[0]["seconds"]) if name in best else "-" for name in SCHEMES]
        lines.append(f"| {scene.title} | {periods:g} | {per_cent(scene.errors[periods])} | {' | '.join(cells)} |")
    return lines


def summary_head():
    return [f"| scene | periods | error | {' | '.join(SCHEMES)} |", "|---" * (3 + len(SCHEMES)) + "|"]


def table(scene, tables):
    """Returns the full table of a scene as text."""
    lines = [scene.title]
    for periods, found in tables.items():
        lines += ["", f"error {per_cent(scene.errors[periods])} after {periods:g} periods",
                  f"{'scheme':<9}{'transfer':<10}{'k':>6}{'seconds':>10}{'least':>10}{'most':>10}{'usual k':>10}{'ratio':>8}"]
        for one in found:
            times = "".join(f"{one[name]:>10.3g}" for name in ("seconds", "low", "high", "usual"))
            ratio = one["seconds"] / found[0]["seconds"] if one["seconds"] < math.inf else math.inf
            reach = "" if ratio < math.inf else "  rings" if one["rings"] else f"  smallest error {one['smallest']:.2g}"
            lines.append(f"{one['scheme']:<9}{one['transfer']:<10}{one['courant']:>6g}{times}{ratio:>8.3g}{reach}")
    return "\n".join(lines) + "\n"
