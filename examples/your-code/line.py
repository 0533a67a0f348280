#!/usr/bin/python3
"""A bar of particles in an empty line, update stress last, for 'mpmstab -program': protocol 1, with numpy alone."""
import json
import sys

import numpy as np

H, C, N = 0.01, 20.0, 24  # width of a cell, wave speed, cells that hold two particles each
dt = 2e-4


def step(q):
    """Takes (particles, 3): place, velocity, stress / density. Gives the same after a step; all else is made anew."""
    x, v, s = q.T
    cell = np.floor(x / H).astype(int)
    weight = np.stack([1 - (x / H - cell), x / H - cell])
    mass, momentum, force = np.zeros((3, cell.max() + 2))
    for k, slope in enumerate((-1 / H, 1 / H)):
        np.add.at(mass, cell + k, weight[k])
        np.add.at(momentum, cell + k, weight[k] * v)
        np.add.at(force, cell + k, -slope * s)
    with np.errstate(all="ignore"):
        a, new = (np.where(mass > 0, of / mass, 0) for of in (force, momentum + dt * force))
    read = lambda node: weight[0] * node[cell] + weight[1] * node[cell + 1]
    return np.column_stack([x + dt * read(new), v + dt * read(a), s + dt * C**2 * (new[cell + 1] - new[cell]) / H])


base = np.zeros((2 * N, 3))
base[:, 0] = (20 + (np.arange(2 * N) + 0.5) / 2) * H
fields = [{"name": "x", "size": 1, "place": True}, {"name": "v", "size": 1, "scale": C},
          {"name": "s", "size": 1, "scale": C**2}]
for line in sys.stdin.buffer:
    ask, answer, state = json.loads(line), {}, None
    if ask["do"] == "describe":
        answer = {"protocol": 1, "name": "line", "dim": 1, "cell_width": H, "particles": 2 * N, "any_count": True,
                  "fields": fields, "parameters": {"dt": dt, "c": C}}
        state = base
    elif ask["do"] == "set":
        dt, C = ask.get("dt", dt), ask.get("c", C)
    elif ask["do"] == "step":
        n = ask.get("particles", 2 * N)
        state = np.frombuffer(sys.stdin.buffer.read(24 * n)).reshape(n, 3)
        for _ in range(ask["steps"]):
            state = step(state)
    else:
        break
    sys.stdout.buffer.write(json.dumps(answer).encode() + b"\n" + (b"" if state is None else state.tobytes()))
    sys.stdout.buffer.flush()
