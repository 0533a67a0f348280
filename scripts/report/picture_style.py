"""How every picture looks, and how it is written: PNG and SVG, whole or not at all."""
import io

import matplotlib

matplotlib.use("Agg")
from matplotlib.figure import Figure  # noqa: E402 (the backend comes first)

from program import write_whole  # noqa: E402

# Okabe and Ito: told apart by every eye; each goes with a marker or a kind of line of its own.
COLOURS = ["#D55E00", "#0072B2", "#CC79A7", "#009E73", "#E69F00", "#56B4E9"]
MARKERS = "osD^vP"
COLUMNS = {"published": {"color": "#D55E00", "linestyle": "--", "linewidth": 1.8},
           "corrected": {"color": "#E69F00", "linestyle": "-.", "linewidth": 2.4},
           "symbol": {"color": "#0072B2", "linestyle": "-", "linewidth": 1.4},
           "measured": {"color": "#009E73", "linestyle": ":", "linewidth": 2}}
EIGENVALUES = {"linestyle": "none", "marker": "o", "markersize": 6, "markerfacecolor": "none", "color": "black",
               "markeredgewidth": 0.8}
GREY = "#777777"
PHASES = [(0, "0"), (0.25, "π/4"), (0.5, "π/2"), (0.75, "3π/4"), (1, "π")]

matplotlib.rcParams.update({
    "svg.fonttype": "none",  # text stays text
    "svg.hashsalt": "mpmstab",  # the same data give the same file
    "font.size": 10, "axes.titlesize": 10.5, "axes.labelsize": 10, "xtick.labelsize": 9, "ytick.labelsize": 9,
    "legend.fontsize": 9, "legend.framealpha": 0.9, "axes.axisbelow": True, "lines.markersize": 5,
})


def new_figure(height, footer, width=6.4):
    """A figure of a page's width in inches (so that 9 points print as 9 points), with a footer."""
    figure = Figure(figsize=(width, height), constrained_layout=True)
    figure.supxlabel(footer, fontsize=9, color="#444444")
    return figure


def legend_below(axes, columns=2, **options):
    """A legend that cannot lie over data: half an inch under the axis."""
    below = 0.75 / axes.figure.get_figheight()
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -below), ncol=columns, **options)


def encoded(figure, kind):
    """The bytes of a file, svg or png."""
    file = io.BytesIO()
    figure.savefig(file, format=kind, dpi=150, metadata={"Date": None} if kind == "svg" else {"Software": None})
    return file.getvalue()


def names_of(name):
    """The files that save() writes: NAME.png and NAME.svg, whichever of the two endings name has."""
    stem = name[:-4] if name.endswith((".png", ".svg")) else name
    return f"{stem}.png", f"{stem}.svg"


def save(figure, name):
    """Writes both files when both pictures are there."""
    contents = [(path, encoded(figure, path[-3:])) for path in names_of(name)]
    for path, content in contents:
        write_whole(path, content)
