#!/usr/bin/python3
"""The examples of examples/step-in-your-loop live with 0.95 of their bound, and die with 1.1 of the exact limit.

check_step_in_your_loop.py PART COMPILER MPICC MPIEXEC, in a folder that may be filled; PART is c, numpy, bounds or taichi. Silent when
all is well. The exact limit is that of dense matrices of the layout that an example starts with: usl with apic is stable up to
dt^2 K <= 2 (1 + F), F being P2G of G2P with the affine part. Status 77 where Taichi cannot be had.
"""
import os
import re
import subprocess
import sys

import numpy
import scipy.linalg

from checks import ROOT, SCRIPTS, check

sys.path.insert(1, os.path.join(SCRIPTS, "python"))
sys.path.insert(2, SCRIPTS)
from mpmstab import dt  # noqa: E402 (found by the line above)

FOLDER = os.path.join(ROOT, "examples", "step-in-your-loop")


def exact_step(path, h, **moduli):
    """The largest stable step of a layout of particles with mass and volume."""
    rows = numpy.genfromtxt(path, delimiter=",", names=True)
    at = dt.Layout(numpy.column_stack([rows["x"], rows["y"]]), rows["volume"], rows["mass"], h=h, gradient="mls", **moduli)
    free = numpy.flatnonzero(at.free[:, 0])
    number = numpy.full(at.free.shape[0], -1)
    number[free] = numpy.arange(len(free))
    n, K, F = len(free), 0, 0
    K, F = numpy.zeros((2 * n, 2 * n)), numpy.zeros((n, n))
    for p in range(at.n):
        at_p, S, g = number[at.node[p]], at.S[p], at.g[p]
        F[numpy.ix_(at_p, at_p)] += at.mass[p] * (numpy.outer(S, S) + h * h / 4 * g @ g.T)
        B = numpy.zeros((3, 2 * len(S)))
        B[0, ::2], B[1, 1::2], B[2, ::2], B[2, 1::2] = g[:, 0], g[:, 1], g[:, 1], g[:, 0]
        stiff = at.lame[p] + 2 * at.mu[p]
        elastic = numpy.array([[stiff, at.lame[p], 0], [at.lame[p], stiff, 0], [0, 0, at.mu[p]]])
        unknown = numpy.column_stack([2 * at_p, 2 * at_p + 1]).ravel()
        K[numpy.ix_(unknown, unknown)] += at.volume[p] * B.T @ elastic @ B
    mass = numpy.diag(at.nodal_mass[free])
    largest = scipy.linalg.eigh(K, numpy.kron(mass + F, numpy.eye(2)), eigvals_only=True)[-1]
    return numpy.sqrt(2 / largest)


def run(*words, status=0):
    done = subprocess.run(words, capture_output=True, text=True, timeout=200, check=False)
    check(done.returncode == status, f"{' '.join(words)}: status {done.returncode}, not {status}: {done.stdout}{done.stderr}")
    return done.stdout


def bound_of(printed):
    return float(re.search(r"largest step (?:at first )?(\S+) s", printed)[1])


def compiled(compiler, name):
    run(compiler, "-std=c99", "-O2", "-Wall", "-Wextra", "-Wno-unused-function", "-Werror", "-I", os.path.join(ROOT, "include"),
        os.path.join(FOLDER, f"{name}.c"), "-o", name, "-lm")
    return os.path.abspath(name)


def check_c(compiler, mpicc, mpiexec):
    loop, ranks = compiled(compiler, "loop"), [mpiexec, "-n", "2", compiled(mpicc, "ranks")]
    bound = bound_of(run(loop, "0.95", "loop.csv"))
    exact = exact_step("loop.csv", 0.01, young=1e6, poisson=0.3)
    check(0.8 * exact < bound < exact, f"loop.c: bound {bound}, exact {exact}")
    run(loop, str(0.999 * exact / bound))
    run(loop, str(1.1 * exact / bound), status=3)
    together = bound_of(run(*ranks, "0.95"))
    check(0.8 * exact < together < exact, f"ranks.c: bound {together}, exact {exact}")
    run(*ranks, str(1.1 * exact / together), status=3)


def check_numpy():
    program = os.path.join(FOLDER, "mpm88.py")
    bound = bound_of(run(sys.executable, program, "--layout", "fluid.csv", "--time", "0.4"))
    exact = exact_step("fluid.csv", 1 / 32, lame=400, mu=0)
    check(0.8 * exact < bound < exact, f"mpm88.py: bound {bound}, exact {exact}")
    run(sys.executable, program, "--still")
    run(sys.executable, program, "--still", "--share", str(1.1 * exact / bound), status=3)
    first = run(sys.executable, os.path.join(FOLDER, "picture.py"), "--check")  # the first picture of README.md
    step = float(re.search(r" of (\S+) s", first)[1])
    with open(os.path.join(ROOT, "README.md"), encoding="utf-8") as file:
        check(f"up to {1e3 * step:.2f} ms" in file.read(), f"README.md does not say {1e3 * step:.2f} ms under its first picture")


def check_bounds():
    """The table of the page."""
    with open(os.path.join(FOLDER, "README.md"), encoding="utf-8") as file:
        page = file.read()
    printed = run(sys.executable, os.path.join(FOLDER, "bounds.py"))
    check(f"```\n{printed}```" in page, f"README.md has another table than bounds.py:\n{printed}")


def check_taichi():
    import their_code  # says why and ends with status 77 where Taichi cannot be had
    python, program = their_code.taichi_python(), os.path.join(FOLDER, "mpm88_taichi.py")
    run(sys.executable, os.path.join(FOLDER, "mpm88.py"), "--layout", "fluid.csv", "--time", "0.01")
    same = re.findall(r"^(\d\S+) (\S+)$", run(python, program, "--check"), re.MULTILINE)
    check(len(same) == 2 and all(abs(float(a) / float(b) - 1) < 1e-12 for a, b in same), f"kernel and mpmstab.dt: {same}")
    bound, exact = bound_of(run(python, program)), exact_step("fluid.csv", 1 / 32, lame=400, mu=0)
    check(bound < exact, f"mpm88_taichi.py: bound {bound}, exact {exact}")
    run(python, program, "--still", "--share", str(1.1 * exact / bound), status=3)


if __name__ == "__main__":
    part, words = sys.argv[1], sys.argv[2:]
    {"c": check_c, "numpy": lambda *_: check_numpy(), "bounds": lambda *_: check_bounds(),
     "taichi": lambda *_: check_taichi()}[part](*words)
