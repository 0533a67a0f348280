"""Draws abs(G) over the Brillouin zone, the phases of waves in two or three dimensions. zone() returns the figure."""
import itertools

import numpy
from matplotlib import colors
from matplotlib.collections import LineCollection

import picture_boxes as boxes
import picture_files as files
import picture_style as style

BELOW, ONE, ABOVE = ["#053061", "#2166AC", "#92C5DE"], "#DDDDDD", ["#FDDBC7", "#D6604D", "#67001F"]
SAME = 1e-6  # growth within this part of the largest excess is called as large
PARTS = {0: "0", 0.5: "π/2", 1: "π", -0.5: "-π/2"}


def wrapped(beta):
    """Returns phases / pi in (-1, 1], to 12 digits, so that equal ones are the same number."""
    part = numpy.round(numpy.asarray(beta) / numpy.pi, 12) % 2
    return numpy.where(part > 1, part - 2, part)


def on_grid(path, places, values):
    """Returns the phases / pi of each direction in order, and the values as an array over them, first direction first.

    The zone is closed: where there is the phase 1 there is also -1, with the same value.
    """
    axes = [numpy.unique(column) for column in places.T]
    shape = tuple(len(axis) for axis in axes)
    if len(places) != numpy.prod(shape) or min(shape) < 2:
        files.refuse(path, f"{len(places)} phases in it, which are no grid of {' x '.join(map(str, shape))}",
                     "a file that 'mpmstab symbol' has written, with 2 phases or more in each direction")
    grid = numpy.full(shape, numpy.nan)
    grid[tuple(numpy.searchsorted(axis, column) for axis, column in zip(axes, places.T))] = values
    for direction, axis in enumerate(axes):
        if axis[-1] == 1:
            axes[direction] = numpy.concatenate(([-1], axis))
            grid = numpy.concatenate((numpy.take(grid, [-1], direction), grid), axis=direction)
    return axes, grid


def in_words(wave):
    """Describes a wave by its phases / pi, its length and, in the plane, its direction."""
    size = float(numpy.hypot.reduce(wave))
    words = f"β = ({', '.join(f'{part:.4g}' for part in wave)}) π"
    if not size:
        return words
    words += f", waves of {2 / size:.4g} cells"
    return words + (f", {numpy.degrees(numpy.arctan2(wave[1], wave[0])):.3g}° from x" if len(wave) == 2 else "")


def colours_of(growth, tolerance):
    """Returns a norm and a colour map in which 1 is grey, larger growth red and smaller blue, where there is any."""
    low, high = files.finite_range(growth)
    damps, grows = low < 1 - tolerance, high > 1 + tolerance
    norm = colors.TwoSlopeNorm(1, low, high) if damps and grows else colors.Normalize(
        low if damps else 1, 1 if damps else max(high, 1 + tolerance))
    used = [*BELOW * damps, ONE, *ABOVE * (grows or not damps)]
    return {"norm": norm, "cmap": colors.LinearSegmentedColormap.from_list("growth", used)}


def largest_of(places, growth, tolerance):
    """Returns the waves / pi that grow fastest, in the order of the file; the program names the first."""
    top = numpy.nanmax(growth)
    return places[(growth >= top - SAME * (top - 1)) & (top > 1 + tolerance)]


def everywhere(waves):
    """Returns places / pi of waves in the closed zone: a phase of pi is at both of its edges."""
    images = [image for wave in waves
              for image in itertools.product(*([-1, 1] if part == 1 else [part] for part in wave))]
    return numpy.reshape(images, (-1, waves.shape[1]))


def planes_of(axes, fastest):
    """Returns the numbers of the planes that are drawn in three dimensions: 0, pi/2, pi, that of the fastest wave."""
    wanted = [0, 0.5, 1, *fastest[:1, 2]]
    return sorted({int(numpy.argmin(abs(axes[2] - part))) for part in wanted})


def panels_of(path, places, columns, fastest):
    """Returns what the panels show: title, the phases of two directions, growth over them, and the third phase.

    In two dimensions there is one panel, and one of the nodal values where these grow otherwise. In three dimensions there are planes of the third phase.
    """
    axes, grid = on_grid(path, places, columns["symbol"])
    if len(axes) == 3:
        return [(f"$β_z$ = {PARTS.get(axes[2][plane], f'{axes[2][plane]:.4g} π')}", axes[:2], grid[:, :, plane],
                 axes[2][plane]) for plane in planes_of(axes, fastest)]
    _, seen = on_grid(path, places, columns.get("growth_seen", columns["corrected"]))
    if not numpy.isfinite(seen).any() or numpy.nanmax(abs(seen - grid)) < SAME:
        return [("", axes, grid, None)]
    return [("all that particles hold", axes, grid, None), ("nodal values", axes, seen, None)]


def draw_plane(panel, axes, growth, look, tolerance):
    """Draws growth over two phases, and the border between waves that grow and waves that do not."""
    x, y = map(boxes.edges_of, axes)
    mesh = panel.pcolormesh(x, y, growth.T, **look, rasterized=True)
    beyond = numpy.nan_to_num(growth, nan=0) > 1 + tolerance
    panel.add_collection(LineCollection(boxes.outline(x, y, beyond), colors="black", linewidths=0.9))
    panel.set_box_aspect(1)
    for limit, ticks in ((panel.set_xlim, panel.set_xticks), (panel.set_ylim, panel.set_yticks)):
        limit(-1, 1)
        ticks([-1, -0.5, 0, 0.5, 1], labels=["-1", "-½", "0", "½", "1"])
    return mesh


def in_plane(places, third):
    """Returns the places of the closed zone that are on a panel."""
    images = everywhere(places)
    return images if third is None else images[images[:, 2] == third]


def draw_eigenvalues(panel, eigenvalues, third, look):
    """Draws the largest eigenvalue of each phase as a small disc in the colour of its growth.

    A mode of phase beta has a conjugate, or a partner with the same eigenvalue, of phase -beta.
    """
    found = {}
    for sign in (1, -1):
        for place, growth in zip(map(tuple, wrapped(sign * eigenvalues[0])), eigenvalues[1]):
            found[place] = max(found.get(place, 0), growth)
    drawn = [(*image[:2], growth) for place, growth in found.items()
             for image in in_plane(numpy.array([place]), third)]
    if drawn:
        x, y, growth = numpy.transpose(drawn)
        panel.scatter(x, y, c=growth, s=14, edgecolors="black", linewidths=0.5, clip_on=False, zorder=4, **look,
                      gid="eigenvalues")


def title_of(growth, fastest, tolerance, measured, with_eigenvalues):
    top = f"largest growth per step {numpy.nanmax(growth):.9g}"
    lines = [f"{top}, circled:", in_words(fastest[0])] if len(fastest) else [
        f"{top}: no wave grows by more than {tolerance:g}"]
    more = [] if measured is None else [f"measured growth {measured:.6f}"]
    more += ["discs: eigenvalues"] * with_eigenvalues
    return "\n".join([*lines, *([", ".join(more)] if more else [])])


def name_axes(panels, columns):
    for number, panel in enumerate(panels):
        if number % columns == 0:
            panel.set_ylabel("phase $β_y$ (π per cell)")
        if number + columns >= len(panels):
            panel.set_xlabel("phase $β_x$ (π per cell)")


def zone(path, beta, columns, footer, tolerance, eigenvalues=None, measured=None):
    """Draws the largest abs(G) per step over the phases; in three dimensions over planes of the third phase.

    beta is n x dim, columns has growth by the symbol and by the closed form, eigenvalues are their phases and growth.
    """
    places, growth = wrapped(beta), columns["symbol"]
    fastest = largest_of(places, growth, tolerance)
    shown = panels_of(path, places, columns, fastest)
    look = colours_of(numpy.concatenate([grid.ravel() for _, _, grid, _ in shown]), tolerance)
    across, down = min(2, len(shown)), -(-len(shown) // 2)
    figure = style.new_figure({1: 5.8, 2: 3.9}.get(len(shown), 1.2 + 2.6 * down), footer)
    panels = figure.subplots(down, across, squeeze=False).ravel()
    for panel, (title, axes, grid, third) in zip(panels, shown):
        mesh = draw_plane(panel, axes, grid, look, tolerance)
        panel.set_title(title)
        here = in_plane(fastest, third)
        if len(here):
            panel.plot(here[:, 0], here[:, 1], "o", color="black", markerfacecolor="none", markersize=9,
                       markeredgewidth=1.5, clip_on=False, gid="fastest", zorder=5)
        if eigenvalues:
            draw_eigenvalues(panel, eigenvalues, third, look)
    for panel in panels[len(shown):]:
        panel.axis("off")
    name_axes(panels[:len(shown)], across)
    bar = figure.colorbar(mesh, ax=panels, label="growth per step |G| (grey: 1)", shrink=0.9)
    if isinstance(look["norm"], colors.TwoSlopeNorm):
        ticks = [*numpy.linspace(look["norm"].vmin, 1, 4), *numpy.linspace(1, look["norm"].vmax, 4)[1:]]
        bar.set_ticks(ticks, labels=[f"{tick:.6g}" for tick in ticks])
    else:
        bar.ax.ticklabel_format(useOffset=False)
    figure.suptitle(title_of(growth, fastest, tolerance, measured, bool(eigenvalues)), fontsize=10.5)
    return figure
