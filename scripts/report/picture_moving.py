"""Draws growth of moving particles over their velocity: panels for bases one below the other, colours for schemes, two Courant numbers."""
import math

from picture_style import COLOURS, MARKERS, new_figure

TITLES = {"linear": "hats", "gimp": "GIMP", "quadratic": "quadratic splines"}
LINES = ["-", "--"]


def draw_moving(growth, schemes, velocities, courants):
    """Returns the figure. growth has growth - 1 per step by (scheme, velocity, Courant number); 0 is not drawn."""
    bases = list(TITLES)
    grows = [scheme for scheme in schemes if any(growth[scheme, m, k] > 0 for m in velocities for k in courants)]
    names = list(dict.fromkeys(scheme[:2] for scheme in grows))
    still = dict.fromkeys(" ".join(scheme[:2]) for scheme in schemes if scheme[:2] not in names)
    figure = new_figure(9.6, "2 particles a cell; where a scheme has no point\nit does not grow; lines only join the points", width=4.8)
    *panels, words = figure.subplots(len(bases) + 1, 1, height_ratios=[1] * len(bases) + [0.5])
    words.axis("off")
    chosen = [courants[0], courants[-1]]
    for axes, basis in zip(panels, bases):
        for scheme in [s for s in grows if s[2] == basis]:
            place = names.index(scheme[:2])
            for line, courant in zip(LINES, chosen):
                points = [(m[0] / m[1], math.expm1(math.log1p(growth[scheme, m, courant]) * courant[1] / courant[0]))
                          for m in velocities]
                points = [point for point in points if point[1] > 0]
                axes.plot(*zip(*points) if points else ([], []), line, color=COLOURS[place], marker=MARKERS[place],
                          label=f"{' '.join(scheme[:2])}, k = {courant[0]}/{courant[1]}")
        axes.set(title=TITLES[basis], xscale="log", yscale="log", ylabel="growth − 1 per time $h$ / $c$")
        axes.grid(True, which="major", color="#dddddd", linewidth=0.6)
        axes.set_ylim(5e-8, 0.2)
    panels[-1].set_xlabel("velocity $U_0$ / $c$")
    for text in still:
        axes.plot([], [], " ", label=f"{text} does not grow")
    handles = {text: line for axes in panels for line, text in zip(*axes.get_legend_handles_labels())}
    words.legend(handles.values(), handles.keys(), loc="center", ncol=2, frameon=False, borderaxespad=0)
    return figure
