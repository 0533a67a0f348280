"""A bar in Python, with a period of length 1: a step of MPM as it is in many codes (update stress last, hat functions)."""
import numpy

CELLS = 16
H, DT = 1 / CELLS, 0.5 / CELLS  # density and stiffness are 1, so that waves move half a cell a step


def start(amplitude):
    x = (numpy.arange(2 * CELLS) + 0.5) * H / 2
    return {"x": x, "v": amplitude * numpy.sin(2 * numpy.pi * x), "stress": numpy.zeros_like(x)}


def advance(state, dt=DT):
    """One step; it changes the arrays of the state."""
    x, v, stress = state["x"], state["v"], state["stress"]
    volume, cell, s = H / 2, numpy.floor(x / H), x / H - numpy.floor(x / H)
    left = cell.astype(int) % CELLS
    node, weight, slope = (left, (left + 1) % CELLS), (1 - s, s), (-1 / H, 1 / H)
    mass, momentum, force = numpy.zeros((3, CELLS))
    for i, w, g in zip(node, weight, slope):
        numpy.add.at(mass, i, w * volume)
        numpy.add.at(momentum, i, w * volume * v)
        numpy.add.at(force, i, -g * volume * stress)
    velocity = (momentum + dt * force) / mass
    for i, w, g in zip(node, weight, slope):
        v += dt * w * (force / mass)[i]
        stress += dt * g * velocity[i]
        x += dt * w * velocity[i]
    x -= numpy.floor(x)
