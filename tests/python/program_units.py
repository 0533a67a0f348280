#!/usr/bin/python3
"""A bar on hats in any units, for -program and for the hook: program_units.py WORDS... [hook=FILE].

SCHEME   usl, musl or euler, in which stress takes the velocity of before the step. A particle a cell, in its middle.
E= rho= h=   Young's modulus, density and cell width: the units. Steel in SI is the default.
k=       Courant number. stress= and v=: of the base state, the same everywhere.
single   floats
damped   a viscosity of 1.5 rho c h that acts in compression only
kinked   v grows by 1.005 where it is below 0, and shrinks by 0.985 where it is above: half and half it shrinks
outputs  two fields that nothing reads: the largest stress so far, and what v has been above 0
jacobian instead of stress, the state is the deformation gradient F
lost     declares a scale of v that is far too small
"""
import json
import sys

import numpy

CELLS = 16


class Bar:
    def __init__(self, words):
        said = dict(word.split("=") for word in words if "=" in word)
        number = lambda name, default: float(said.get(name, default))
        self.words, self.E, self.rho, self.h = words, number("E", 2e11), number("rho", 7800), number("h", 0.01)
        self.c = (self.E / self.rho) ** 0.5
        self.parameters = {"dt": number("k", 0.5) * self.h / self.c}
        x = (numpy.arange(CELLS) + 0.5) * self.h
        solid = numpy.full(CELLS, 1.0 if "jacobian" in words else number("stress", 0))
        self.state = {"x": x, "v": numpy.full(CELLS, number("v", 0)), "F" if "jacobian" in words else "stress": solid}
        if "outputs" in words:
            self.state |= {"most": solid.copy(), "above": numpy.zeros(CELLS)}
        if "single" in words:
            self.state = {name: array.astype(numpy.float32) for name, array in self.state.items()}
        self.base = self.gather()

    def gather(self):
        return numpy.column_stack([array.astype(float) for array in self.state.values()])

    def scatter(self, values):
        for array, column in zip(self.state.values(), values.T):
            array[:] = column

    def advance(self):
        """One step; it changes the arrays."""
        x, v, s = list(self.state.values())[:3]
        kind, dt = x.dtype.type, x.dtype.type(self.parameters["dt"])
        h, E, rho, c = (kind(number) for number in (self.h, self.E, self.rho, self.c))
        stress = E * (s - kind(1)) if "jacobian" in self.words else s.copy()
        at = numpy.floor(x / h).astype(int)
        xi = x / h - at.astype(kind)
        hats, slopes = (1 - xi, xi), (-1 / h, 1 / h)

        def give(values, weights):
            nodes = numpy.zeros(CELLS, dtype=kind)
            for k in range(2):
                numpy.add.at(nodes, (at + k) % CELLS, weights[k] * values)
            return nodes

        take = lambda nodes, weights: sum(weights[k] * nodes[(at + k) % CELLS] for k in range(2))
        mass = give(rho * h, hats)
        old = give(rho * h * v, hats) / mass
        if "damped" in self.words:
            stress += kind(1.5) * rho * c * h * numpy.minimum(take(old, slopes), 0)
        a = -give(h * stress, slopes) / mass
        v += dt * take(a, hats)
        new = old if "euler" in self.words else give(rho * h * v, hats) / mass if "musl" in self.words else old + dt * a
        strain = dt * take(new, slopes)
        s += s * strain if "jacobian" in self.words else E * strain
        x += dt * take(old + dt * a, hats)
        if "kinked" in self.words:
            v *= numpy.where(v < 0, kind(1.005), kind(0.985))
        x -= CELLS * h * numpy.floor(x / (CELLS * h))
        if "outputs" in self.words:
            self.state["most"][:] = numpy.maximum(self.state["most"], s)
            self.state["above"] += numpy.maximum(v, 0)

    def scales(self):
        return {"v": 1e-12 * self.c} if "lost" in self.words else {}

    def description(self):
        fields = [{"name": name, "size": 1} for name in self.state]
        fields[0]["place"] = True
        for field in fields:
            if field["name"] in self.scales():
                field["scale"] = self.scales()[field["name"]]
        return {"protocol": 1, "name": "bar", "dim": 1, "cell_width": self.h, "periodic": [CELLS * self.h],
                "particles": CELLS, "fields": fields, "parameters": self.parameters}


def serve(bar):
    """Answers what -program asks."""
    read, write = sys.stdin.buffer, sys.stdout.buffer
    for line in read:
        ask = json.loads(line)
        answer, data = {}, b""
        if ask["do"] == "describe":
            answer, data = bar.description(), bar.base.tobytes()
        elif ask["do"] == "set":
            bar.parameters["dt"] = ask["dt"]
        elif ask["do"] == "step":
            bar.scatter(numpy.frombuffer(read.read(bar.base.nbytes)).reshape(bar.base.shape))
            for _ in range(ask["steps"]):
                bar.advance()
            data = bar.gather().tobytes()
        else:
            break
        write.write(json.dumps(answer).encode() + b"\n" + data)
        write.flush()


def main():
    path = next((word[5:] for word in sys.argv if word.startswith("hook=")), None)
    bar = Bar([word for word in sys.argv[1:] if not word.startswith("hook=")])
    if not path:
        serve(bar)
        return
    from mpmstab.adapter import probe
    while probe(path, bar.h, bar.state, periodic=[CELLS * bar.h], scale=bar.scales()):
        bar.advance()


if __name__ == "__main__":
    main()
