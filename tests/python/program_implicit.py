#!/usr/bin/python3
"""An implicit step for -program: program_implicit.py PARTICLES THETA [place]. The step reaches the whole domain.

Particles on a ring with springs between neighbours: u_t = v, v_t = K u. With L the matrix of the two and q = (u, v),
(1 - theta dt L) q' = (1 + (1 - theta) dt L) q: Crank and Nicolson's rule for theta 1/2, and unstable below. With place the
particles say where they are, else not.
"""
import json
import sys

import numpy


def matrices(n, theta, dt):
    """The two sides of the step, of unknowns u and v of each particle in turn."""
    side = numpy.zeros((2 * n, 2 * n))
    for i in range(n):
        side[2 * i, 2 * i + 1] = 1
        for j in ((i - 1) % n, (i + 1) % n):
            spring = 1 + 0.1 * numpy.cos(i * j)
            side[2 * i + 1, 2 * j] += spring
            side[2 * i + 1, 2 * i] -= spring
    return numpy.eye(2 * n) - theta * dt * side, numpy.eye(2 * n) + (1 - theta) * dt * side


def main():
    n, theta, dt = int(sys.argv[1]), float(sys.argv[2]), 0.5
    place = [{"name": "x", "size": 1, "place": True}] if "place" in sys.argv else []
    fields = place + [{"name": "u", "size": 1, "scale": 1}, {"name": "v", "size": 1, "scale": 1}]
    base = numpy.zeros((n, len(fields)))
    if place:
        base[:, 0] = numpy.arange(n) + 0.5
    read, write = sys.stdin.buffer, sys.stdout.buffer
    left, right = matrices(n, theta, dt)
    step = numpy.linalg.solve(left, right)
    for line in read:
        ask = json.loads(line)
        answer, data = {}, b""
        if ask["do"] == "describe":
            answer = {"protocol": 1, "name": "ring", "dim": 1, "cell_width": 1.0, "periodic": [float(n)],
                      "particles": n, "fields": fields, "parameters": {"dt": dt}}
            data = base.tobytes()
        elif ask["do"] == "set":
            dt = ask["dt"]
            left, right = matrices(n, theta, dt)
            step = numpy.linalg.solve(left, right)
        elif ask["do"] == "step":
            state = numpy.frombuffer(read.read(base.nbytes)).reshape(base.shape).copy()
            for _ in range(ask["steps"]):
                state[:, -2:] = (step @ state[:, -2:].ravel()).reshape(n, 2)
            data = state.tobytes()
        else:
            break
        write.write(json.dumps(answer).encode() + b"\n" + data)
        write.flush()


if __name__ == "__main__":
    main()
