#!/usr/bin/python3
"""mpmstab-audit of the Python package: its bounds and limits are those of the program, and it needs numpy alone.

check_audit.py same|refused MPMSTAB, or check_audit.py venv, in a folder that may be filled. Silent when all is well. The status
is 77 where venv cannot fetch numpy into a Python of its own.
"""
import contextlib
import io
import json
import math
import os
import re
import shlex
import subprocess
import sys
import types

import numpy

from checks import ROOT, SCRIPTS, check, forks, loaded, text_of

PACKAGE = os.path.join(SCRIPTS, "python")
sys.path.insert(1, PACKAGE)
for absent in ("h5py", "matplotlib", "scipy"):
    sys.modules[absent] = None  # an import fails
from mpmstab import audit, dt, limits  # noqa: E402 (found by the lines above)

SKIPPED = 77
NU, E, RHO, H = 0.3, 2e6, 1200.0, 0.05
SCHEMES = [("usl", "flip", "usl"), ("musl", "flip", "musl"), ("verlet", "flip", "verlet"), ("rk4", "flip", "rk -rk rk4"),
           ("usl", "pic", "usl -transfer pic"), ("usl", "apic", "usl -transfer apic"),
           ("mls-mpm", "flip", "usl -transfer apic -gradient mls")]
BOUND, LIMIT = 1e-10, 2e-6  # the program takes growth up to 1e-6 for stable


def by_audit(words, status=0):
    out, error = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(error):
        try:
            ended = audit.main(words)
        except SystemExit as stopped:
            ended = stopped.code
    check(ended == status, f"{words}: status {ended}: {error.getvalue()}")
    return out.getvalue(), error.getvalue()


def by_program(words):
    done = forks.run([sys.argv[2], "critical", *words.split(), "-json", "its.json"], capture_output=True, text=True,
                     check=False)
    check(done.returncode == 0, f"{words}: {done.stderr}")
    found = loaded("its.json")["critical"]
    unit = found["critical_dt"] / found["critical_courant"]
    return {name: unit * found["bounds"][name] for name in ("lone", "particle", "lanczos", "swept")}, found["critical_dt"]


def layout(rng, dim, cells):
    """Random particles with volumes and masses of their own."""
    n = 2 * cells ** dim
    x, volume = rng.uniform(0, cells * H, (n, dim)), rng.uniform(0.5, 1.5, n) * H ** dim / 2
    numpy.savetxt("layout.csv", numpy.column_stack([x, volume, RHO * volume * rng.uniform(0.5, 2, n)]), delimiter=",", fmt="%.17g",
                  header=",".join(audit.AXES[:dim]) + ",volume,mass", comments="")


def near(mine, its, tolerance, what):
    check(math.isclose(mine, its, rel_tol=tolerance), f"{what}: {mine!r}, the program {its!r}")


def check_same():
    rng = numpy.random.default_rng(5)
    bases = ("hats", "quadratic", "cubic")
    for number, (dim, cells, basis) in enumerate([(1, 12, basis) for basis in bases] + [(2, 4, basis) for basis in bases]):
        layout(rng, dim, cells)
        common = ["layout.csv", "-basis", basis, "-cell_width", str(H), "-cells", str(cells), "-young", str(E), "-density",
                  str(RHO), "-sweeps", "2", "-json", "mine.json", "-dt", "0.3*h/c"] + (["-poisson", str(NU)] if dim > 1 else [])
        for scheme, transfer, named in SCHEMES[number % 3::2]:
            if basis == "hats" and (transfer == "apic" or scheme == "mls-mpm"):
                continue
            by_audit([*common, "-scheme", scheme, "-transfer", transfer])
            mine = loaded("mine.json")
            bounds, limit = by_program(
                f"-formulation {named} -dim {dim} -basis {basis.replace('hats', 'linear')} -cell_width {H} -cells {cells} "
                f"-young {E} -density {RHO} -layout layout.csv -step_bound_sweeps 2" + (f" -poisson {NU}" if dim > 1 else ""))
            what = f"{dim}-D {basis} {named}"
            for name, its in bounds.items():  # the certificate ends in a bisection
                near(mine["bounds"][name], its, 1e-6 if name == "lanczos" else BOUND, f"{what}: {name}")
            near(mine["limit"], limit, LIMIT, f"{what}: limit")
            page = text_of("audit.html")
            check(page.count("<svg") == 3 and "<script src" not in page and "http" not in re.sub(r'xmlns="[^"]+"', "", page),
                  f"{what}: the page is not whole")


def check_verdicts():
    """Steps around the limit and the bounds; the rule is of the layout's numbers."""
    numpy.savetxt("line.csv", numpy.column_stack([[0.1, 0.33, 0.36, 0.8], [3, 0, 0, -4.0]]), delimiter=",", header="x,vx", comments="")
    words = ["line.csv", "-cell_width", "0.25", "-cells", "4", "-young", "16", "-density", "4", "-json", "v.json"]
    by_audit([*words, "-dt", "min(h, 0.1 * h) / (c + v) + 0 * dim"])
    found = loaded("v.json")
    near(found["dt"], 0.1 * 0.25 / (2 + 4), 1e-15, "a rule")
    check(found["verdict"] == "stable" and "proved" in found["reason"], f"{found}")
    for step, verdict in ((found["limit"] * 1.001, "unstable"), (found["bounds"]["lanczos"] * 0.999, "stable")):
        by_audit([*words, "-dt", repr(step)])
        check(loaded("v.json")["verdict"] == verdict, f"step {step}: {loaded('v.json')}")
    by_audit([*words, "-products", "0", "-dt", repr(found["limit"])])
    check(loaded("v.json")["verdict"] == "undecided" and "limit" not in loaded("v.json"), "an unknown limit")
    by_audit(["line.csv", "-cell_width", "0.25", "-young", "16", "-density", "4", "-volume", "0.1", "-json", "v.json"])
    near(loaded("v.json")["lone_anywhere"], 0.25 / 2 / math.sqrt(3), 1e-5, "a lone particle")


def check_march():
    """A plain march of usl with flip in numpy: what is said to be stable is, and what is said to grow does."""
    rng = numpy.random.default_rng(2)
    n, cells = 24, 8
    at = dt.Layout(rng.uniform(0, cells, n), 1 / 3, 1 / 3, h=1, young=1, nodes=cells, origin=0, periodic=True)
    low, high = (math.sqrt(square) for square in limits.find(at, "usl"))
    check(low < high < low * (1 + 1e-6), f"the limit is between {low} and {high}")
    S, G = numpy.zeros((n, cells)), numpy.zeros((n, cells))
    numpy.put_along_axis(S, at.node, at.S, 1)
    numpy.put_along_axis(G, at.node, at.g[:, :, 0], 1)
    for step, grows in ((low * 0.999, False), (high * 1.01, True)):
        v, s = rng.normal(size=n), numpy.zeros(n)
        for _ in range(4000):
            before = (S.T @ (at.mass * v)) / at.nodal_mass
            after = before - step * (G.T @ (at.volume * s)) / at.nodal_mass
            v, s = v + S @ (after - before), s + step * G @ after
        check((numpy.abs(v).max() > 1e6) == grows, f"step {step}: the largest velocity is {numpy.abs(v).max()}")


def check_page():
    """examples/your-layout prints what the command on its page prints."""
    page = text_of(os.path.join(ROOT, "examples", "your-layout", "README.md"))
    command = re.search(r"^    mpmstab-audit (.+)$", page, re.MULTILINE).group(1)
    found, _ = by_audit([os.path.join(ROOT, word) if word.endswith(".csv") else word for word in shlex.split(command)])
    shown = re.search(r"```\n(  lone .+?)\n```", page, re.DOTALL).group(1)
    check(shown in found, f"the page of your-layout shows\n{shown}\nnot\n{found}")


BAD = [("", "no particle"), ("x\n", "no particle"), ("y\n1\n", "line 1"), ("x,x\n1,1\n", "a column twice"),
       ("x,volume\n.5,1\n.5,-1\n", "line 3: volume -1"), ("x\nnan\n", "line 2: x nan"), ("x\n.5\n\n.6\n", "line 3"),
       ("x\n.5,.6\n", "line 2: 2 numbers"), ("x\n.5\n9\n", "line 3: [9.] is outside"), ("x\nabc\n", "line 2")]


def check_refused():
    words = ["-cell_width", "0.25", "-cells", "4", "-young", "1"]
    for text, says in BAD:
        with open("bad.csv", "w", encoding="utf-8") as file:
            file.write(text)
        _, error = by_audit(["bad.csv", *words], 2)
        check(len(error.splitlines()) == 1 and says in error and "allowed" in error, f"{text!r}: {error}")
    with open("good.csv", "w", encoding="utf-8") as file:
        file.write("x\n0.1\n")
    for more, says in ((["-dt", "__import__('os')"], "is not known"), (["-dt", "h.real"], "is not known"), (["-dt", "1/0"], "division"),
                       (["-dt", "0 - h"], "allowed: a positive number"), (["-dt", "q * h"], "'q' is not known"), (["-dt", "9**9**9"], "dt"),
                       (["-young", "-1"], "young"), (["-cells", "0"], "cells"), (["-basis", "hats", "-transfer", "apic"], "hats"),
                       (["-scheme", "verlet", "-transfer", "apic"], "transfer"), (["-html", "no/such.html"], "no/such.html")):
        _, error = by_audit(["good.csv", *words, *more], 2)
        check(len(error.splitlines()) == 1 and says in error, f"{more}: {error}")
    _, error = by_audit(["none.csv", *words], 2)
    check("none.csv: no such file" in error, error)


def check_venv():
    """The package in a Python of its own, with what pip fetches for it: the command, the module, and mpmstab.dt."""
    subprocess.run([sys.executable, "-m", "venv", "own"], check=True)
    done = subprocess.run(["own/bin/pip", "install", "-q", "--disable-pip-version-check", "--retries", "0", PACKAGE], capture_output=True,
                          text=True, check=False, cwd=".")
    if done.returncode:
        print(f"check_audit: pip cannot install the package here: {done.stderr.strip().splitlines()[-1]}")
        sys.exit(SKIPPED)
    own = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "MPMSTAB")}
    words = [os.path.join(ROOT, "examples", "your-layout", "particles.csv"), "-cell_width", "0.1", "-cells", "10", "-young", "1"]
    answers = []
    for command in (["own/bin/mpmstab-audit"], ["own/bin/python", "-m", "mpmstab", "audit"]):
        done = subprocess.run([*command, *words, "-json", "own.json"], capture_output=True, text=True, check=False, env=own)
        check(done.returncode == 0, f"{command}: {done.stderr}")
        answers.append(json.dumps(loaded("own.json")))
    check(answers[0] == answers[1], f"{answers}")
    check(not os.path.exists("own/bin/mpmstab"), "the package hides the program mpmstab")
    listed = subprocess.run(["own/bin/pip", "list", "--format", "json"], capture_output=True, text=True, check=True).stdout
    there = {one["name"] for one in json.loads(listed)} - {"pip", "setuptools", "wheel"}
    check(there == {"mpmstab", "numpy"}, f"installed: {there}")


PARTS = types.MappingProxyType({"same": (check_same, check_verdicts, check_march), "refused": (check_refused, check_page), "venv": (check_venv,)})
for part in PARTS[sys.argv[1]]:
    part()
