#!/usr/bin/python3
"""include/mpmstab_dt.h and mpmstab.dt of the Python package give the same bounds, on random layouts.

check_dt.py COMPILER, in a folder that may be filled. Silent when all is well.

Random layouts have one to three dimensions, all bases, walls, periods and a material for each particle. The header is compiled
as C99 and as C++11, without a warning, and with OpenMP, where three threads give what one gives.
"""
import ctypes
import os
import shutil
import subprocess
import sys
import time

import numpy

from checks import ROOT, SCRIPTS, check

sys.path.insert(1, os.path.join(SCRIPTS, "python"))
from mpmstab import dt  # noqa: E402 (found by the line above)

BASES = list(dt.WIDTH)
BOUNDS = ["lone", "particle", "lanczos"]
LIBRARY = os.path.join(ROOT, "tests", "support", "dt_library.c")
STRICT = ["-O2", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror", "-I", os.path.join(ROOT, "include")]


def compiled(compiler, name, *flags):
    subprocess.run([compiler, "-std=c99", *STRICT, *flags, "-shared", "-fPIC", LIBRARY, "-o", name, "-lm"], check=True)
    function = ctypes.CDLL(os.path.abspath(name)).dt_step
    function.restype = ctypes.c_char_p
    return function


def pointer(values, kind):
    return None if values is None else numpy.ascontiguousarray(values, kind).ctypes.data_as(ctypes.c_void_p)


def draw(rng, most=(30, 9, 6)):
    """A random layout."""
    dim = int(rng.integers(1, 4))
    cells = rng.integers(4, most[dim - 1], dim)
    h = rng.uniform(0.5, 2, dim) * 10.0 ** rng.integers(-3, 3)
    origin = rng.normal(size=dim)
    periodic = rng.random(dim) < 0.3
    n = int(rng.integers(1, 3 * numpy.prod(cells)))
    x = origin + h * rng.uniform(numpy.where(periodic, -5, 1), numpy.where(periodic, 15, cells - 2), (n, dim))
    scene = {"h": h, "origin": origin, "nodes": cells, "periodic": periodic, "basis": BASES[rng.integers(3)],
             "gradient": "mls" if rng.random() < 0.4 else "basis"}
    if rng.random() < 0.5:
        scene |= {"young": 10.0 ** rng.uniform(0, 4, n), "poisson": rng.uniform(-0.4, 0.49, n)}
    else:
        scene |= {"mu": 10.0 ** rng.uniform(0, 4, n), "lame": rng.uniform(-0.6, 5, n)}
    if rng.random() < 0.5:
        scene["fixed"] = rng.random((int(numpy.prod(cells)), dim)) < 0.3
    return x, rng.uniform(0.1, 1, n), 10.0 ** rng.uniform(-2, 2, n), scene


def by_header(function, x, volume, mass, scene, *, bound, scheme, sweeps, products, chance, seed, mode):
    dim, young = x.shape[1], "young" in scene
    moduli = numpy.stack([scene["young"], scene["poisson"]] if young else [scene["lame"], scene["mu"]], -1)
    nodes = numpy.ones(3, int)
    nodes[:dim] = scene["nodes"]
    fixed = (scene["fixed"] << numpy.arange(dim)).sum(axis=1) if "fixed" in scene else None
    answers = numpy.zeros(4)
    error = function(dim, dt.WIDTH[scene["basis"]], int(scene["gradient"] == "mls"), pointer(scene["h"], float),
                     pointer(scene["origin"], float), pointer(nodes, ctypes.c_long), pointer(scene["periodic"], ctypes.c_int),
                     pointer(fixed, numpy.uint8), ctypes.c_long(len(x)), pointer(x, float), pointer(volume, float),
                     pointer(mass, float), pointer(moduli, float), int(young),
                     ctypes.c_double(0 if scheme == "mls-mpm" else dt.FACTOR[scheme]), sweeps, products, ctypes.c_double(chance),
                     ctypes.c_ulonglong(seed), BOUNDS.index(bound), mode.ctypes.data_as(ctypes.c_void_p),
                     answers.ctypes.data_as(ctypes.c_void_p))
    return error, answers


def near(one, other, tolerance=1e-12):
    return one == other or abs(one - other) <= tolerance * abs(other)


def check_same(functions, rng):
    """One layout, all bounds."""
    x, volume, mass, scene = draw(rng)
    schemes = ["usl", "musl", "rk4"] + (["mls-mpm"] if scene["gradient"] == "mls" and scene["basis"] != "hats" else [])
    for bound, sweeps in (("lone", 0), ("particle", 0), ("particle", 3), ("lanczos", 0)):
        asked = {"bound": bound, "sweeps": sweeps, "products": int(rng.integers(1, 25)), "chance": 1e-4,
                 "seed": int(rng.integers(2 ** 62)), "scheme": schemes[rng.integers(len(schemes))]}
        found = dt.step(x, volume, mass, mode=True, **asked, **scene)
        for function in functions:
            mode = numpy.zeros((int(numpy.prod(scene["nodes"])), x.shape[1]))
            error, (step, omega2, least, particle) = by_header(function, x, volume, mass, scene, mode=mode, **asked)
            which = f"{asked}, {len(x)} particles, {scene}"
            check(error is None, f"{error}: {which}")
            check(near(step, found.dt) and near(omega2, found.omega2),
                  f"header {step!r}, {omega2!r}; numpy {found.dt!r}, {found.omega2!r}: {which}")
            if bound != "lanczos" and not sweeps:  # sweeps make bounds alike
                check(particle == found.particle, f"particle {particle}, numpy {found.particle}: {which}")
            if found.mode is not None:
                check(near(least, found.omega2_least, 1e-9), f"at least {least!r}, numpy {found.omega2_least!r}: {which}")


def check_mode():
    """The mode of a soft block with one stiff particle is about this particle, and omega2 is its Rayleigh quotient."""
    rng = numpy.random.default_rng(1)
    x = rng.uniform(2, 10, (200, 2))
    young = numpy.where(numpy.arange(200) == 77, 100.0, 1.0)
    scene = {"h": numpy.ones(2), "origin": numpy.zeros(2), "nodes": numpy.array([13, 13]), "periodic": numpy.zeros(2, bool),
             "basis": "quadratic", "gradient": "basis", "young": young, "poisson": numpy.full(200, 0.3)}
    volume = numpy.full(200, 0.25)
    found = dt.step(x, volume, volume, mode=True, **scene)
    at = dt.Layout(x, volume, volume, **scene)
    v = found.mode / numpy.where(at.free, at.root, 1)
    check(found.particle == 77, f"the mode is about particle {found.particle}")
    check(near(numpy.vdot(v, at.product(v)), found.omega2_least * numpy.vdot(v, v), 1e-9), "the mode is not that of omega2")
    mode = numpy.zeros((169, 2))
    error, answers = by_header(HEADER, x, volume, volume, scene, bound="lanczos", scheme="usl", sweeps=0, products=20,
                               chance=1e-6, seed=1, mode=mode)
    check(error is None and answers[3] == 77, f"header: {error}, particle {answers[3]}")
    one, other = (m / m.flat[numpy.abs(m).argmax()] for m in (mode, found.mode))
    check(numpy.abs(one - other).max() < 1e-6, "the header has another mode")


def check_refused():
    x = numpy.array([[1.5], [2.5]])
    for change, words in (({"volume": [1, -1]}, "volume of particle 1"), ({"mass": [0, 1]}, "mass of particle 0"),
                          ({"young": [1, 2], "poisson": [0.3, 0.7]}, "particle 1 has lambda"), ({"nodes": 3}, "not in the grid"),
                          ({"x": [[numpy.nan], [1]]}, "particle 0 is at"), ({"bound": "best"}, "lone, particle or lanczos")):
        asked = {"x": x, "volume": [1, 1], "mass": [1, 1], "h": 1.0, "nodes": 8, "young": 1, "poisson": 0} | change
        try:
            dt.step(**asked)
        except ValueError as error:
            check(words in str(error), f"{change}: {error}")
        else:
            check(False, f"{change} is taken")


def check_duration():
    """1e5 particles take about a second: here they get ten, beside other tests."""
    rng = numpy.random.default_rng(2)
    x = rng.uniform(2, 158, (100000, 2))
    for bound in BOUNDS:
        start = time.process_time()
        dt.step(x, 0.25, 0.25, h=1, young=1, poisson=0.3, bound=bound)
        check(time.process_time() - start < 10, f"{bound} of 1e5 particles took {time.process_time() - start:.1f} s")


if __name__ == "__main__":
    HEADER = compiled(sys.argv[1], "dt_library.so")
    os.environ["OMP_NUM_THREADS"] = "3"  # read when the library is loaded
    check_mode()
    for seed in range(200):
        check_same([HEADER], numpy.random.default_rng(seed))
    threads = compiled(sys.argv[1], "dt_threads.so", "-fopenmp")
    for seed in range(20):
        check_same([threads], numpy.random.default_rng(seed))
    check_refused()
    check_duration()
    if shutil.which("g++"):
        subprocess.run(["g++", "-std=c++11", *STRICT, "-x", "c++", "-fsyntax-only", LIBRARY], check=True)
