"""Says how every picture looks, and writes it as PNG and SVG, whole or not at all."""
import io

import matplotlib
from matplotlib.figure import Figure
from matplotlib.ticker import LogFormatterSciNotation

from whole_files import write_whole

# The colours of Okabe and Ito, which colour-blind people tell apart; each has a marker or a kind of line of its own.
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

LOOK = {
    "svg.fonttype": "none",  # so that text stays text
    "svg.hashsalt": "mpmstab",  # so that the same data give the same file
    "font.size": 10, "axes.titlesize": 10.5, "axes.labelsize": 10, "xtick.labelsize": 9, "ytick.labelsize": 9,
    "legend.fontsize": 9, "legend.framealpha": 0.9, "axes.axisbelow": True, "lines.markersize": 5,
}
matplotlib.rcParams.update(LOOK)


def new_figure(height, footer, width=6.4):
    """Returns a figure with a footer, as wide as a page in inches, so that 9 points print as 9 points."""
    figure = Figure(figsize=(width, height), constrained_layout=True)
    figure.supxlabel(footer, fontsize=9, color="#444444")
    return figure


def settle(figure):
    """Lays out a figure of axes with a fixed shape, which needs more than one pass, or else titles may be cut off."""
    for _ in range(4):
        figure.get_layout_engine().execute(figure)
    return figure


class PlainPowers(LogFormatterSciNotation):
    """Labels a logarithmic axis in one way: with plain numbers, or with powers where it leaves 1e-3 to 1e5.

    Which ticks have a label is as usual.
    """

    def __call__(self, value, position=None):
        text = super().__call__(value, position)
        low, high = sorted(self.axis.get_view_interval())
        return f"{value:.6g}" if text and 1e-3 <= low and high < 1e5 else text


def plain_powers(axis):
    """Gives a logarithmic axis labels without needless powers of ten."""
    axis.set_major_formatter(PlainPowers())
    axis.set_minor_formatter(PlainPowers(minor_thresholds=(2, 0.6)))


def legend_below(axes, columns=2, **options):
    """Adds a legend half an inch under the axis, where it hides no data."""
    below = 0.75 / axes.figure.get_figheight()
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -below), ncol=columns, **options)


def encoded(figure, kind):
    """Returns the bytes of a file of this kind, svg or png."""
    file = io.BytesIO()
    figure.savefig(file, format=kind, dpi=150, metadata={"Date": None} if kind == "svg" else {"Software": None})
    return file.getvalue()


def names_of(name):
    """Returns the files that save() writes, NAME.png and NAME.svg. The name may have either ending already."""
    stem = name[:-4] if name.endswith((".png", ".svg")) else name
    return f"{stem}.png", f"{stem}.svg"


def save(figure, name):
    """Writes the PNG and the SVG, after both have been drawn."""
    contents = [(path, encoded(figure, path[-3:])) for path in names_of(name)]
    for path, content in contents:
        write_whole(path, content)
