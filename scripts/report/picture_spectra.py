"""Draws eigenvalues and symbols. spectrum and symbol return the figure."""
import numpy

import picture_files as files
import picture_scenes as scenes
import picture_style as style
from picture_zone import zone


def published_factors(formulation, k, beta):
    """Returns the published amplification factors, two for each phase, or None for a formulation without any.

    gas1: G = 1 +- gamma, gas2: G = 1 + (gamma^2 +- sqrt(gamma^4 + 2 gamma^2)) / 2, both gamma = 2 i k sin beta;
    elastic: G = gamma +- sqrt(gamma^2 - 1), gamma = 1 - 2 k^2 sin^2(beta/2).
    """
    square = -4 * (k * numpy.sin(beta)) ** 2  # gamma^2 of the gas; its roots stay on one branch
    if formulation == "gas1":
        gamma = 2j * k * numpy.sin(beta)
        return numpy.array([1 + gamma, 1 - gamma])
    if formulation == "gas2":
        root = numpy.sqrt(square**2 + 2 * square + 0j)
        return 1 + numpy.array([square + root, square - root]) / 2
    if formulation == "elastic":
        gamma = 1 - 2 * (k * numpy.sin(beta / 2)) ** 2
        root = 1j * numpy.sqrt(1 - gamma**2 + 0j)
        return numpy.array([gamma + root, gamma - root])
    return None


def eigenvalues_of(file):
    return files.complex_pairs(files.array(file, "spectrum/eigenvalues", "spectrum -output", 2))[:, 0]


def growth_of(values, scene):
    """Returns the growth per step of eigenvalues of a period of steps."""
    return abs(values) ** (1 / scenes.period(scene))


def unit_circle(axes):
    angle = numpy.linspace(0, 2 * numpy.pi, 721)
    axes.plot(numpy.cos(angle), numpy.sin(angle), color=style.GREY, linewidth=1, label="unit circle")


def of_what(scene, result):
    """Says of how many steps the eigenvalues are, and how fast the largest grows."""
    steps = scenes.period(scene)
    one = "of one step" if steps == 1 else f"of a period of {steps} steps"
    return f"eigenvalues {one}; growth {result:.9g} per step"


def draw_symbol(figure, axes, file):
    """Draws the factors of all phases, coloured by phase; in more than one dimension by the length of its vector."""
    beta = files.array(file, "symbol/beta", "symbol -output")
    factors = files.complex_pairs(files.array(file, "symbol/factors", "symbol -output"))
    dim = 1 if beta.ndim == 1 else beta.shape[1]
    phase = numpy.hypot.reduce(numpy.minimum(beta, 2 * numpy.pi - beta).reshape(-1, dim), axis=1)
    points = axes.scatter(factors.real.ravel(), factors.imag.ravel(), c=numpy.repeat(phase, factors.shape[1]), s=16,
                          cmap="cividis", vmin=0, vmax=numpy.pi * dim**0.5, zorder=3,
                          label="symbol, over its phases")
    what = "phase β of the symbol" if dim == 1 else "length of the phase vector β"
    bar = figure.colorbar(points, ax=axes, shrink=0.75, label=f"{what} (radians per cell)")
    bar.set_ticks([part * numpy.pi for part, _ in style.PHASES], labels=[text for _, text in style.PHASES])


def draw_published(axes, file, scene):
    """Draws the published factors when the program says that their formula covers the scene."""
    beta = numpy.linspace(0, 2 * numpy.pi, 1441)
    covered = numpy.isfinite(files.array(file, "symbol/published", "symbol -output")).any()
    both = published_factors(scene["formulation"], float(scene["courant"]), beta) if covered else None
    for factors, label in zip(both if both is not None else [], ("published factors", None)):
        axes.plot(factors.real, factors.imag, label=label, gid="published", **style.COLUMNS["published"])
    return numpy.ravel(both if both is not None else [])


def look_at(axes, values):
    """Limits the axes to a square around the values. The unit circle may leave the picture."""
    middle = (values.real.max() + values.real.min()) / 2, (values.imag.max() + values.imag.min()) / 2
    half = max(numpy.ptp(values.real), numpy.ptp(values.imag), 0.1) * 0.56
    axes.set_xlim(middle[0] - half, middle[0] + half)
    axes.set_ylim(middle[1] - half, middle[1] + half)
    axes.set_aspect("equal", adjustable="box")


def spectrum(path, result_path=None):
    """Draws eigenvalues with the unit circle, the symbol's factors and the published prediction."""
    with files.open_hdf5(path) as file:
        scene, values = scenes.attributes(file), eigenvalues_of(file)
        growth = growth_of(values, scene).max()
        if result_path:
            result = scenes.result_beside(path, scene, result_path, "spectrum")
            growth = files.part(result, "growth", result_path, "spectrum -json")
        figure = style.new_figure(6, scenes.scene_text(scene))
        axes = figure.add_subplot()
        unit_circle(axes)
        published = numpy.zeros(0)
        if "symbol/factors" in file:
            published = draw_published(axes, file, scene)
            draw_symbol(figure, axes, file)
    axes.plot(values.real, values.imag, label="eigenvalues", zorder=4, gid="eigenvalues", **style.EIGENVALUES)
    axes.set_title(of_what(scene, growth))
    axes.set_xlabel("real part of the eigenvalue λ")
    axes.set_ylabel("imaginary part of λ")
    look_at(axes, numpy.concatenate((values, published)))
    axes.grid(True, alpha=0.3)
    style.legend_below(axes)
    return figure


def curves_of(path):
    """Returns beta, the columns by name, and the scene (None for a CSV, which does not say it).

    In one dimension beta goes from 0 to pi. In more it has a column for each direction, and all phases.
    """
    if path.endswith(".csv"):
        rows = files.read_csv(path, [], "symbol -csv")
        if not rows:
            files.refuse(path, "no rows in it", "a file that 'mpmstab symbol' has written")
        columns = {key: numpy.array([row[key] for row in rows]) for key in rows[0]}
        phases = [columns.pop(f"beta_{axis}") for axis in scenes.AXES if f"beta_{axis}" in columns]
        wanted = [*([] if phases else ["beta"]), "growth", "published", "corrected"]
        missing = [name for name in wanted if name not in columns]
        if missing:
            files.refuse(path, f"no column '{missing[0]}' in it", "a file that 'mpmstab symbol -csv' has written")
        columns["symbol"] = columns.pop("growth")
        return numpy.transpose(phases) if phases else columns.pop("beta"), columns, None
    with files.open_hdf5(path) as file:
        scene, beta = scenes.attributes(file), files.array(file, "symbol/beta", "symbol -output")
        half = slice(0, len(beta) // 2 + 1 if scenes.dimension(scene) == 1 else None)
        names = {"symbol": "growth", "published": "published", "corrected": "corrected"}
        if "symbol/growth_seen" in file:
            names["growth_seen"] = "growth_seen"
        columns = {key: files.array(file, f"symbol/{name}", "symbol -output")[half] for key, name in names.items()}
        if "symbol/factors" in file:
            factors = files.complex_pairs(files.array(file, "symbol/factors", "symbol -output"))[half]
            columns["factors"] = abs(factors) ** (1 / scenes.period(scene))
    if beta.shape[1:] != ((scenes.dimension(scene),) if scenes.dimension(scene) > 1 else ()):
        files.refuse(path, f"/symbol/beta has the shape {beta.shape}", "a file that 'mpmstab symbol' has written")
    return beta[half], columns, scene


def phase_axis(axes):
    axes.set_xlim(-0.05, numpy.pi + 0.05)
    axes.set_xticks([part * numpy.pi for part, _ in style.PHASES], labels=[text for _, text in style.PHASES])
    axes.set_xlabel("phase β (radians per cell)")
    axes.grid(True, alpha=0.3)


def symbol(path, result_path=None, spectrum_path=None):
    """Draws abs(G) per step over the phase: published, corrected, symbol, eigenvalues and measured growth.

    In more than one dimension it is a coloured map over the phases.
    """
    beta, columns, scene = curves_of(path)
    result = scenes.result_beside(path, scene, result_path, "symbol", "spectrum", "run") if result_path else None
    told = scene or result
    if not scene and result:
        require_curve(path, columns["symbol"], result_path, result)
    footer = scenes.scene_text(told) if told else "a CSV does not say of which scene"
    with_spectrum = spectrum_path or (None if path.endswith(".csv") else path)
    eigenvalues = by_phase(with_spectrum, (path if told is scene else result_path, told),
                           bool(spectrum_path)) if with_spectrum else None
    measured = (result or {}).get("run", {}).get("growth_measured")
    if beta.ndim == 2:
        return zone(path, beta, columns, footer, float((scene or {}).get("tolerance", 1e-6)), eigenvalues, measured)
    return curve(beta, columns, footer, eigenvalues, measured)


def curve(beta, columns, footer, eigenvalues, measured):
    figure = style.new_figure(4.4, footer)
    axes = figure.add_subplot()
    if "factors" in columns:
        axes.plot(beta, columns["factors"][:, 0], ".", color="#56B4E9", markersize=3, label="symbol, every factor")
        axes.plot(beta, columns["factors"][:, 1:], ".", color="#56B4E9", markersize=3)
    for name in ("corrected", "published", "symbol"):
        if numpy.isfinite(columns[name]).any():
            label = "symbol, largest" if name == "symbol" else name
            axes.plot(beta, columns[name], label=label, gid=name, **style.COLUMNS[name])
    if "growth_seen" in columns:
        axes.plot(beta, columns["growth_seen"], label="symbol, nodal values", gid="growth_seen", color="#CC79A7",
                  linestyle=(0, (4, 2)), linewidth=1.8)
    if eigenvalues:
        axes.plot(*eigenvalues, label="eigenvalues", zorder=4, gid="eigenvalues",
                  **{**style.EIGENVALUES, "markersize": 4})
    if measured is not None:
        axes.axhline(measured, label=f"measured, {measured:.6f}", **style.COLUMNS["measured"])
    missing = [name for name in ("published", "corrected") if not numpy.isfinite(columns[name]).any()]
    axes.set_title("growth per step over the phase" + (f" (no {' or '.join(missing)} formula)" if missing else ""))
    axes.set_ylabel("growth per step |G|")
    axes.ticklabel_format(axis="y", useOffset=False)
    phase_axis(axes)
    style.legend_below(axes, columns=3)
    return figure


def require_curve(path, curve, result_path, result):
    """Refuses a CSV whose largest growth is not the symbol's in the JSON, since a CSV does not say its scene."""
    told, largest = result["predicted"].get("symbol"), numpy.nanmax(curve)
    if told is not None and abs(told - largest) > 1e-9 * told:
        files.refuse(f"{path} and {result_path}", f"of different scenes: largest growth {largest:.9g} and {told:.9g}",
                     "files of one scene")


def by_phase(path, told, required):
    """Returns the phases of eigenvalues, of their largest Fourier component on nodes, and their growth.

    Modes in the null space of P2G have no such component and are left out. told has the file that says the scene of
    the picture, and this scene (None when no file says it). None: the file has no spectrum, and none is required.
    """
    with files.open_hdf5(path) as file:
        if "spectrum" not in file and not required:
            return None
        scene = scenes.attributes(file)
        if told[1]:
            scenes.require_same(*told, path, scene)
        beta, values = files.array(file, "spectrum/beta", "spectrum -output"), eigenvalues_of(file)
    seen = numpy.isfinite(beta if beta.ndim == 1 else beta[:, 0])
    return beta[seen], growth_of(values, scene)[seen]
