#!/usr/bin/python3
"""Checks the pictures of scenes of two and three dimensions: what is drawn against what the files hold, and the words.

check_picture_space.py MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import json
import os
import shutil
import sys

import h5py
import numpy
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_hex

from checks import check, loaded
import pictures
from check_pictures import SCENES, check_refused, check_written, close, line, mpmstab
from picture_files import steps_of
from picture_modes import modes
from picture_plane import layer_of
from picture_runs import drawing_of, last_frame
from picture_scenes import attributes, period, require_same
from picture_zone import wrapped

MPMSTAB = sys.argv[1]
SCENES.update(oblique="-dim 2 -formulation gas2 -basis quadratic -courant 0.5 -drift 1/8,1/6",
              damped="-dim 2 -formulation usl -basis quadratic -transfer apic -courant 1",
              turns="-dim 2 -formulation usl -courant 0.9 -drift 1/4,0 -ppc 1",
              box="-dim 3 -formulation usl -ppc 1 -courant 1.5",
              shear="-dim 2 -formulation usl -courant 0.5 -length 2,1", gas="-dim 3 -formulation gas2 -drift 0,0,1/2",
              fluid="-dim 2 -formulation usl -poisson 0.5", poisson="-dim 2 -formulation usl -drift 1/8,0",
              soft="-dim 2 -formulation usl -kinematics finite -material neo -sound_speed 10 -cell_width 0.5 -initial random")


def make():
    for name, cells in (("oblique", "8,4"), ("damped", "6"), ("turns", "4"), ("box", "4"), ("gas", "3,4,6")):
        mpmstab(MPMSTAB, "symbol", name, "-cells", cells, "-output", f"{name}-symbol.h5", "-csv", f"{name}-symbol.csv",
                "-json", f"{name}-symbol.json")
    for name, cells in (("turns", "4"), ("box", "3"), ("fluid", "4")):
        mpmstab(MPMSTAB, "spectrum", name, "-cells", cells, "-measure", "false", "-output", f"{name}.h5", "-json",
                f"{name}.json")
    for name, cells, start in (("shear", "12,6", ("-mode", "2,1", "-polarisation", "s")),
                               ("box", "4", ("-initial", "random")),
                               ("gas", "3,4,6", ("-initial", "random"))):
        mpmstab(MPMSTAB, "run", name, "-cells", cells, *start, "-steps", "8", "-output_every", "4", "-output",
                f"{name}-run.h5", "-json", f"{name}-run.json", "-csv", f"{name}-run.csv")


def panels_of(figure):
    """Returns the axes of a figure that are no colour bars and show something."""
    return [axes for axes in figure.axes if axes.get_label() != "<colorbar>" and axes.axison]


def colours_at(axes, places):
    """Returns the values in whose colours the boxes around places / pi are drawn."""
    mesh = axes.collections[0]
    corners = mesh.get_coordinates()
    x, y = corners[0, :, 0], corners[:, 0, 1]
    found = numpy.reshape(mesh.get_array(), (len(y) - 1, len(x) - 1))
    return found[numpy.searchsorted(y, places[:, 1]) - 1, numpy.searchsorted(x, places[:, 0]) - 1]


def check_zone():
    """Each phase must have the colour of its growth, also at the edge that closes the zone; the fastest are circled."""
    for path in ("oblique-symbol.h5", "oblique-symbol.csv"):
        figure = pictures.symbol(path, "oblique-symbol.json")
        axes, = panels_of(figure)
        with h5py.File("oblique-symbol.h5") as file:
            beta, growth = file["symbol/beta"][:], file["symbol/growth"][:]
        close(colours_at(axes, wrapped(beta)), growth, f"{path}: colours are not the growth", 1e-12)
        edge = wrapped(beta)[:, 0] == 1
        check(edge.sum() == 4, "no phase at the edge: this tests nothing")
        close(colours_at(axes, wrapped(beta)[edge] * [-1, 1]), growth[edge], f"{path}: the zone is not closed", 1e-12)
        mesh = axes.collections[0]
        check(mesh.norm.vmin == 1 and mesh.norm.vmax == growth.max(), f"scale {mesh.norm.vmin} to {mesh.norm.vmax}")
        top = wrapped(beta)[growth > growth.max() - 1e-7 * (growth.max() - 1)]
        circles = set(map(tuple, numpy.transpose(line(figure, "fastest"))))
        check(set(map(tuple, top)) <= circles and len(circles) < len(growth) / 2, f"{path}: circles at {circles}")
        first = wrapped(numpy.array(loaded("oblique-symbol.json")["symbol"]["beta_at_max"]))
        title = figure._suptitle.get_text()
        words = f"growth per step {growth.max():.9g}, circled:\nβ = ({first[0]:.4g}, {first[1]:.4g}) π, waves of "
        check(words in title and f"{2 / numpy.hypot(*first):.4g} cells" in title, f"{path}: {title}")


def check_damped():
    """Where the closed form leaves out the null space of P2G, it must stand beside the symbol, in blue where it damps."""
    figure = pictures.symbol("damped-symbol.h5")
    whole, seen = panels_of(figure)
    with h5py.File("damped-symbol.h5") as file:
        beta, growth, corrected = (file[f"symbol/{name}"][:] for name in ("beta", "growth", "corrected"))
    close(colours_at(whole, wrapped(beta)), growth, "the symbol's panel")
    close(colours_at(seen, wrapped(beta)), corrected, "the panel of the closed form")
    mesh = seen.collections[0]
    least = corrected.min()
    check(least < 0.9 and abs(mesh.norm.vmin - least) < 1e-14 and mesh.norm.vmax == 1, "a scale without 1")
    red, green, blue = mesh.cmap(mesh.norm(0.75 * corrected.min() + 0.25))[:3]
    check(blue > red + 0.2, f"damping is drawn in {red, green, blue}")
    check(numpy.ptp(mesh.cmap(mesh.norm(1.0))[:3]) < 0.01, "1 is not grey")
    check("no wave grows by more than 1e-06" in figure._suptitle.get_text(), figure._suptitle.get_text())


def check_planes():
    """In three dimensions planes of the third phase are drawn: 0, pi/2, pi and that of the fastest wave."""
    for name, titles in (("box", ["0", "π/2", "π"]), ("gas", ["0", "0.3333 π", "0.6667 π", "π"])):
        with h5py.File(f"{name}-symbol.h5") as file:
            beta, growth = wrapped(file["symbol/beta"][:]), file["symbol/growth"][:]
        panels = panels_of(pictures.symbol(f"{name}-symbol.h5"))
        drawn = [axes.get_title().removeprefix("$β_z$ = ") for axes in panels]
        check(set(drawn) <= set(titles) and {"0", "π"} <= set(drawn), f"{name}: planes {drawn}")
        for axes, title in zip(panels, drawn):
            third = {"0": 0, "π/2": 0.5, "π": 1}.get(title) if "." not in title else float(title.split()[0])
            here = abs(beta[:, 2] - third) < 1e-3
            close(colours_at(axes, beta[here]), growth[here], f"{name}: plane {title}", 1e-9)


def check_eigenvalues():
    """Discs stand at the phases of modes outside the null space of P2G, and at the opposite ones; their colours are the growth."""
    figure = pictures.symbol("turns.h5", "turns.json")
    discs, = [found for found in figure.axes[0].collections if found.get_gid() == "eigenvalues"]
    with h5py.File("turns.h5") as file:
        beta, values = wrapped(file["spectrum/beta"][:]), file["spectrum/eigenvalues"][:] @ [1, 1j]
        scene = attributes(file)
    check(period(scene) == 4, f"period {period(scene)}")
    growth, drawn = abs(values) ** 0.25, dict(zip(map(tuple, numpy.asarray(discs.get_offsets())), discs.get_array()))
    for place, value in zip(beta[~numpy.isnan(beta[:, 0])], growth[~numpy.isnan(beta[:, 0])]):
        for image in (place, wrapped(-numpy.pi * place)):
            check(drawn[tuple(image)] >= value - 1e-12, f"no disc of growth {value} at {image}")
    check(set(numpy.round(list(drawn.values()), 9)) <= set(numpy.round(growth, 9)), "discs of other growth")
    title = pictures.spectrum("turns.h5", "turns.json").axes[0].get_title()
    check(f"a period of 4 steps; growth {growth.max():.9g}" in title, title)


def arrows_of(axes):
    return [found for found in axes.collections if hasattr(found, "U")]


def check_arrows(axes, x, velocity, message):
    """Each arrow must be that of the particle whose place it has. Returns whether there are arrows."""
    at = {tuple(place): value for place, value in zip(numpy.round(x[:, :2], 9), velocity)}
    for arrows in arrows_of(axes):
        drawn = [at[tuple(numpy.round(place, 9))] for place in arrows.XY]
        close(numpy.transpose([arrows.U, arrows.V]), drawn, message)
    return bool(arrows_of(axes))


def check_mode(file, kept, x, axes):
    """Checks the real part of a mode on its axes. Returns whether there are arrows."""
    discs, title = axes.collections[0], axes.get_title()
    name, shown = discs.get_gid().removesuffix("_real").split("/")
    mode, beta = file["modes"][name], wrapped(file["spectrum/beta"][int(name) - 1])
    norms = {key[:-3]: numpy.hypot(numpy.linalg.norm(mode[key]), numpy.linalg.norm(mode[key.replace("_re", "_im")]))
             for key in mode if key.startswith("s_") and key.endswith("_re")}
    check(norms[shown] > 0.999 * max(norms.values()), f"{shown} is shown, of {norms}")
    close(discs.get_offsets(), x[kept][:, :2], "places of a mode")
    close(discs.get_array(), mode[f"{shown}_re"][:][kept], "colours of a mode")
    wave = "its P2G is 0" if numpy.isnan(beta).any() else f"β = ({', '.join(f'{b:.4g}' for b in beta)}) π"
    check(f"growth {mode.attrs['growth']:.9g}" in title and wave in title, title)
    velocity = numpy.transpose([mode["v_x_re"][:], mode["v_y_re"][:]])[kept]
    return check_arrows(axes, x[kept], velocity, "arrows of a mode")


def check_bars(figure, name):
    """The labels of colour bars that stand side by side must neither meet nor leave the picture."""
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw(renderer)
    bars = [axes.xaxis.label.get_window_extent(renderer) for axes in figure.axes if axes.get_label() == "<colorbar>"]
    check(all(one.x1 < other.x0 for one, other in zip(bars, bars[1:])), f"{name}: labels of colour bars meet")
    check(0 <= bars[0].x0 and bars[-1].x1 <= figure.bbox.x1, f"{name}: a label of a colour bar is cut off")


def check_modes():
    """Particles and arrows of a mode must be at the file's places, with the file's stress and velocity."""
    for name in ("turns", "box"):
        figure = modes(f"{name}.h5", 4)
        with h5py.File(f"{name}.h5") as file:
            scene, x = attributes(file), file["modes/coordinates"][:]
            x = x * scene["cells"][0]
            kept, where = layer_of(scene, x)
            check(kept.all() == (name == "turns") and ("z / h" in where) == (name == "box"), f"{name}: {where}")
            moving = [check_mode(file, kept, x, axes) for axes in panels_of(figure) if axes.get_title()]
            check(any(moving), f"{name}: no mode moves, so this tests nothing")
        check_bars(figure, name)
    check(" (norm of the mode 1)" in modes("fluid.h5", 1).axes[-1].get_xlabel(), "a fluid's pressure")


def check_large_strain():
    """At large strain too the velocities of the file are in the scene's units."""
    mpmstab(MPMSTAB, "run", "soft", "-cells", "4", "-steps", "2", "-amplitude", "1e-3", "-output", "soft.h5",
            "-output_every", "2")
    labels = [axes.get_xlabel() for axes in last_frame("soft.h5").axes if axes.get_label() == "<colorbar>"]
    check(labels == ["size of v (length / time)", "change of volume, det F - 1",
                     "shear, half the difference of the stretches"], f"{labels}")


def check_frames():
    """A shear wave: size of v, mean stress and shear by their formulas, arrows across it, one scale for all steps."""
    with h5py.File("shear-run.h5") as file:
        scene, steps = attributes(file), steps_of(file)
        draw = drawing_of("shear-run.h5", scene, steps)
        limits = []
        for step, group in steps:
            figure = draw(step, group)
            panels = panels_of(figure)
            at = {name: group[f"particles/{name}"][:] for name in group["particles"]}
            size = numpy.hypot(at["v_x"], at["v_y"])
            shear = numpy.hypot((at["s_xx"] - at["s_yy"]) / 2, at["s_xy"])
            grounds = [to_hex(axes.get_facecolor()) for axes in panels]
            check(grounds == ["#ffffff", "#d9d9d9", "#ffffff"], f"where the mean stress is 0 no particle is seen: {grounds}")
            for axes, values in zip(panels, (size, (at["s_xx"] + at["s_yy"]) / 2, shear)):
                close(axes.collections[0].get_array(), values, f"step {step}: {axes.collections[0].get_gid()}", 1e-12)
                close(axes.collections[0].get_offsets(), at["coordinates"][:, :2] * 6, f"step {step}: places", 1e-12)
            velocity = numpy.transpose([at["v_x"], at["v_y"]])
            check_arrows(panels[0], at["coordinates"] * 6, velocity, f"step {step}: arrows")
            limits.append([(axes.collections[0].norm.vmin, axes.collections[0].norm.vmax) for axes in panels])
            arrows, = arrows_of(panels[0])
            largest = numpy.hypot(arrows.U, arrows.V).max()
            check(100 < len(arrows.U) <= 20 * 11 and largest <= limits[-1][0][1], f"{len(arrows.U)} arrows to {largest}")
            check((abs(arrows.U + arrows.V) < 1e-9).all() or step, "the arrows are not across the wave")
            check(figure._suptitle.get_text().startswith(f"time step {step}, t = "), "no time")
    check(len(steps) > 2 and all(other == limits[0] for other in limits), f"scales differ: {limits}")
    labels = [axes.get_xlabel() for axes in figure.axes if axes.get_label() == "<colorbar>"]
    check(labels == ["size of v (length / time)", "mean of s_xx and s_yy (length / time)",
                     "largest shear of s (length / time)"], f"{labels}")
    names = pictures.frames("shear-run.h5", "shear-frames")
    check(len(names) == len(steps) + 1 and all(map(os.path.exists, names)), f"{names}")


def check_layer():
    """In three dimensions the middle layer of cells is drawn: the particles that lie there at that step."""
    for name, cells, middle, particles in (("box", 4, 2, 16), ("gas", 3, 3, 3 * 4 * 8)):
        with h5py.File(f"{name}-run.h5") as file:
            group = steps_of(file)[-1][1]
            at = {key: group[f"particles/{key}"][:] for key in group["particles"]}
        x = at["coordinates"] * cells
        kept = (x[:, 2] >= middle) & (x[:, 2] < middle + 1)
        check(kept.sum() == particles, f"{name}: {kept.sum()} particles in the layer")
        figure = last_frame(f"{name}-run.h5")
        close(panels_of(figure)[0].collections[0].get_offsets(), x[kept][:, :2], f"{name}: another layer")
        check(f"{middle} ≤ z / h < {middle + 1}" in figure._suptitle.get_text(), f"{name}: the layer is not said")
        if name == "box":
            stress, in_layer = {key: at[f"s_{key}"] for key in ("xx", "yy", "zz", "xy", "xz", "yz")}, kept
    tensor = numpy.array([[stress["".join(sorted(a + b))] for a in "xyz"] for b in "xyz"])
    deviator = tensor - numpy.einsum("kkp,ij->ijp", tensor, numpy.eye(3)) / 3
    shear = numpy.sqrt((deviator**2).sum(axis=(0, 1)) / 2)
    close(panels_of(last_frame("box-run.h5"))[2].collections[0].get_array(), shear[in_layer], "root of J2", 1e-12)


def check_map():
    """A map over Poisson's ratio and the angle of the drift must name its axes, not the ratio under the picture."""
    mpmstab(MPMSTAB, "map", "poisson", "-cells", "4", "-map_axes", "poisson,drift_angle", "-map_points", "3,3",
            "-output", "poisson.h5", "-json", "poisson.json", "-csv", "poisson.csv")
    figure = pictures.growth_map("poisson.h5", "poisson.json", "poisson.csv")
    axes, words = figure.axes[0], figure._supxlabel.get_text()
    check((axes.get_xlabel(), axes.get_ylabel()) == ("direction of the drift (degrees from x)", "Poisson's ratio ν"),
          f"{axes.get_xlabel()}, {axes.get_ylabel()}")
    check("ν" not in words and "drift of 0.125 cells per step, turned" in words, words)
    with h5py.File("poisson.h5") as file:
        growth = file["map/growth"][:]
    mesh = axes.collections[0].get_array().reshape(3, 3)
    close(mesh[growth > 1 + 1e-6], growth[growth > 1 + 1e-6] - 1, "colours of a map over Poisson's ratio")


def check_words():
    """A scene must be described alike by HDF5 and JSON, and what differs in one direction must be seen."""
    with h5py.File("oblique-symbol.h5") as file:
        scene = attributes(file)
    result = loaded("oblique-symbol.json")
    require_same("h5", scene, "json", result)
    for key, value in (("cells", [8, 5]), ("ppc", [2, 3]), ("drift", [0.125, 0.125]), ("offset", [0.5, 0.25])):
        try:
            require_same("h5", scene, "json", {**result, key: value})
        except Exception as refusal:
            check("of different scenes" in str(refusal), f"{key}: {refusal}")
        else:
            check(False, f"{key} {value} counts as the same scene")
    labels = pictures.growth(["gas-run.json", "shear-run.json"]).axes[0].get_legend_handles_labels()[1]
    check("ν" not in labels[0] and "usl, ν = 0.3" in labels[1], f"runs with and without a ratio: {labels}")
    check_written("symbol", ("gas2, quadratic basis, flip, k = 0.5, drift 1/8,1/6 (cells per step)",
                             "8 x 4 cells, 2 x 2 particles a cell, offset 0.5, ends periodic"), "oblique-symbol.h5")


def check_refusals():
    shutil.copy("oblique-symbol.h5", "lost.h5")
    with h5py.File("lost.h5", "r+") as file:
        del file.attrs["cells_y"]
    shutil.copy("oblique-symbol.h5", "gap.h5")
    with h5py.File("gap.h5", "r+") as file:
        for name in ("beta", "growth", "published", "corrected", "factors"):
            values = file[f"symbol/{name}"][:-1]
            del file[f"symbol/{name}"]
            file[f"symbol/{name}"] = values
    result = loaded("shear-run.json")
    for name, changes in (("flat.json", {"cells": 12}), ("other.json", {"poisson": 0.25})):
        with open(name, "w", encoding="utf-8") as file:
            json.dump({**result, "task": "symbol", **changes}, file)
    for arguments, says in (
            (("spacetime", "shear-run.h5"), "is of 2 dimensions, where there is no picture of a field over place"),
            (("spacetime", "box-run.h5"), "is of 3 dimensions"), (("frames", "box-symbol.h5"), "no /step_... in it"),
            (("modes", "oblique-symbol.h5"), "no /modes in it"),
            (("symbol", "lost.h5"), "lost.h5: not 2 values of 'cells' in its attributes"),
            (("symbol", "gap.h5"), "gap.h5: 31 phases in it, which are no grid of 8 x 4"),
            (("symbol", "damped-symbol.h5", "flat.json"), "'cells' is not a list of 2, each a whole number"),
            (("symbol", "shear-run.h5", "other.json"), "no /symbol/beta in it"),
            (("symbol", "damped-symbol.h5", "oblique-symbol.json"), "of different scenes: usl and gas2")):
        check_refused(arguments, says)


def main():
    make()
    for one in (check_zone, check_damped, check_planes, check_eigenvalues, check_modes, check_large_strain, check_frames,
                check_layer, check_map, check_words, check_refusals):
        one()


if __name__ == "__main__":
    main()
