#!/usr/bin/python3
"""A bar of hats for -program whose particles mpmstab chooses: program_scene.py [PERIOD]. Its grid has that period, or any.

It is one function, with volume and mass of each particle in its state; stiffness is 1.
"""
import sys

import numpy

from mpmstab.adapter import serve

grid = {}


def step(state, dt):
    h, period = grid["cell_width"], grid["periodic"][0]
    x, v, s, volume, mass = (state[name] for name in ("x", "v", "s", "volume", "mass"))
    cells = round(period / h) if period else 64
    cell = numpy.floor(x / h).astype(int)
    w, nodes = x / h - cell, numpy.zeros((3, cells))
    ends = [((cell + k) % cells, weight, slope / h) for k, weight, slope in ((0, 1 - w, -1), (1, w, 1))]
    for i, weight, slope in ends:
        for sums, values in zip(nodes, (weight * mass, weight * mass * v, -slope * volume * s)):
            numpy.add.at(sums, i, values)
    with numpy.errstate(all="ignore"):
        old, force = (numpy.where(nodes[0] > 0, of / nodes[0], 0) for of in nodes[1:])
    for i, weight, slope in ends:
        v += dt * weight * force[i]
        s += dt * slope * (old + dt * force)[i]
        x += dt * weight * (old + dt * force)[i]
    if period:
        x -= period * numpy.floor(x / period)


serve(step, {name: numpy.zeros(1) for name in ("x", "v", "s", "volume", "mass")}, cell_width=0.5, scenes=grid, parameters={"dt": 0.25},
      periodic=[float(word) for word in sys.argv[1:]] or None, name="bar",
      fields={"x": {"place": True}, "v": {"scale": 1}, "s": {"scale": 1}, "volume": {"volume": True}, "mass": {"mass": True}})
