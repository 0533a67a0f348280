"""Draws particles in the plane: fields as colours, vectors as arrows. In three dimensions it is one layer of cells."""
import math

import numpy
from matplotlib import colors
from matplotlib.collections import EllipseCollection
from matplotlib.ticker import FuncFormatter, MaxNLocator, MultipleLocator

import picture_scenes as scenes

SIGNED = "RdBu_r"  # the colours of values of both signs
MOST_ARROWS = 20  # along the longer side
MOST_LINES = 32  # of the grid
FAINT = 1e-9  # values below this part of the largest of all fields are rounding errors, and are shown as 0
MOST_DRAWN = 2000  # more particles than this are drawn as dots in an SVG, not one by one


def vector_of(names):
    """Returns the components of the vector among the registers, such as v_x and v_y; () when there is none."""
    return tuple(f"{stem}_{axis}" for stem in "vu" for axis in scenes.AXES if f"{stem}_{axis}" in names)


def stress_of(names):
    """Returns the components of the stress by the two letters of their axes; {} when it is a pressure, or none."""
    return {name[2:]: name for name in names if name.startswith("s_")}


def unit_of(names):
    """Returns the unit of the fields. Those of the wave equation are lengths, others are velocities in any scheme."""
    return "length / time" if vector_of(names) else "length"


class Panel:
    """What one panel shows: a label, whether the values have a sign, and values(registers), an array.

    A pure number has no unit, and other values have that of the velocity.
    """

    def __init__(self, label, signed, values, vector=(), pure=False):
        self.label, self.signed, self.values, self.vector, self.pure = label, signed, values, vector, pure

    def text(self, registers):
        return self.label if self.pure else f"{self.label} ({unit_of(registers)})"


def size_of(registers):
    return numpy.hypot.reduce(numpy.array(registers))


def invariants_of(stress):
    """Returns the panels of the mean stress and of the largest shear, which do not depend on the directions of axes."""
    dim = 2 if "zz" not in stress else 3
    normal = [stress[2 * axis] for axis in scenes.AXES[:dim]]

    def mean(found):
        return sum(found[name] for name in normal) / dim

    def shear(found):
        """Half the difference of the principal stresses in the plane, in space the root of J2."""
        square = sum((found[name] - mean(found)) ** 2 for name in normal) / 2
        return numpy.sqrt(square + sum(found[name] ** 2 for axes, name in stress.items() if axes[0] != axes[1]))

    label = "largest shear of s" if dim == 2 else "shear of s, root of J2"
    return [Panel(f"mean of {' and '.join(normal) if dim == 2 else 's_xx, s_yy, s_zz'}", True, mean),
            Panel(label, False, shear)]


def stretches_of(names):
    """Returns the panels of the deformation gradient F, which do not depend on the directions of axes."""
    components = sorted(name for name in names if name.startswith("f_"))
    dim = math.isqrt(len(components))

    def matrices(found):
        return numpy.array([found[name] for name in components]).T.reshape(-1, dim, dim)

    def shear(found):
        stretch = numpy.linalg.svd(matrices(found), compute_uv=False)
        return (stretch[:, 0] - stretch[:, -1]) / 2

    return [Panel("change of volume, det F - 1", True, lambda found: numpy.linalg.det(matrices(found)) - 1, pure=True),
            Panel("shear, half the difference of the stretches", False, shear, pure=True)] if components else []


def panels_of(names):
    """Returns the panels of a run with these registers: the vector's size with arrows, then the other fields.

    A stress is shown by its mean and its shear, and F by volume and shear. The affine part is left out.
    """
    vector, stress = vector_of(names), stress_of(names)
    found = [Panel(f"size of {vector[0][0]}", False, lambda all_: size_of([all_[name] for name in vector]),
                   vector)] if vector else []
    internal = any(name.startswith("f_") for name in names)  # beside F the others are internal variables, without a unit
    found += [Panel(name, not internal, lambda all_, name=name: all_[name], pure=internal) for name in names
              if name not in vector and name not in stress.values() and not name.startswith(("c", "f_"))]
    return found + (invariants_of(stress) if stress else []) + stretches_of(names)


def with_floor(sizes):
    """Returns the largest values of panels, none below what is worth showing."""
    return [max(size, FAINT * max(sizes)) or 1.0 for size in sizes]


def layer_number(scene):
    """Returns the layer of cells that is drawn: the one at a plane of symmetry, else the middle one."""
    ends = scene["boundary"].split(",")
    return 0 if ends[-1].startswith("symmetry") else int(scenes.each(scene, "cells")[2]) // 2


def layer_of(scene, x):
    """Returns which particles are drawn, and says so: all in the plane, in space those of a layer of cells."""
    if scenes.dimension(scene) == 2:
        return numpy.ones(len(x), bool), ""
    layer = layer_number(scene)
    return numpy.floor(x[:, 2]) == layer, f", particles with {layer} ≤ z / h < {layer + 1}"


def thinned(scene, x):
    """Returns particles for arrows, in each of so many boxes the one nearest its middle, and the width of a box.

    A box is at least as wide as the part of a cell that a particle fills.
    """
    box = max(max(scenes.each(scene, "cells")[:2]) / MOST_ARROWS, 1 / min(scenes.each(scene, "ppc")[:2]))
    number = numpy.floor(x[:, :2] / box).astype(int)
    far = numpy.hypot.reduce(x[:, :2] / box - number - 0.5, axis=1)
    order = numpy.lexsort((far, number[:, 1], number[:, 0]))
    first = numpy.ones(len(order), bool)
    first[1:] = (numpy.diff(number[order], axis=0) != 0).any(axis=1)
    return order[first], box


def add_bar(figure, discs, axes, label, location="bottom"):
    bar = figure.colorbar(discs, ax=axes, label=label, shrink=0.8, location=location)
    bar.locator, bar.formatter = MaxNLocator(5), FuncFormatter(lambda value, _: f"{value:.3g}")
    bar.update_ticks()


def colours_of(largest, signed):
    """Returns the norm and the colours of values up to the largest."""
    norm = colors.Normalize(-largest if signed else 0, largest)
    return {"norm": norm, "cmap": SIGNED if signed else "viridis"}


def draw_particles(axes, scene, x, values, look, gid):
    """Draws particles as ellipses that nearly fill their part of a cell, on grey where white is a value."""
    if look["cmap"] == SIGNED:
        axes.set_facecolor("#d9d9d9")
    width, height = (0.9 / int(count) for count in scenes.each(scene, "ppc")[:2])
    discs = EllipseCollection(numpy.full(len(x), width), numpy.full(len(x), height), numpy.zeros(len(x)), units="xy",
                              offsets=x[:, :2], offset_transform=axes.transData, array=values, linewidths=0, gid=gid,
                              rasterized=len(x) > MOST_DRAWN, **look)
    axes.add_collection(discs)
    return discs


def draw_arrows(axes, scene, x, vector, largest, gid):
    """Draws arrows of which the largest is nearly as long as a box is wide."""
    kept, box = thinned(scene, x)
    axes.quiver(x[kept, 0], x[kept, 1], vector[0][kept], vector[1][kept], angles="xy", scale_units="xy",
                scale=largest / (0.9 * box), pivot="mid", width=0.004, color="black", gid=gid, zorder=3)


def frame_axes(axes, scene):
    """Gives axes in cells, with the lines of the grid where there are not too many."""
    cells = [int(count) for count in scenes.each(scene, "cells")[:2]]
    for axis, limit, count in zip((axes.xaxis, axes.yaxis), (axes.set_xlim, axes.set_ylim), cells):
        limit(0, count)
        axis.set_major_locator(MaxNLocator(5, integer=True))
        if max(cells) <= MOST_LINES:
            axis.set_minor_locator(MultipleLocator(1))
            axis.grid(True, which="both", color="#cccccc", linewidth=0.5)
    axes.set_box_aspect(cells[1] / cells[0])
    axes.tick_params(which="minor", length=0)
    axes.set_xlabel("place x / h")
    axes.set_ylabel("place y / h")
