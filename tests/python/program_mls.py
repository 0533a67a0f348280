#!/usr/bin/python3
"""MLS-MPM of Hu et al. (2018) for -program, as its 88 lines have it: program_mls.py DIM CELLS [free] [single] [slow].

Quadratic splines, APIC, a fluid with pressure only, h = c = rho = 1, two particles a cell in each direction. The ends are joined,
or with the word free nothing is around the particles. A step that is slow takes 5 ms more. Fields are not in the usual order, and one is not read: the place at rest.
"""
import itertools
import json
import sys
import time

import numpy as np

DIM, CELLS = int(sys.argv[1]), int(sys.argv[2])
FREE, SINGLE = "free" in sys.argv, "single" in sys.argv
REAL, VOLUME = np.float32 if SINGLE else np.float64, 0.5**DIM
NODES = 3 * CELLS if FREE else CELLS
WIDTHS = {"J": 1, "C": DIM * DIM, "v": DIM, "x": DIM}


def step(state, dt):
    J, C, v, x = np.split(state, np.cumsum(list(WIDTHS.values()))[:-1], axis=1)
    base = np.floor(x - 0.5).astype(int)
    fx = x - base
    w = [0.5 * (1.5 - fx)**2, 0.75 - (fx - 1)**2, 0.5 * (fx - 0.5)**2]
    affine = VOLUME * C.reshape(-1, DIM, DIM) - 4 * dt * VOLUME * (J[:, :, None] - 1) * np.eye(DIM, dtype=REAL)
    stencil, grid = [], np.zeros((DIM + 1, NODES**DIM), REAL)
    for offset in itertools.product(range(3), repeat=DIM):
        weight = np.prod([w[o][:, a] for a, o in enumerate(offset)], axis=0)
        node, apart = np.zeros(len(x), int), (np.array(offset) - fx).astype(REAL)
        for a, o in enumerate(offset):
            node = node * NODES + (base[:, a] + o) % NODES
        stencil.append((weight, node, apart))
        given = weight[:, None] * (VOLUME * v + np.einsum("pab,pb->pa", affine, apart))
        for a in range(DIM):
            grid[a] += np.bincount(node, given[:, a], NODES**DIM).astype(REAL)
        grid[DIM] += np.bincount(node, weight * VOLUME, NODES**DIM).astype(REAL)
    velocity = (grid[:DIM] / np.where(grid[DIM] > 0, grid[DIM], 1)).T
    v, C = np.zeros_like(v), np.zeros((len(x), DIM, DIM), REAL)
    for weight, node, apart in stencil:
        v += weight[:, None] * velocity[node]
        C += 4 * weight[:, None, None] * velocity[node][:, :, None] * apart[:, None, :]
    J = J * (1 + dt * np.trace(C, axis1=1, axis2=2)[:, None])
    x = x + dt * v
    return np.concatenate([J, C.reshape(len(x), -1), v, x if FREE else x % CELLS], axis=1).astype(REAL)


def main():
    dt, read, write = REAL(0.3), sys.stdin.buffer, sys.stdout.buffer
    along = (np.arange(2 * CELLS) + 0.5) / 2 + (CELLS if FREE else 0)
    x = np.stack(np.meshgrid(*[along] * DIM, indexing="ij"), -1).reshape(-1, DIM)
    state = np.zeros((len(x), sum(WIDTHS.values())))
    state[:, 0], state[:, -DIM:] = 1, x
    fields = [{"size": size, "name": name, **({"place": True} if name == "x" else {})} for name, size in WIDTHS.items()]
    described = {"particles": len(x), "any_count": FREE, "batch": 16, "fields": fields, "cell_width": 1, "name": "mls, 88 Zeilen \u00fc",
                 "dim": DIM, "protocol": 1, "periodic": [None if FREE else CELLS] * DIM, "unknown": {"key": []},
                 "parameters": {"tau": 0.3}}
    for line in read:
        ask = json.loads(line)
        answer, data = {}, b""
        if ask["do"] == "describe":
            answer, data = described, state.tobytes()
        elif ask["do"] == "set":
            dt = REAL(ask["tau"])
            dt = REAL(dt * (1 + 0.01 * np.sin(40 * dt))) if "odd" in sys.argv else dt  # no polynomial of tau
        elif ask["do"] == "step":
            n = ask.get("particles", len(x))
            given = np.frombuffer(read.read(8 * n * state.shape[1] * ask.get("states", 1)))
            for q in given.reshape(-1, n, state.shape[1]).astype(REAL):
                for _ in range(ask["steps"]):
                    q = step(q, dt)
                    time.sleep(0.005 * ("slow" in sys.argv))
                data += q.astype(float).tobytes()
        else:
            break
        write.write(json.dumps(answer, ensure_ascii=False).encode() + b"\n" + data)
        write.flush()


main()
