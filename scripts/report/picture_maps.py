"""Draws maps over two axes, powers of the operator, and pseudospectra. Each public function returns the figure."""
import numpy
from matplotlib import colors, patheffects
from matplotlib.collections import LineCollection

import picture_boxes as boxes
import picture_files as files
import picture_scenes as scenes
import picture_spectra as spectra
import picture_style as style

MAP_LABELS = {"courant": "Courant number k = c dt / h", "drift": "drift U0 dt / h (cells per step)",
              "offset": "offset of the first particle (particle spacings)", "ppc": "particles per cell, ppc",
              "poisson": "Poisson's ratio ν", "drift_angle": "direction of the drift (degrees from x)",
              "mach": "velocity U0 / c"}


def transient(path):
    """Draws norm(A^n) over n beside the powers of the growth per step."""
    result = files.read_json(path)
    found = files.part(result, "transient", path, "spectrum -powers N -json")
    steps, norm = numpy.array(found["steps"]), numpy.array(found["norm"], float)  # null is NaN: beyond doubles
    growth = files.part(result, "growth", path, "spectrum -json")
    figure = style.new_figure(4.2, scenes.scene_text(result))
    axes = figure.add_subplot()
    axes.plot(steps, norm, "o-", color=style.COLOURS[1], markersize=3, label="$||A^n||$, its largest singular value",
              gid="norm")
    with numpy.errstate(over="ignore"):
        axes.plot(steps, float(growth) ** steps, color=style.COLOURS[0], linestyle="--", gid="rho",
                  label=f"$\\rho^n$, $\\rho$ = {growth:.9g} per step")
    if found["largest"] is not None:
        axes.plot([found["at_step"]], [found["largest"]], "D", color="black", markersize=7, markerfacecolor="none",
                  label=f"largest: {found['largest']:.4g} at step {found['at_step']}")
    axes.set_yscale("log")
    style.plain_powers(axes.yaxis)
    axes.set_title("norm of the powers of the operator A: how large a state can become")
    axes.set_xlabel("time step n")
    axes.set_ylabel("norm of the n-th power, $||A^n||$")
    axes.grid(True, alpha=0.3)
    style.legend_below(axes)
    return figure


def kreiss_on(real, imaginary, sigma):
    """Returns the largest (abs z - 1) / sigma_min outside the unit circle, and the z that has it."""
    z = real[None, :] + 1j * imaginary[:, None]
    with numpy.errstate(divide="ignore", invalid="ignore"):
        ratio = numpy.where(abs(z) > 1, (abs(z) - 1) / sigma, -numpy.inf)
    at = z.ravel()[numpy.argmax(ratio)]
    return float(ratio.max()), at


def pseudospectrum(path, result_path=None):
    """Draws contours of log10 of the smallest singular value of z - A, eigenvalues, unit circle and Kreiss point."""
    with files.open_hdf5(path) as file:
        scene, values = scenes.attributes(file), spectra.eigenvalues_of(file)
        real, imaginary, sigma = (files.array(file, f"pseudospectrum/{name}", "spectrum -pseudospectrum P -output")
                                  for name in ("re", "im", "sigma"))
    kreiss, at = kreiss_on(real, imaginary, sigma)
    if result_path:
        result = scenes.result_beside(path, scene, result_path, "spectrum")
        found = files.part(result, "pseudospectrum", result_path, "spectrum -pseudospectrum P -json")
        kreiss, at = found["kreiss"], complex(*found["kreiss_at"]) if found["kreiss_at"] else None
    floor = sigma[sigma > 0].min() if (sigma > 0).any() else 1e-16
    figure = style.new_figure(5.8, scenes.scene_text(scene))
    axes = figure.add_subplot()
    filled = axes.contourf(real, imaginary, numpy.log10(numpy.maximum(sigma, floor)), levels=12, cmap="cividis")
    lines = axes.contour(filled, colors="white", linewidths=0.6, linestyles="solid")
    bar = figure.colorbar(filled, ax=axes, label="log10 of σ", shrink=0.85)
    bar.add_lines(lines)
    bar.set_ticks(filled.levels, labels=[f"{level:.4g}" for level in filled.levels])
    spectra.unit_circle(axes)
    axes.lines[-1].set(color="white", linewidth=1.5)
    inside = (values.real >= real[0]) & (values.real <= real[-1]) & (abs(values.imag) <= imaginary[-1])
    axes.plot(values.real[inside], values.imag[inside], "o", color="black", markerfacecolor="#E69F00", markersize=5,
              label="eigenvalues", gid="eigenvalues")
    if at is not None:
        axes.plot(at.real, at.imag, "D", color="black", markerfacecolor="#56B4E9", markersize=9, gid="kreiss",
                  label=f"Kreiss point: (|z| − 1) / σ = {kreiss:.4g}")
    else:
        axes.plot([], [], " ", label="no Kreiss point: " + ("an eigenvalue is outside the circle, so it is infinite"
                                                            if kreiss is None else "nothing above 1 was found"))
    axes.set_title("pseudospectrum: σ, the smallest singular value of z − A, over the plane of z\n"
                   "(some $||A^n||$ is at least (|z| − 1) / σ, for every z outside the circle)")
    axes.set_xlabel("real part of z")
    axes.set_ylabel("imaginary part of z")
    axes.set_aspect("equal", adjustable="box")
    style.legend_below(axes, columns=1, facecolor="#dddddd")
    return figure


def growth_map(path, result_path=None, csv_path=None):
    """Draws growth - 1 over two axes, in colours on a log scale where it is unstable and plain where it is stable.

    The axes are those of the map that the program prints: the first points up, the second to the right. The JSON of the
    same map adds the limits at rest and the number of unstable points, the CSV the undecided points.
    """
    with files.open_hdf5(path) as file:
        scene = scenes.attributes_or_code(file)
        result = scenes.result_beside(path, scene, result_path, "map") if result_path else None
        growth = files.array(file, "map/growth", "map -output")
        names = axes_of_map(file, growth.shape, result, result_path)
        first, second = (files.array(file, f"map/{name}", "map -output") for name in names)
    if min(growth.shape) < 2:
        files.refuse(path, f"a map of {growth.shape[0]} x {growth.shape[1]} points", "at least 2 along each axis")
    tolerance = float(scene.get("tolerance", 1e-6))
    beyond = growth > 1 + tolerance
    found = (result or {}).get("map", {"unstable": int(beyond.sum())})
    figure = style.new_figure(5, map_footer(scene, names))
    axes = figure.add_subplot()
    axes.set_facecolor("#eeeeee")
    draw_growth(figure, axes, (first, second), growth, beyond)
    open_points = numpy.isnan(growth) | undecided_of(path, csv_path, names, (first, second))
    if open_points.any():
        at = numpy.argwhere(open_points)
        axes.plot(second[at[:, 1]], first[at[:, 0]], "x", color="black", markersize=4, label="undecided",
                  gid="undecided")
    draw_limits(axes, names, (first, second), found)
    waves = f", of {found['phases']} waves at each" if "phases" in found and not scenes.is_code(scene) else ""
    axes.set_title(f"unstable at {100 * found['unstable'] / growth.size:.1f}% of {growth.size} points{waves}\n"
                   f"(growth beyond 1 + {tolerance:g} per step)")
    for name, label in zip(names, (axes.set_ylabel, axes.set_xlabel)):
        label(label_of(name, names, scene))
    if axes.get_legend_handles_labels()[0]:
        style.legend_below(axes, columns=1)
    return figure


def label_of(name, names, scene):
    """Names an axis. With more than one dimension a drift is along the axes that the scene's has, or along all."""
    if scenes.is_code(scene):
        return f"{name} (units of the code)"
    if name not in ("drift", "mach") or scenes.dimension(scene) == 1:
        return MAP_LABELS.get(name, name)  # a parameter of a scheme as text has its own name
    if "drift_angle" in names:
        return "size of the drift (cells per step)"
    own = [axis for axis, drift in zip(scenes.AXES, scenes.each(scene, "drift")) if drift]
    along = f"along {' and '.join(own or scenes.AXES[:scenes.dimension(scene)])}"
    return f"velocity U0 / c {along}" if name == "mach" else f"drift U0 dt / h {along} (cells per step)"


def draw_growth(figure, axes, places, growth, beyond):
    """Draws the colours and the border between unstable and stable points."""
    y, x = (boxes.edges_of(values) for values in places)
    excess = numpy.ma.masked_where(~beyond, growth - 1)
    if excess.count():
        low, top = files.finite_range(numpy.asarray(excess.compressed()))
        top = max(top, 2 * low)
        excess = numpy.ma.minimum(excess, 2 * top)  # infinite means beyond the range of doubles
        mesh = axes.pcolormesh(x, y, excess, cmap="viridis", rasterized=True, norm=colors.LogNorm(low, top))
        style.plain_powers(figure.colorbar(mesh, ax=axes, label="growth per step |G| − 1 (grey: stable)").ax.yaxis)
    axes.add_collection(LineCollection(boxes.outline(x, y, beyond.T), colors="black", linewidths=0.9))
    axes.set_xlim(x[[0, -1]])
    axes.set_ylim(y[[0, -1]])


def undecided_of(path, csv_path, names, places):
    """Returns which points the CSV of a map calls undecided."""
    shape = (len(places[0]), len(places[1]))
    if not csv_path:
        return numpy.zeros(shape, bool)
    words = files.read_words(csv_path, "verdict", "map -csv")
    if len(words) != shape[0] * shape[1]:
        files.refuse(csv_path, f"{len(words)} points in it", f"the CSV of the same map, of {shape[0] * shape[1]}")
    for name, values in zip(names, numpy.meshgrid(*places, indexing="ij")):
        require_axis(path, values.ravel(), csv_path, name, files.read_words(csv_path, name, "map -csv"))
    return numpy.reshape([word == "undecided" for word in words], shape)


def require_axis(path, values, other_path, name, others):
    """Refuses two files of maps whose points along an axis are not the same."""
    if len(others) != len(values) or any(abs(float(other) - value) > 1e-9 for other, value in zip(others, values)):
        files.refuse(f"{path} and {other_path}", f"of different maps: {name} has other values", "files of one map")


def map_footer(scene, names):
    """Describes the scene without the two parameters that the axes sweep."""
    if scenes.is_code(scene):
        return scenes.code_text(scene)
    parts = scenes.scene_parts({**scene, "parameters": ""} if any(name not in MAP_LABELS for name in names) else scene)
    if scenes.dimension(scene) > 1 and "ppc" in names:
        parts["cells"] += ", ppc the same in all directions"
    if "drift_angle" in names:
        size = float(numpy.hypot.reduce(scenes.each(scene, "drift")))
        parts["drift"] = f"drift of {size:.6g} cells per step, turned"
    shown = [text for key, text in parts.items()
             if key not in names and not (key == "layout" and "offset" in names)
             and not (key == "drift" and "mach" in names)]
    return scenes.wrapped(", ".join(shown[:4]), ", ".join(shown[4:]))


def axes_of_map(file, shape, result, result_path):
    """Returns the names of the two axes, in their order."""
    if result:
        found = files.part(result, "map", result_path, "map -json")
        for name, size in zip(found["axes"], shape):
            values = files.array(file, f"map/{name}", "map -output") if name in file["map"] else numpy.zeros(0)
            if len(values) != size:
                files.refuse(f"{file.filename} and {result_path}",
                             f"of different maps: the first has no axis {name} of {size} points", "files of one map")
            require_axis(file.filename, values, result_path, name, found[name])
        return found["axes"]
    sizes = {name: len(file["map"][name]) for name in file["map"] if file["map"][name].ndim == 1}
    orders = [(a, b) for a in sizes for b in sizes if a != b and (sizes[a], sizes[b]) == shape]
    if len(orders) != 1:
        files.refuse(file.filename, "which of its axes is the first cannot be told",
                     "the JSON of the same 'mpmstab map' as a second file")
    return orders[0]


def draw_limits(axes, names, values, found):
    """Draws the largest stable Courant numbers at rest: the published one, and the corrected over the other axis."""
    if "courant" not in names:
        return
    at = list(names).index("courant")
    look = {"path_effects": [patheffects.withStroke(linewidth=4, foreground="white")]}
    published = found.get("published_limit")
    if published is not None:
        inside = values[at].min() <= published <= values[at].max()
        label = f"published limit at rest: k = {published:.6g}" + ("" if inside else " (beyond the axis)")
        line = (axes.axhline, axes.axvline)[at] if inside else (lambda _, **options: axes.plot([], [], **options))
        line(published, label=label, gid="published", **style.COLUMNS["published"], **look)
    corrected = numpy.array(found.get("corrected_limit", []), float)
    if corrected.shape == values[1 - at].shape and numpy.isfinite(corrected).any():
        outside = (corrected < values[at].min()) | (corrected > values[at].max())
        beyond = " (beyond the axis)" if outside[numpy.isfinite(corrected)].all() else ""
        label = f": k = {numpy.nanmax(corrected):.6g}, at rest only" if numpy.isfinite(corrected).sum() == 1 else ""
        corrected[outside] = numpy.nan
        points = (values[1 - at], corrected) if at == 0 else (corrected, values[1 - at])
        marked = {**style.COLUMNS["corrected"], "marker": "D" if label else None}
        axes.plot(*points, label=f"corrected limit{label}{beyond}", gid="corrected", clip_on=False, **marked, **look)
