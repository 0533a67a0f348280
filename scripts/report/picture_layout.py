"""Draws particles coloured by their bound of the step, and the mode that grows first as arrows. layout() returns the figure."""
import csv
import json

import numpy

import picture_files as files
import picture_style as style

LONGEST = 0.15  # the longest arrow, in the extent of the particles
MADE_BY = "a CSV file that 'mpmstab critical -layout FILE -write_layout FILE' has written"


def columns_of(path):
    """Returns the columns of the CSV by name; an empty cell is NaN."""
    files.require_file(path, MADE_BY)
    with open(path, encoding="utf-8", newline="") as file:
        header, *rows = list(csv.reader(file)) or [[]]
    if "x" not in header or "particle" not in header or not rows or any(len(row) != len(header) for row in rows):
        files.refuse(path, "no columns x and particle with a line for each particle", MADE_BY)
    try:
        return {name: numpy.array([float(row[i] or "nan") for row in rows]) for i, name in enumerate(header)}
    except ValueError:
        return files.refuse(path, "a cell that is no number", MADE_BY)


def in_words(path):
    """Returns the scheme, and the limit with its time step, or what there is of them. A scene need not have a step."""
    files.require_file(path, "a JSON file of 'mpmstab critical'")
    try:
        with open(path, encoding="utf-8") as file:
            result = json.load(file)
        found = result["critical"]
    except (ValueError, KeyError, TypeError):
        files.refuse(path, "no result of critical", "a JSON file of 'mpmstab critical'")
    words = [f"{result.get('formulation')}, {result.get('basis')} basis, {result.get('transfer')} transfer"]
    if found.get("critical_courant") is not None:
        words.append(f"limit c dt / h = {found['critical_courant']:.4g}")
    if found.get("critical_dt") is not None:
        words.append(f"dt = {found['critical_dt']:.4g}")
    return "; ".join(words)


def along_a_line(figure, column, decides):
    """One dimension: the bound over the place, and the mode below it."""
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot(column["x"], column["particle"], "o", color=style.COLOURS[1], markersize=4, label="bound of a particle")
    above.plot(column["x"][decides], column["particle"][decides], "s", color=style.COLOURS[0], markersize=9,
               markerfacecolor="none", label=f"particle {decides} decides")
    above.set_ylabel("bound of c dt / h")
    above.set_ylim(bottom=0)
    above.legend(loc="lower right")
    below.axhline(0, color=style.GREY, linewidth=0.8)
    below.vlines(column["x"], 0, column["mode_x"], color=style.COLOURS[1], linewidth=1.2)
    below.plot(column["x"], column["mode_x"], "o", color=style.COLOURS[1], markersize=4)
    below.set_ylabel("velocity in the mode\n(largest: 1)")
    below.set_xlabel("x (unit of length)")


def in_the_plane(figure, column, decides):
    """Two dimensions, or three seen along z."""
    axes = figure.subplots()
    extent = max(numpy.ptp(column["x"]), numpy.ptp(column["y"]))
    shown = axes.scatter(column["x"], column["y"], c=column["particle"], cmap="cividis", s=26, linewidths=0)
    figure.colorbar(shown, ax=axes, label="bound of c dt / h of each particle")
    axes.quiver(column["x"], column["y"], column["mode_x"], column["mode_y"], color=style.COLOURS[0], angles="xy",
                scale_units="xy", scale=1 / (LONGEST * extent), width=0.0035)
    axes.set_title("arrows: velocities in the mode that grows first")
    axes.margins(LONGEST)
    axes.plot(column["x"][decides], column["y"][decides], "s", markersize=12, markerfacecolor="none", color="black",
              label=f"particle {decides} decides the bound")
    axes.set_aspect("equal")
    axes.set_xlabel("x (unit of length)" + (", seen along z" if "z" in column else ""))
    axes.set_ylabel("y (unit of length)")
    style.legend_below(axes)


def layout(path, result_path=None):
    """Returns the figure of a layout's CSV, with the scheme and the limit of the JSON beside it in the footer."""
    column = columns_of(path)
    if numpy.isnan(column["particle"]).all():
        files.refuse(path, "no bound is known of its particles", "a scheme that has one (docs/theory.md, section 4)")
    decides = int(numpy.nanargmin(column["particle"]))
    figure = style.new_figure(5.6, in_words(result_path) if result_path else f"{len(column['x'])} particles of {path}")
    (in_the_plane if "y" in column else along_a_line)(figure, column, decides)
    return figure
