"""Finds the edges of coloured boxes on a grid of points, and the border of a region of them."""
import numpy


def edges_of(values):
    """Returns the middles between values, and an edge half a step beyond the first and the last."""
    middles = (values[1:] + values[:-1]) / 2
    return numpy.concatenate(([2 * values[0] - middles[0]], middles, [2 * values[-1] - middles[-1]]))


def outline(x, y, inside):
    """Returns the sides that boxes inside share with boxes outside; x and y are the edges of the boxes."""
    upright = [((x[i + 1], y[j]), (x[i + 1], y[j + 1])) for i, j in numpy.argwhere(inside[1:] != inside[:-1])]
    level = [((x[i], y[j + 1]), (x[i + 1], y[j + 1])) for i, j in numpy.argwhere(inside[:, 1:] != inside[:, :-1])]
    return upright + level
