"""Draws runs: growth, space-time, frames and a movie. frames() returns the names of files, the others a figure."""
import io
import math
import os
import time

import numpy
from matplotlib import colors
from matplotlib.animation import PillowWriter
from matplotlib.collections import PolyCollection

import picture_colliders as colliders
import picture_files as files
import picture_plane as plane
import picture_scenes as scenes
import picture_style as style
from whole_files import fault_of_outputs, write_whole

OUTPUT = "run -output -output_every n"
MOST_ROWS = 300  # output steps in a space-time picture
MOST_FRAMES = 500
LONG = 10  # seconds
LONG_GROWTH = 30  # if the largest size is beyond this many medians, each step of a picture has its own scale


def size_of(path):
    """Returns the steps and the size of the state relative to its start, from the RUN.csv beside RUN.json."""
    rows = files.read_csv(os.path.splitext(path)[0] + ".csv", ["step", "energy"], "run -csv")
    rows = [row for row in rows if math.isfinite(row["energy"])]  # an empty one is beyond doubles
    if not rows or rows[0]["energy"] <= 0:
        files.refuse(path, "no energy to begin with in its CSV", "a run that starts from data that are not zero")
    energy = numpy.array([row["energy"] for row in rows])
    return numpy.array([row["step"] for row in rows]), numpy.sqrt(energy / energy[0])


def predicted_of(result, spectra):
    """Returns the predicted growth per step of the initial data, from the run or from a spectrum of its scene."""
    for key in ("eigenmode", "corrected_mode", "corrected"):
        if result["predicted"].get(key) is not None:
            return result["predicted"][key]
    same = [s for s in spectra if scenes.compared(s) == scenes.compared(result)]
    return same[0]["spectrum"].get("growth") if same else None


def shared(results):
    """Returns the parts of the scenes that all have in common, and for each scene its other parts."""
    parts = [scenes.scene_parts(result) for result in results]
    same = [text for key, text in parts[0].items() if all(part.get(key) == text for part in parts)]
    own = [[text for key, text in part.items() if any(other.get(key) != text for other in parts)] for part in parts]
    return same, [", ".join(texts) for texts in own]


def through(steps, size, per_step):
    """Returns powers of the growth per step, scaled to pass through the middle of the late half of the run."""
    late = slice(len(steps) // 2, None)
    level = numpy.mean(numpy.log(size[late]) - steps[late] * math.log(per_step))
    with numpy.errstate(over="ignore"):
        return numpy.exp(level + steps * math.log(per_step))


def growth(paths, last=None):
    """Draws the size of the state over steps, with the predicted growth dashed.

    The paths are results of runs. There may be results of spectra, which predict growth where a run does not.
    """
    read = [(path, files.read_json(path)) for path in paths]
    spectra = [result for _, result in read if result.get("task") == "spectrum"]
    runs = [(path, result) for path, result in read if result.get("task") != "spectrum"]
    if not runs:
        files.refuse(paths[0], "is of the task spectrum", "beside at least one that 'mpmstab run -json' has written")
    for path, result in runs:
        files.part(result, "run", path, "run -json")
    same, own = shared([result for _, result in runs])
    half = (len(same) + 1) // 2
    figure = style.new_figure(4.6 + 0.2 * len(runs), scenes.wrapped(", ".join(same[:half]), ", ".join(same[half:])))
    axes, labelled = figure.add_subplot(), False
    for number, (path, result) in enumerate(runs):
        steps, size = size_of(path)
        shown = steps <= (last or steps[-1])
        measured = result["run"].get("growth_measured")
        text = "growth not measured" if measured is None else f"{measured:.6f} per step"
        axes.plot(steps[shown], size[shown], color=style.COLOURS[number % 6], marker=style.MARKERS[number % 6],
                  markevery=max(1, shown.sum() // 9), label=f"{own[number]}: {text}".lstrip(": "), gid=f"run{number}")
        predicted = predicted_of(result, spectra)
        if predicted is not None:
            axes.plot(steps[shown], through(steps[shown], size[shown], predicted), "k--", linewidth=1,
                      gid=f"predicted{number}")
            labelled = True
    if labelled:
        axes.plot([], [], "k--", linewidth=1, label="predicted growth")
    axes.set_yscale("log")
    style.plain_powers(axes.yaxis)
    axes.set_title("measured growth")
    axes.set_xlabel("time step n")
    axes.set_ylabel("size of the state, $\\sqrt{E / E_0}$ (E: energy)")
    axes.set_xlim(0, last)
    axes.grid(True, alpha=0.3)
    style.legend_below(axes, columns=1)
    return figure


def cells_around(x, length):
    """Returns the ends of the interval that is nearer to each place than to any other, in the order of x."""
    order = numpy.argsort(x, kind="stable")
    sorted_x = x[order]
    middles = (sorted_x[1:] + sorted_x[:-1]) / 2
    left, right = numpy.empty_like(x), numpy.empty_like(x)
    left[order] = numpy.concatenate(([0], middles))
    right[order] = numpy.concatenate((middles, [length]))
    return left, right


def places_of(group):
    """Returns x of the particles at an output step."""
    return files.array(group, "particles/coordinates", OUTPUT)[:, 0]


def rows_of(file, field, length):
    """Returns the field, how many steps are shown in words, and their numbers, places / L and values."""
    steps = files.steps_of(file)
    field = field or files.fields_of(steps[0][1])[0]
    if field not in files.fields_of(steps[0][1]):
        files.refuse(file.filename, f"no field '{field}' in it", " or ".join(files.fields_of(steps[0][1])))
    thinned = steps[:: -(-len(steps) // MOST_ROWS)]
    shown = f"{len(thinned)} of {len(steps)}" if len(thinned) < len(steps) else f"{len(steps)}"
    x = [places_of(group) / length for _, group in thinned]
    values = [files.array(group, f"particles/{field}", OUTPUT) for _, group in thinned]
    return field, shown, numpy.array([step for step, _ in thinned]), numpy.array(x), numpy.array(values)


def outgrows(sizes):
    """Says whether one scale for all steps would show the last ones only."""
    return sizes.max() > LONG_GROWTH * numpy.median(sizes[sizes > 0]) if sizes.any() else False


def spacetime(path, field=None):
    """Draws one particle field over place and time, with the value of each particle around its place."""
    with files.open_hdf5(path) as file:
        scene = scenes.attributes(file)
        scenes.require_dimension(path, scene, (1,), "a field over place and time (frames shows it)")
        field, shown, steps, x, values = rows_of(file, field, float(scene["length"]))
    if len(steps) < 2:
        files.refuse(path, "only one step in it", "a run with -output_every")
    edges = numpy.concatenate(([steps[0]], (steps[1:] + steps[:-1]) / 2, [steps[-1]]))
    sizes = numpy.array([max(abs(low), abs(high)) for low, high in map(files.finite_range, values)])
    own_scale = outgrows(sizes)
    if own_scale:
        values = values / numpy.where(sizes > 0, sizes, 1)[:, None]
    largest = 1.0 if own_scale else float(sizes.max()) or 1.0
    boxes = []
    for row, places in enumerate(x):
        left, right = cells_around(places, 1.0)
        low, high = numpy.full_like(left, edges[row]), numpy.full_like(left, edges[row + 1])
        boxes.append(numpy.stack([numpy.stack(corner, -1) for corner in
                                  ((left, low), (right, low), (right, high), (left, high))], axis=1))
    picture = PolyCollection(numpy.concatenate(boxes), array=values.ravel(), cmap="RdBu_r", linewidths=0,
                             antialiaseds=False, norm=colors.Normalize(-largest, largest), rasterized=True)
    figure = style.new_figure(4.8, scenes.scene_text(scene))
    axes = figure.add_subplot()
    axes.add_collection(picture)
    label = f"{field} over its largest value at that step" if own_scale else scenes.quantity(scene, field)
    figure.colorbar(picture, ax=axes, label=label)
    axes.set_xlim(0, 1)
    axes.set_ylim(edges[0], edges[-1])
    axes.set_title(f"{field} over place and time ({shown} output steps)")
    axes.set_xlabel("place x / L")
    axes.set_ylabel("time step n")
    return figure


def largest_of(group, field):
    """Returns the largest absolute value of a field on particles."""
    return max(map(abs, files.finite_range(files.array(group, f"particles/{field}", OUTPUT))))


def frame_limits(steps, fields):
    """Returns the largest absolute value of each field over all steps; None where most steps would be invisible."""
    limits = {}
    for field in fields:
        sizes = numpy.array([largest_of(group, field) for _, group in steps])
        limits[field] = None if outgrows(sizes) else sizes.max()
    return limits


def frame(scene, step, group, fields, limits):
    """Draws particles and nodes over x at one output step."""
    length = float(scene["length"])
    x = places_of(group) / length
    order = numpy.argsort(x, kind="stable")
    figure = style.new_figure(1.4 + 1.7 * len(fields), scenes.scene_text(scene))
    rows = figure.subplots(len(fields), 1, sharex=True, squeeze=False)[:, 0]
    for axes, field in zip(rows, fields):
        nodes = files.array(group, f"nodes/{field}", OUTPUT)
        places = numpy.arange(len(nodes)) / int(scene["cells"])
        axes.plot(places, nodes, "-", color=style.COLOURS[0], linewidth=1.2, label="nodes", gid=f"nodes/{field}",
                  zorder=3)
        axes.plot(x[order], files.array(group, f"particles/{field}", OUTPUT)[order], "o", color=style.COLOURS[1],
                  markersize=3.5, label="particles", gid=f"particles/{field}")
        axes.set_ylabel(scenes.quantity(scene, field, "\n"))
        axes.set_xlim(0, 1)
        if limits[field]:
            axes.set_ylim(-1.1 * limits[field], 1.1 * limits[field])
        axes.grid(True, alpha=0.3)
    rows[0].set_title(f"time step {step}, t = {float(group.attrs['time']):.4g}", loc="left")
    rows[0].legend(loc="lower right", bbox_to_anchor=(1, 1), ncol=2, borderaxespad=0.2, frameon=False)
    rows[-1].set_xlabel("place x / L")
    return figure


def registers_of(group):
    """Returns the particle fields at an output step by name, displacement or velocity first."""
    names = sorted((name for name in group["particles"] if name not in ("coordinates", "volume", "mass", "young")),
                   key=lambda name: ("uvrwsc".find(name[0]), name))
    return {name: files.array(group, f"particles/{name}", OUTPUT) for name in names}


def sizes_of(registers, panels):
    """Returns the largest absolute value of each panel."""
    return [max(map(abs, files.finite_range(panel.values(registers)))) for panel in panels]


def panel_limits(steps, panels):
    """Returns the largest values of all panels over all steps; None where most steps would be invisible."""
    sizes = numpy.array([sizes_of(registers_of(group), panels) for _, group in steps])
    return None if outgrows(sizes.max(axis=1)) else plane.with_floor(sizes.max(axis=0))


def plane_frame(scene, step, group, panels, limits):
    """Draws particles in the plane, or in a layer of cells, at one output step: a picture for each panel."""
    registers = registers_of(group)
    cells = [int(count) for count in scenes.each(scene, "cells")]
    x = files.array(group, "particles/coordinates", OUTPUT) * cells[0] / float(scenes.each(scene, "length")[0])
    kept, where = plane.layer_of(scene, x)
    down = cells[0] > 2 * cells[1]  # a long domain has its panels one below the other
    tall = cells[1] > 2 * cells[0]  # panels side by side; of other domains a telephone would show no more than two in a row
    columns = 1 if down else len(panels) if tall else min(2, len(panels))
    rows = math.ceil(len(panels) / columns)
    high = 0.7 + 5 * cells[1] / cells[0] if down else 1.1 + 2.6 * cells[1] / cells[0]
    figure = style.new_figure(0.9 + rows * high, scenes.scene_text(scene), width=max(6.4, 0.4 + 3.2 * columns))
    places = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes in places[len(panels):]:
        axes.remove()
    for axes, panel, largest in zip(places, panels, limits or plane.with_floor(sizes_of(registers, panels))):
        discs = plane.draw_particles(axes, scene, x[kept], panel.values(registers)[kept],
                                     plane.colours_of(largest, panel.signed), panel.label)
        if panel.vector:
            plane.draw_arrows(axes, scene, x[kept], [registers[name][kept] for name in panel.vector[:2]], largest,
                              "arrows")
        plane.frame_axes(axes, scene)
        colliders.draw(axes, scene, float(group.attrs["time"]))
        plane.add_bar(figure, discs, axes, panel.text(registers), "right" if down else "bottom")
    figure.suptitle(f"time step {step}, t = {float(group.attrs['time']):.4g}{where}", fontsize=10.5)
    return style.settle(figure)


def drawing_of(path, scene, steps):
    """Returns a function that draws the frame of a step and its group, with scales that all frames share."""
    if scenes.dimension(scene) == 1:
        fields = files.fields_of(steps[0][1])
        limits = frame_limits(steps, fields)
        return lambda step, group: frame(scene, step, group, fields, limits)
    panels = plane.panels_of(registers_of(steps[0][1]))
    if not panels:
        files.refuse(path, "no fields of particles in it", f"a file that 'mpmstab {OUTPUT}' has written")
    limits = panel_limits(steps, panels)
    return lambda step, group: plane_frame(scene, step, group, panels, limits)


def frames(path, folder, per_second=12, tell=None):
    """Writes a PNG for each output step and movie.gif to the folder. Returns their names.

    tell is called with a sentence once the first picture is drawn, where all will take longer than LONG seconds.
    """
    with files.open_hdf5(path) as file:
        scene, steps = scenes.attributes(file), files.steps_of(file)
        if len(steps) > MOST_FRAMES:
            files.refuse(path, f"{len(steps)} steps in it", f"up to {MOST_FRAMES}, by a larger -output_every")
        draw = drawing_of(path, scene, steps)
        names = [os.path.join(folder, name) for name in (*(f"step_{step:010d}.png" for step, _ in steps), "movie.gif")]
        fault = fault_of_outputs(names, [path])
        if fault:
            raise files.Refusal(fault)
        os.makedirs(folder, exist_ok=True)
        movie, began = PillowWriter(fps=per_second), time.monotonic()
        for name, (step, group) in zip(names, steps):
            figure = draw(step, group)
            write_whole(name, style.encoded(figure, "png"))
            if name == names[0]:
                movie.setup(figure, "movie.gif", dpi=100)
            movie.fig = figure
            movie.grab_frame()
            left = (time.monotonic() - began) * len(steps)
            if tell and name == names[0] and left > LONG:
                tell(f"{len(steps)} pictures and a film: about {left:.0f} s; a larger -output_every or -output_interval makes fewer")
    write_whole(names[-1], film(movie))
    return names


def last_frame(path):
    """Draws the last output step."""
    with files.open_hdf5(path) as file:
        scene, steps = scenes.attributes(file), files.steps_of(file)
        return drawing_of(path, scene, steps)(*steps[-1])


def film(movie):
    """Returns the bytes of the movie."""
    file = io.BytesIO()
    movie._frames[0].save(file, format="GIF", save_all=True, append_images=movie._frames[1:],
                          duration=int(1000 / movie.fps), loop=0)
    return file.getvalue()
