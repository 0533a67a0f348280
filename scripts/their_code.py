#!/usr/bin/python3
"""Prints the tables of examples/their-code/README.md: what mpmstab finds for Taichi's examples, as pip installs them.

their_code.py [--quick] [--check FILE]

--quick prints a few rows only. With --check it fails unless the rows that it prints are those of FILE, all of them without
--quick. Taichi is installed into build/their-code; MPMSTAB_TAICHI names a Python that has it already. Where it cannot be had
the script says why and ends with status 77. The environment variable MPMSTAB names the program (by default build/mpmstab).
"""
import fcntl
import json
import math
import os
import re
import subprocess
import sys

import numpy

from program import PROGRAM, ROOT, Parser, end_in_one_line, launch, refuse, require_input, require_program, say

WANTED = "taichi==1.7.4"
ADAPTER = os.path.join(ROOT, "examples", "their-code", "taichi_mpm.py")
H, C = 1 / 128, 20.0  # of mpm88: width of a cell, speed of sound
OWN = {"formulation": "usl", "transfer": "apic", "gradient": "mls", "basis": "quadratic", "dim": 2, "poisson": 0.5}
SEED, QUIET = 1e-9 * C, 1e-6 * C  # the velocity with which a run begins, and one that is not reached while it is stable
BLOCK = 6                         # cells of the free block each way
BREAKING = 1e-4 * C               # up to here a run is linear


def taichi_python():
    """A Python with Taichi."""
    python = os.environ.get("MPMSTAB_TAICHI")
    if python:
        return python
    folder = os.path.join(os.path.dirname(PROGRAM), "their-code")
    with open(folder + ".lock", "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)  # a second pip would replace libraries that a script has mapped: a bus error
        return installed_taichi(folder)


def installed_taichi(folder):
    """The Python of this folder with Taichi, which is installed into it where it is missing."""
    python = os.path.join(folder, "bin", "python")
    has = [python, "-c", "import taichi"]
    if os.path.exists(python) and subprocess.run(has, capture_output=True, check=False).returncode == 0:
        return python
    for command in ([sys.executable, "-m", "venv", "--system-site-packages", folder],
                    [python, "-m", "pip", "install", "-q", "--retries", "1", "--timeout", "20", WANTED], has):
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            say(f"Taichi cannot be had: {' '.join(command)}: {(done.stdout + done.stderr).strip()[-300:]}")
            sys.exit(77)
    return python


def code(*words):
    return " ".join([PYTHON, ADAPTER, *words])


def ask(task, **scene):
    status, found, said = launch(task, options=scene)
    if status:
        refuse(f"{task} of {scene}: {said}")
    return found


def growth_of(found):
    """What a finding says of growth; a fault that a certificate shows is said, too."""
    faults = [name for name, one in found["probing"]["certificates"].items() if not one["holds"]]
    return found["verdict"] + (f", {' and '.join(faults)} fail{'s' if len(faults) == 1 else ''}" if faults else "")


# ---- the rows ----


def agree(dim, name, courant, width):
    """The code's growth above the limit, and that of our own table."""
    phases = {2: 32, 3: 2}[dim]
    theirs = ask("symbol", program=code(name, "f64"), program_set=f"dt={courant * width / C!r}", phases=phases)
    own = ask("symbol", **{**OWN, "dim": dim}, courant=courant, phases=phases)
    return f"| {name} | {courant} | {theirs['symbol']['growth']:.7f} | {own['symbol']['growth']:.7f} |"


def lone():
    """A lone particle on both sides of its limit, sqrt(1/2)."""
    for share in (0.999, 1.001):
        courant = share * math.sqrt(0.5)
        found = ask("spectrum", program=code("mpm88", "f64"), program_scene="fill=3,4,ppc=1,offset=0.25", program_set=f"dt={courant * H / C!r}")
        yield f"| lone particle | {share} | {found['spectrum']['growth']:.5f} | {growth_of(found)} |"


def interiors(quick):
    """Each code with each material; quick: the smooth snow only. c is the speed of pressure waves that its constants give."""
    E, nu = 1000.0, 0.2
    first, second = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))
    codes = {("mpm88",): 400.0, ("mpm99", "f64", "liquid"): first,
             ("mpm99", "f64", "jelly"): 0.3 * (first + 2 * second), ("mpm99", "f64", "snow"): first + 2 * second,
             ("mpm99", "f64", "snow", "smooth"): first + 2 * second}
    for words, modulus in codes.items():
        if quick and "smooth" not in words:
            continue
        found = ask("critical", program=code(*words), probe="bloch")
        critical = found["critical"]
        limit, given = critical["limits"]["interior"], critical["given_dt"]
        row = [" ".join(word for word in words if word != "f64"), "double" if "f64" in words else "single", f"{limit:.4e}",
               f"{math.sqrt(modulus) * limit / H:.4f}", f"{given:g}", f"{100 * given / limit:.1f}%", growth_of(found)]
        yield "| " + " | ".join(row) + " |"


def three_limits():
    """Interior, free block and lone particle; then runs of the free block on both sides of its limit."""
    limits = ask("critical", program=code("mpm88", "f64"))["critical"]
    given = limits["given_dt"]
    for name in ("interior", "block", "lone_particle"):
        limit = limits["limits"][name]
        yield f"| {name.replace('_', ' ')} | {limit:.4e} | {C * limit / H:.4f} | {100 * given / limit:.1f}% |"
    yield from runs(limits["limits"]["block"])


def runs(limit):
    """Runs of the free block around its limit."""
    for share in (0.995, 1.005, 1.02):
        dt = share * limit
        found = ask("spectrum", program=code("mpm88", "f64"), program_scene="fill=2,8", program_set=f"dt={dt!r}", probe="coloured")
        yield f"| {share} | {found['spectrum']['growth']:.4f} | {march(dt)} |"


# ---- runs of their code ----


class Child:
    """Their code, asked as mpmstab asks it."""

    def __init__(self, *words):
        environment = {**os.environ, "PYTHONPATH": os.path.join(ROOT, "scripts", "python"), "PYTHONDONTWRITEBYTECODE": "1"}
        self.child = subprocess.Popen([PYTHON, ADAPTER, *words], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                      stderr=subprocess.DEVNULL, env=environment)
        described = self.ask({"do": "describe"})
        self.shape = described.get("particles", 4 * BLOCK**2), sum(field["size"] for field in described["fields"])
        if "particles" not in described:
            line = (numpy.arange(2 * BLOCK) + 0.5) / 2 * H
            place = numpy.stack(numpy.meshgrid(line, line), -1).reshape(-1, 2)
            given = numpy.hstack([place, numpy.full((len(place), 2), H**2 / 4)])  # volumes and masses are read by nothing
            self.ask({"do": "scene", "particles": len(place), "cell_width": H, "periodic": [None, None]}, given.tobytes())
        self.state = self.take()

    def ask(self, message, data=b""):
        self.child.stdin.write(json.dumps(message).encode() + b"\n" + data)
        self.child.stdin.flush()
        line = self.child.stdout.readline()
        return json.loads(line) if line else None

    def take(self):
        return numpy.frombuffer(self.child.stdout.read(8 * math.prod(self.shape))).reshape(self.shape).copy()

    def step(self, steps):
        """Whether the code has lived through these steps."""
        answer = self.ask({"do": "step", "steps": steps}, self.state.tobytes())
        if answer != {}:
            return False
        self.state = self.take()
        return bool(numpy.isfinite(self.state).all())

    def end(self):
        self.child.stdin.close()
        self.child.wait()


def march(dt):
    """Marches the free block from a small random velocity. The growth of its velocity, or that it does not grow."""
    run, seen = Child("mpm88", "f64"), []
    run.ask({"do": "set", "dt": dt})
    run.state[:, 2:4] = SEED * numpy.random.default_rng(1).uniform(-1, 1, (len(run.state), 2))
    for _ in range(2000):
        if not run.step(10):
            break
        seen.append(numpy.linalg.norm(run.state[:, 2:4]))
        if seen[-1] > BREAKING:
            break
    run.end()
    if max(seen) < QUIET:
        return f"bounded in {10 * len(seen)} steps"
    linear = [v for v in seen if QUIET < v < BREAKING]
    return f"{(linear[-1] / linear[0]) ** (1 / (10 * (len(linear) - 1))):.4f}"


def splash(particles=200):
    """Their own scene with fewer particles: how far it gets, and what the states on the way say."""
    for dt in (2.6e-4, 2.8e-4):
        run, steps = Child("mpm88", "f64", "demo", str(particles)), 0
        run.ask({"do": "set", "dt": dt})
        while steps < 5000 and run.step(50):
            steps += 50
        run.end()
        end = f"bounded in {steps} steps" if steps == 5000 else f"ended by itself before step {steps + 50}"
        for found in ask("spectrum", program=code("mpm88", "f64", "demo", str(particles)), program_set=f"dt={dt}",
                         at="0,100")["states"]:
            yield f"| {dt:.1e} | {end} | {found['step']} | {found['growth']:.4f} |"


def rows(quick):
    yield agree(2, "mpm88", 1.4, H)
    yield from lone()
    yield from interiors(quick)
    if not quick:
        yield agree(3, "mpm3d", 1.4, 1 / 32)
        yield from splash()
        yield from three_limits()


def main():
    parser = Parser(__doc__)
    parser.add_argument("--quick", action="store_true", help="a few rows only")
    parser.add_argument("--check", metavar="FILE", help="fail unless FILE has these rows")
    arguments = parser.parse_args()
    require_program()
    globals()["PYTHON"] = taichi_python()
    os.environ["PYTHONPATH"] = os.path.join(ROOT, "scripts", "python")
    os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    known = []
    if arguments.check:
        require_input(arguments.check, "the page with the tables that this script prints")
        with open(arguments.check, encoding="utf-8") as file:
            known = re.findall(r"^\| .*[0-9]\.[0-9].*\|$", file.read(), flags=re.MULTILINE)
    found = []
    for row in rows(arguments.quick):
        found.append(row)
        if not arguments.check:
            print(row, flush=True)
        elif row not in known:
            say(f"{arguments.check} has not the row that comes out: {row}")
    if arguments.check:
        sys.exit(1 if any(row not in known for row in found) or not (arguments.quick or len(known) == len(found)) else 0)


if __name__ == "__main__":
    end_in_one_line(main)
