#!/usr/bin/python3
"""Steps of a bar on hats for -program, right ones and broken ones: program_steps.py SCHEME [FAULT] [CELLS].

SCHEME is usl or musl, with flip; the bar is periodic, h = c = rho = 1. FAULT: words of FAULTS. Unknowns have scale 1 but
for the place, whose scale is the cell width, 1; with "unsaid" they are not declared. Of the codes that are strange without being wrong, "leapfrog" and
"overstress" keep an acceleration and a stress that the state does not have, and lose them with every request; "trips" is
softer for ever once v has been above 1e-3, or until it is told to forget that ("resets"); "filters" smooths v every seventh
step of its life, "afresh" of each request; "half" has viscosity in compression alone, "cut" no tension. "tears" has no answer after two steps of a request.
"""
import json
import sys

import numpy

PPC = 2
FAULTS = ("stale", "drops", "clamp", "weak", "mean", "memory", "noise", "moves", "single", "leapfrog", "overstress", "trips",
          "resets", "filters", "afresh", "half", "solver", "tears", "cut")
EVERY = 7  # steps


class Bar:
    def __init__(self, scheme, fault, cells, drift):
        self.scheme, self.fault, self.cells, self.tripped, self.count = scheme, fault, cells, False, 0
        self.forget()
        self.dt, self.E, self.random = 0.5, 1.0, numpy.random.default_rng(1)
        x = (numpy.arange(cells * PPC) + (0.625 if drift else 0.5)) / PPC  # none comes to a face
        self.base = numpy.column_stack([x, numpy.full(len(x), drift / self.dt), numpy.zeros(len(x))])
        if fault == "moves":
            self.base[:, 2] = 0.1 * numpy.sin(2 * numpy.pi * x / cells)
        self.last, self.list = self.base, numpy.floor(x).astype(int)

    def forget(self):
        """What is lost with every request: the acceleration of the step before, and an overstress."""
        self.a, self.over = 0, 0

    def sum(self, values, at, weights):
        """Sums what particles give to the nodes at their cells' left and right ends."""
        nodes = numpy.zeros(self.cells)
        for k in range(2):
            numpy.add.at(nodes, (at + k) % self.cells, weights[k] * values)
        return nodes

    def step(self, state):
        x, v, s = state.T
        at = numpy.floor(x).astype(int)
        if self.fault == "stale":
            at, self.list = self.list, at
        xi = x - at
        hats, slopes = (1 - xi, xi), (-1, 1)
        gather = lambda nodes, weights: sum(weights[k] * nodes[(at + k) % self.cells] for k in range(2))
        mass = self.sum(1, at, hats)
        old = self.sum(v, at, hats) / mass
        rate = gather(old, slopes)
        self.tripped = self.tripped or (self.fault == "trips" and abs(v).max() > 1e-3)
        viscous = 0.1 * numpy.minimum(rate, 0) if self.fault == "half" else self.over
        a = -self.sum(s + viscous, at, slopes) / mass
        if self.fault == "overstress":
            self.over = 0.5 * self.over + 0.1 * rate
        if self.fault == "leapfrog":
            self.a, a = a, (self.a + a) / 2
        v = v + self.dt * gather(a, hats)
        self.count += 1
        if self.fault in ("filters", "afresh") and self.count % EVERY == 0:
            v = v + 0.1 * (numpy.roll(v, 1) - 2 * v + numpy.roll(v, -1))
        if self.fault == "clamp":
            v[7] = max(v[7], state[7, 1])
        if self.fault == "weak":
            v[16] = max(v[16], v[16] + 1e-3 * (state[16, 1] - v[16]))
        if self.fault == "mean":  # every particle feels all others
            v = v - 0.1 * v.mean()
        nodes = self.sum(v, at, hats) / mass if self.scheme == "musl" else old + self.dt * a
        strain = (0.5 if self.tripped else 1) * self.E * self.dt * gather(nodes, slopes)
        if self.fault == "drops":
            strain[abs(strain) < 1e-5] = 0
        if self.fault == "cut":
            strain = numpy.minimum(s + strain, 0) - s
        if self.fault == "solver":  # the tolerance of one
            strain = numpy.round(strain, 6)
        s = s + strain
        x = (x + self.dt * gather(nodes, hats)) % self.cells
        if self.fault == "memory":
            v = v + 0.1 * (self.last[:, 1] - self.base[:, 1])
            self.last = state
        if self.fault == "noise":
            s = s + 1e-7 * self.random.standard_normal(len(s))
        state = numpy.column_stack([x, v, s])
        return state.astype(numpy.float32).astype(float) if self.fault == "single" else state


def main():
    words = sys.argv[1:]
    fault = next((word for word in words if word in FAULTS), "")
    cells = next((int(word) for word in words if word.isdigit()), 16)
    drift = next((float(word[6:]) for word in words if word.startswith("drift=")), 0.0)
    bar = Bar(words[0], fault, cells, drift)
    read, write = sys.stdin.buffer, sys.stdout.buffer
    scale = {} if "unsaid" in words else {"scale": 1}
    fields = [{"name": "x", "size": 1, "place": True}, {"name": "v", "size": 1, **scale}, {"name": "s", "size": 1, **scale}]
    for line in read:
        ask = json.loads(line)
        answer, data = {}, b""
        if ask["do"] == "describe":
            answer = {"protocol": 1, "name": "bar", "dim": 1, "cell_width": 1.0, "periodic": [float(cells)],
                      "particles": len(bar.base), "fields": fields, "parameters": {"dt": bar.dt, "E": bar.E},
                      "reset": "resets" in words}
            data = bar.base.tobytes()
        elif ask["do"] == "set":
            bar.dt, bar.E = ask.get("dt", bar.dt), ask.get("E", bar.E)
        elif ask["do"] == "step":
            state = numpy.frombuffer(read.read(bar.base.nbytes)).reshape(bar.base.shape)
            bar.forget()
            bar.tripped = bar.tripped and not ask.get("reset")
            bar.count = 0 if fault == "afresh" else bar.count
            for step in range(ask["steps"]):
                state = bar.step(state) * (numpy.nan if fault == "tears" and step > 1 else 1)
            data = state.tobytes()
        else:
            break
        write.write(json.dumps(answer).encode() + b"\n" + data)
        write.flush()


main()
