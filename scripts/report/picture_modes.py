"""Draws eigenmodes. modes() returns the figure."""
import numpy

import picture_files as files
import picture_plane as plane
import picture_scenes as scenes
import picture_style as style
from picture_zone import in_words, wrapped

SAME = 1e-6  # eigenvalues that are nearer than this, and smaller shares of the null space, are not told apart


def idle(file, name):
    """Says whether a mode stays as it is and is at least in part in the null space of P2G, data that no node feels."""
    value = complex(file["modes"][name].attrs["re"], file["modes"][name].attrs["im"])
    return abs(value - 1) < SAME and share_of(file, name) > SAME


def share_of(file, name):
    """Returns the part of a mode's norm that is in the null space of P2G."""
    return float(numpy.ravel(files.array(file, "spectrum/null_share", "spectrum -output"))[int(name) - 1])


def that_move(file, names):
    """Returns the modes of a stable scene that are not idle, the largest growth first, of equal ones the longest wave."""
    beta = files.array(file, "spectrum/beta", "spectrum -output")
    size = numpy.hypot.reduce(abs(wrapped(beta)).reshape(len(beta), -1), axis=1)

    def order(name):
        return -round(float(file["modes"][name].attrs["growth"]) / SAME), numpy.nan_to_num(size[int(name) - 1], nan=9)

    return sorted((name for name in names if not idle(file, name)), key=order)


def leading_modes(file, scene, count, null_space):
    """Returns the names of the first modes, with one of each conjugate pair.

    In a stable scene idle modes are left out, unless null_space asks for them or there is no other: the eigenvalue 1 has
    many vectors, each any mixture of what no node feels.
    """
    if "modes" not in file:
        files.refuse(file.filename, "no /modes in it", "a file that 'mpmstab spectrum -output -modes n' has written")
    names = sorted(key for key in file["modes"] if key.isdigit())
    largest = max(float(file["modes"][name].attrs["growth"]) for name in names)
    if largest <= 1 + float(scene.get("tolerance", 1e-6)) and not null_space:
        names = that_move(file, names) or names
    chosen, pairs = [], []
    for name in names:
        value = complex(file["modes"][name].attrs["re"], file["modes"][name].attrs["im"])
        if value.imag and any(abs(value.conjugate() - other) <= 1e-9 * abs(value) for other in pairs):
            continue
        pairs.append(value)
        chosen.append(name)
    return chosen[:count]


def title_of_mode(file, name):
    """Returns growth, eigenvalue and wave of a mode, in words."""
    group = file["modes"][name]
    real, imaginary = float(group.attrs["re"]), float(group.attrs["im"])
    value = f"{real:.4g}" + (f" {'-' if imaginary < 0 else '+'} {abs(imaginary):.4g}i" if abs(imaginary) > 1e-7 else "")
    beta = files.array(file, "spectrum/beta", "spectrum -output")[int(name) - 1]
    if numpy.isnan(beta).any():
        wave = "its P2G is 0"
    else:
        wave = in_words(wrapped(beta)).replace(" π, ", " π\n") if beta.shape else f"β = {beta:.4g} radians per cell"
    share = share_of(file, name)
    null = f"\n{100 * share:.3g}% in the null space of P2G" if share > 0.5 else ""
    return f"mode {int(name)}\ngrowth {group.attrs['growth']:.9g}\neigenvalue {value}\n{wave}{null}"


def share_axes(grid):
    """Gives all axes one scale, with numbers at the left and the lower edge only."""
    for axes in grid.ravel()[1:]:
        axes.sharex(grid[0, 0])
        axes.sharey(grid[0, 0])
    for axes in grid[:-1].ravel():
        axes.tick_params(labelbottom=False)
    for axes in grid[:, 1:].ravel():
        axes.tick_params(labelleft=False)


def modes(path, count=2, null_space=False):
    """Draws the leading eigenmodes over their particles' places, a column for each, real and imaginary part."""
    with files.open_hdf5(path) as file:
        scene = scenes.attributes(file)
        names = leading_modes(file, scene, count, null_space)
        return (curves if scenes.dimension(scene) == 1 else planes)(file, scene, names)


def curves(file, scene, names):
    """Draws modes over x, with a row for each field."""
    x = files.array(file, "modes/coordinates", "spectrum -output") / float(scene["length"])
    order = numpy.argsort(x, kind="stable")
    fields = sorted((key[:-3] for key in file["modes"][names[0]] if key.endswith("_re")), key="uvrwsc".find)
    figure = style.new_figure(2.1 + 1.6 * len(fields), scenes.scene_text(scene), width=1 + 2.7 * max(2, len(names)))
    rows = figure.add_gridspec(len(fields) + 1, len(names), height_ratios=[1] * len(fields) + [0.12])
    grid = numpy.array([[figure.add_subplot(rows[row, column]) for column in range(len(names))]
                        for row in range(len(fields))])
    share_axes(grid)
    for column, name in enumerate(names):
        group = file["modes"][name]
        grid[0, column].set_title(title_of_mode(file, name), fontsize=9.5)
        for row, field in enumerate(fields):
            for what, look in (("re", "o-"), ("im", "s--")):
                colour = style.COLOURS[1 if what == "re" else 0]
                values = files.array(group, f"{field}_{what}", "spectrum -output -modes n")[order]
                grid[row, column].plot(x[order], values, look, color=colour, linewidth=1, markersize=2.2,
                                       gid=f"{name}/{field}_{what}",
                                       label={"re": "real part", "im": "imaginary part"}[what])
            grid[row, column].grid(True, alpha=0.3)
            grid[row, column].set_xlim(0, 1)
    for row, field in enumerate(fields):
        grid[row, 0].set_ylabel(f"{scenes.quantity(scene, field, None)}\n(norm of the mode 1)")
    for axes in grid[-1]:
        axes.set_xlabel("place x / L")
    below = figure.add_subplot(rows[-1, :])
    below.axis("off")
    below.legend(*grid[0, 0].get_legend_handles_labels(), loc="center", ncol=2)
    return figure


def state_of(group):
    """Returns the registers of a mode by name, complex."""
    made = "spectrum -output -modes n"
    names = sorted(key[:-3] for key in group if key.endswith("_re"))
    return {name: files.array(group, f"{name}_re", made) + 1j * files.array(group, f"{name}_im", made)
            for name in names}


def coloured(state):
    """Returns the register that colours show: the largest but those of the vector and the affine part."""
    vector = plane.vector_of(state)
    names = [name for name in state if name not in vector and not name.startswith("c")]
    return max(names, key=lambda name: numpy.linalg.norm(state[name]))


def largest_of(state, names):
    """Returns the largest real or imaginary part of these registers; 0 without any."""
    return max((abs(part).max() for name in names for part in (state[name].real, state[name].imag)), default=0.0)


def planes(file, scene, names):
    """Draws modes in the plane, or in a layer of cells: a stress or pressure in colours, the velocity as arrows.

    The rows are real and imaginary part; without a pair of complex eigenvalues there is no second.
    """
    cells = [int(count) for count in scenes.each(scene, "cells")]
    x = files.array(file, "modes/coordinates", "spectrum -output")
    x = x * cells[0] / float(scenes.each(scene, "length")[0])
    kept, where = plane.layer_of(scene, x)
    states = [state_of(file["modes"][name]) for name in names]
    parts = ["real", "imaginary"][:1 + any(value.imag.any() for state in states for value in state.values())]
    figure = style.new_figure(2.8 + 3.1 * len(parts) * min(1.5, cells[1] / cells[0]), scenes.scene_text(scene),
                              width=max(6.4, 0.4 + 3.4 * len(names)))
    grid = figure.subplots(len(parts), len(names), squeeze=False)
    for column, (name, state) in enumerate(zip(names, states)):
        shown, vector = coloured(state), plane.vector_of(state)
        sizes = plane.with_floor([largest_of(state, [shown]), largest_of(state, vector)])
        moves = sizes[1] == largest_of(state, vector)
        for axes, part in zip(grid[:, column], parts):
            values = {key: (value.real if part == "real" else value.imag)[kept] for key, value in state.items()}
            discs = plane.draw_particles(axes, scene, x[kept], values[shown], plane.colours_of(sizes[0], True),
                                         f"{name}/{shown}_{part}")
            if moves:
                plane.draw_arrows(axes, scene, x[kept], [values[one] for one in vector[:2]], sizes[1],
                                  f"{name}/{vector[0][0]}_{part}")
            plane.frame_axes(axes, scene)
            axes.set_ylabel(f"{part} part, place y / h" if not column else "")
        for axes in grid[:-1, column]:
            axes.set_xlabel("")
        grid[0, column].set_title(title_of_mode(file, name), fontsize=9.5)
        arrows = f"\narrows: {vector[0][0]}, up to {sizes[1]:.3g}" if moves else ""
        plane.add_bar(figure, discs, list(grid[:, column]), f"{shown} (norm of the mode 1){arrows}")
    if where:
        figure.suptitle(where.lstrip(", "), fontsize=9.5)
    return style.settle(figure)
