"""Draws the largest Courant number without growth over the Mach number: a column for each kind, and below it that per cost."""
from picture_style import COLOURS, MARKERS, new_figure, plain_powers

NONE = 0.006  # where a step without any is drawn
NARROW = 5.2  # inches: at 390 pixels 11 points are still read


def draw_quiet(least, kinds, cost, machs):
    """Returns the figure. least has the limit by (kind, step, Mach number)."""
    figure = new_figure(7.2, "the least of lattices of 1 to 4 particles a cell; growth above 1e-6 a step counts;\n"
                        "at the bottom edge: grows at every k looked at", width=NARROW)
    places = [[kind + per for kind in kinds] for per in ("", " per cost")]
    panels = figure.subplot_mosaic([["words"] * len(kinds), *places], gridspec_kw={"height_ratios": [0.09, 1, 1]})
    panels["words"].axis("off")
    for kind in kinds:
        for per, costs in (("", dict.fromkeys(cost, 1)), (" per cost", cost)):
            axes = panels[kind + per]
            for place, step in enumerate(cost):
                values = [max(least[kind, step, mach][0] / costs[step], NONE) for mach in machs]
                axes.plot([mach[0] / mach[1] for mach in machs], values, color=COLOURS[place], marker=MARKERS[place],
                          linewidth=1.8, markersize=6, label=step, clip_on=False)
            axes.set(xscale="log", yscale="log")
            axes.set_ylim(NONE, 6)
            axes.grid(True, which="major", color="#dddddd", linewidth=0.6)
            plain_powers(axes.yaxis)
            plain_powers(axes.xaxis)
            axes.tick_params(labelsize=11, labelbottom=bool(per), labelleft=kind == next(iter(kinds)))
        panels[kind].set_title(kind + ("" if kind == "MLS-MPM" else ", quadratic"), fontsize=12)
        panels[kind + " per cost"].set_xlabel("Mach number $U_0/c$", fontsize=12)
    first = next(iter(kinds))
    panels[first].set_ylabel("largest $k = c\\,\\Delta t/h$\nwithout growth", fontsize=12)
    panels[first + " per cost"].set_ylabel("that per cost of a step,\nof which usl is 1", fontsize=12)
    panels["words"].legend(*panels[first].get_legend_handles_labels(), loc="center", ncol=5, fontsize=11.5, frameon=False,
                           handlelength=1.3, columnspacing=0.9, handletextpad=0.4)
    return figure
