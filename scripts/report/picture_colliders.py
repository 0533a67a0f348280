"""Draws the colliders of a run in the plane, where they are at a time."""
import json
import re

import numpy

import picture_plane as plane
import picture_scenes as scenes

FINENESS = 400  # points along the longer side


def colliders_of(scene):
    """Returns the blocks of the option colliders. Records cut a long text, of which nothing is drawn."""
    quoted = re.sub(r"[a-z_]{2,}", lambda word: f'"{word[0]}"', str(scene.get("colliders", "")))
    try:
        return json.loads(f"[{quoted}]")
    except ValueError:
        return []


def way_of(body, time):
    """Returns how far a body has moved: its velocity is linear between the times of its table."""
    velocity = body.get("velocity", 0)
    rows = velocity if isinstance(velocity, list) and isinstance(velocity[0], list) else [[0, *numpy.atleast_1d(velocity)]]
    times = [row[0] for row in rows]
    knots = sorted({0, time, *(at for at in times if at < time)})
    at = numpy.array([[numpy.interp(knot, times, [row[1 + a] for row in rows]) for knot in knots]
                      for a in range(len(rows[0]) - 1)])
    return ((at[:, 1:] + at[:, :-1]) / 2 * numpy.diff(knots)).sum(axis=1)


def around(body, x, start, axis):
    """Returns the places along and across an axis from a point on."""
    axis = numpy.array(axis) / numpy.linalg.norm(axis)
    q = x - numpy.array(start)
    along = q @ axis
    return along, numpy.linalg.norm(q - along[..., None] * axis, axis=-1)


def inside(body, x):
    """Returns which places are inside a body at its start."""
    shape = body["shape"]
    if shape == "plane":
        return (x - body["point"]) @ body["normal"] <= 0
    if shape == "sphere":
        return numpy.linalg.norm(x - body["center"], axis=-1) <= body["radius"]
    if shape == "box":
        return (abs(x - body["center"]) <= numpy.array(body["size"]) / 2).all(axis=-1)
    if shape == "cone":
        along, across = around(body, x, body["tip"], body["axis"])
        return across <= along * numpy.tan(numpy.radians(body["angle"]))
    axis = numpy.subtract(body["to"], body["from"])
    along, across = around(body, x, body["from"], axis)
    return (along >= 0) & (along <= numpy.linalg.norm(axis)) & (across <= body["radius"])


def draw(axes, scene, time):
    """Fills the colliders with grey; of a domain in space those of the layer of cells that is drawn."""
    cells = [int(count) for count in scenes.each(scene, "cells")]
    width = float(scenes.each(scene, "length")[0]) / cells[0]
    x, y = (numpy.linspace(0, count, 1 + FINENESS * count // max(cells[:2])) for count in cells[:2])
    place = numpy.stack(numpy.meshgrid(x, y), axis=-1) * width
    if len(cells) > 2:
        place = numpy.concatenate((place, numpy.full((*place.shape[:2], 1), (plane.layer_number(scene) + 0.5) * width)), axis=-1)
    for body in colliders_of(scene):
        solid = inside(body, place - way_of(body, time))
        if solid.any():
            axes.contourf(x, y, solid, levels=[0.5, 1.5], colors=["#808080"])
