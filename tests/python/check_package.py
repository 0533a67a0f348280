#!/usr/bin/python3
"""Checks the Python package of scripts/python: it returns what the program says, and what numpy finds.

check_package.py MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import contextlib
import gc
import importlib.util
import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from fractions import Fraction

import matplotlib
import numpy
import scipy.sparse

from checks import ROOT, SCRIPTS, check, loaded, text_of

PACKAGE = os.path.join(SCRIPTS, "python")
sys.path.insert(1, PACKAGE)
import mpmstab  # noqa: E402 (found by the line above)
from mpmstab import program, words  # noqa: E402

MARK = "MPMSTAB_CHECK_PACKAGE"  # in the environment of processes that Ctrl-C must end
SCENE = {"cells": 8, "ppc": 2, "drift": Fraction(1, 8)}


def refused(call, kind=mpmstab.BadInput):
    """Returns the message with which a call is refused."""
    try:
        call()
    except kind as error:
        return str(error)
    return sys.exit("check_package: what is bad input is taken")


def check_words():
    """Values as the command line has them."""
    said = words.words_of({"drift": (Fraction(1, 8), 0), "cells": numpy.array([4, 2]), "measure": False,
                           "courant": numpy.float64(0.1), "initial": "random"})
    check(said == ["-drift", "1/8,0", "-cells", "4,2", "-measure", "false", "-courant", "0.1", "-initial", "random"],
          f"{said}")
    check("-courant {}" in refused(lambda: words.text_of("courant", {})), "a dictionary as a Courant number")
    said = dict(re.findall(r"(\w+)=(\w+)", re.sub("#.*", "", text_of(os.path.join(SCRIPTS, "mpi-env.sh")))))
    check(said == program.MPI, "the environment of mpirun is not that of scripts/mpi-env.sh")


def check_same(path):
    """A result is the program's own JSON."""
    subprocess.run([path, "critical", "-formulation", "usl", "-json", "own.json"], stdout=subprocess.DEVNULL, check=True)
    own, found = loaded("own.json"), mpmstab.critical(formulation="usl", json="kept.json")
    check(json.dumps(loaded("kept.json")) == json.dumps(found.json), "json= is not the file that is read")
    for result in (own, found.json):
        del result["wall_s"], result["critical"]["seconds"]
    check(own == found.json, "the program says something else of critical")
    check(found.critical.critical_courant == found["critical"]["critical_courant"]
          == found.rows["critical_courant"][0] == own["critical"]["critical_courant"], "critical_courant")
    check("closed_form" in found._repr_html_() and "number: 0.755929" in str(found), "texts of critical")
    check("no 'table'" in refused(lambda: found.table, AttributeError), "a table of critical")
    check("no picture of critical" in refused(found.plot), "a picture of critical")
    survey = mpmstab.critical(survey=True, ppc=1)
    check(len(survey.rows["formulation"]) > 40 and not survey.json, "survey")


def check_spectrum():
    """Eigenvalues of matrices are numpy's, factors of blocks their polynomial."""
    turn = 0.9 * numpy.array([[0, -1, 0], [1, 0, 0], [0, 0.5, 0.5]])
    own = numpy.sort_complex(numpy.linalg.eigvals(turn))
    numpy.savez("turn.npz", data=turn[turn != 0], indices=numpy.nonzero(turn)[1], indptr=[0, 1, 2, 4], shape=(3, 3),
                format=b"csr")
    for matrix in (turn, scipy.sparse.coo_matrix(turn), turn.tolist(), "turn.npz"):
        found = mpmstab.spectrum(matrix=matrix)
        values = numpy.sort_complex(found.eigenvalues)
        check(numpy.allclose(values, own, rtol=1e-14, atol=1e-15), f"{values}")
        check(abs(found.growth - 0.9) < 1e-14 and found.verdict == "stable", f"growth {found.growth}")
    check("shape (3,)" in refused(lambda: mpmstab.spectrum(matrix=[1, 2, 3])), "a vector as a matrix")
    for says, matrix in (("its parts differ", [[1, 2], [3]]), ("numbers of the type complex128", [[1j]]),
                         ("numbers of the type <U1", [["a"]])):
        check(f"matrix: {says}" in refused(lambda: mpmstab.spectrum(matrix=matrix)), matrix)
    for says, blocks in (("a dictionary", {}), ("matrix_blocks: its parts differ", {0: [[1]], 1: [[1, 2]]}),
                         ("keys of matrix_blocks: its parts differ", {0: [[1]], (0, 1): [[1]]}),
                         ("type complex128", {0: [[1j]]}), ("keys of matrix_blocks: numbers of the type <U1", {"a": [[1]]})):
        check(says in refused(lambda: mpmstab.symbol(matrix_blocks=blocks)), blocks)
    check("no picture of a matrix" in refused(found.plot), "a picture of a matrix")

    first, second = numpy.array([[0.5, 0.1], [0, 0.25]]), numpy.array([[0.25, 0], [0.2, 0.5]])
    found = mpmstab.symbol(matrix_blocks={0: first, 1: second}, phases=8)
    for beta, factors in zip(found.beta, found.factors):
        own = numpy.linalg.eigvals(first + second * numpy.exp(-1j * beta))
        check(numpy.allclose(numpy.sort_complex(factors), numpy.sort_complex(own), rtol=1e-13), f"{factors}, not {own}")


def check_symbol_and_map():
    found = mpmstab.spectrum(**SCENE, powers=20, pseudospectrum=8)
    check(abs(abs(found.eigenvalues).max() ** (1 / 8) - found.growth) < 1e-12, f"growth {found.growth}")
    check(found.factors.shape == (8, 4) and found.beta.shape == (32,), f"{found.factors.shape}, {found.beta.shape}")
    check(abs(abs(found.factors).max() ** (1 / 8) - found.growth) < 1e-9, "factors beside eigenvalues")
    check(numpy.nanmax(found.transient.norm) == found.transient.largest and len(found.norm) == len(found.steps),
          f"{found.transient}")
    before = dict(matplotlib.rcParams)
    for kind in (None, "symbol", "modes", "transient", "pseudospectrum"):
        check(found.plot(kind)._repr_png_().startswith(b"\x89PNG"), f"picture {kind}")
    check(dict(matplotlib.rcParams) == before, "a picture has changed the settings of matplotlib")
    check("allowed: spectrum, symbol" in refused(lambda: found.plot("growth")), "a picture that spectrum has not")

    with contextlib.redirect_stderr(io.StringIO()) as shown:
        found = mpmstab.map(cells=8, map_points=(3, 4), ranks=2, progress=True)
    check("\rpart " in shown.getvalue() and "\n" not in shown.getvalue(), f"progress {shown.getvalue()!r}")
    check(found.table.shape == (3, 4) and list(found.map.shape) == [3, 4], f"shape {found.table.shape}")
    check(numpy.array_equal(found.table.ravel(), found.rows["growth"]), "table and rows of a map")
    check(numpy.array_equal(numpy.repeat(found.map.courant, 4), found.rows["courant"]), "axis of a map")
    check(numpy.isnan(found.map.corrected_limit[1]) and set(found.rows["verdict"]) == {"stable", "unstable"}, "map")
    found.plot().save("map")
    check(os.path.getsize("map.png") > 1000 and "<svg" in text_of("map.svg"), "files of a picture")


def check_runs():
    """Fields are the same on two ranks; an expectation may be missed; a scheme may be a text."""
    own = {**SCENE, "courant": 0.25, "steps": 16, "output_every": 8}
    one, two = mpmstab.run(**own), mpmstab.run(**own, ranks=2, output="two.h5")
    path = "step_0000000016/particles/u"
    check((one.ranks, two.ranks) == (1, 2) and os.path.exists("two.h5"), "ranks")
    check(one.array(path).shape == (16,) and numpy.allclose(one.array(path), two.array(path), rtol=0, atol=1e-13), path)
    check(one.rows["step"][-1] == 16 and one.rows["energy"][-1] == one.run.energy.final, "rows of a run")
    for kind in ("growth", "spacetime", "frame"):
        check(two.plot(kind)._repr_png_().startswith(b"\x89PNG"), f"picture {kind}")
    found = mpmstab.run(**SCENE, expect_growth=(3, 4), output=False)
    check(found.expectation_missed and "expected" in found.complaint and not found.arrays, f"{found.complaint}")
    check(not one.expectation_missed and found.verdict, "an expectation that nobody had is missed")
    plane = mpmstab.run(dim=2, cells=4, steps=2)
    check("dim 1" in refused(lambda: plane.plot("spacetime")), "a picture over place and time in two dimensions")
    found = mpmstab.ensemble(cells=8, jitter=0.3, layouts=3)
    check(found.rows["growth"].max() == found.ensemble.growth_max and found.ensemble.layouts == 3, "ensemble")

    text = subprocess.check_output([program.find(), "list", "formulation", "musl"], text=True)
    written, built_in = mpmstab.symbol(scheme=text, **SCENE), mpmstab.symbol(formulation="musl", **SCENE)
    check(numpy.array_equal(written.factors, built_in.factors) and built_in.growth > 1, "musl as a text")
    scene = "formulation: musl\ncells: 8\ndrift: 1/8\n"
    check(numpy.array_equal(mpmstab.symbol(scene, ppc=2).factors, built_in.factors), "a scene as a text")


def check_refusals(path):
    done = subprocess.run([path, "run", "-corant", "1"], capture_output=True, text=True, check=False)
    for ranks in (1, 2):
        said = refused(lambda: mpmstab.run(corant=1, ranks=ranks))
        check(f"mpmstab: {said}\n" == done.stderr and "did you mean -courant?" in said, f"{ranks} ranks: {said}")
    check("ranks 0" in refused(lambda: mpmstab.run(ranks=0)), "no ranks")
    os.environ["MPMSTAB"] = "nowhere/mpmstab"
    check("MPMSTAB nowhere/mpmstab" in refused(mpmstab.run, mpmstab.NotBuilt), "a program that is not there")
    os.environ["MPMSTAB"] = "/bin/false"
    check("status 1" in refused(mpmstab.run, mpmstab.Failed), "a program without a result")
    os.environ["MPMSTAB"] = path


def marked():
    """Returns the processes that have the mark in their environment."""
    found = []
    for number in filter(str.isdigit, os.listdir("/proc")):
        with contextlib.suppress(OSError), open(f"/proc/{number}/environ", "rb") as file:
            if f"{MARK}={os.getpid()}".encode() in file.read().split(b"\0"):
                found.append(number)
    return found


def check_interrupt():
    """SIGINT to Python alone, as a notebook sends it, ends the program and all its ranks and leaves no files."""
    os.mkdir("interrupted")
    for ranks in (1, 2):
        call = f"import mpmstab; mpmstab.map(cells=4096, map_points=(1000, 1000), ranks={ranks})"
        with subprocess.Popen([sys.executable, "-c", call], stderr=subprocess.PIPE, text=True, start_new_session=True,
                              env={**os.environ, "PYTHONPATH": PACKAGE, MARK: str(os.getpid()),
                                   "TMPDIR": os.path.abspath("interrupted")}) as python:
            deadline = time.monotonic() + 60
            expected = 1 + ranks + (ranks > 1)  # Python, the ranks and mpirun
            while len(marked()) < expected and python.poll() is None and time.monotonic() < deadline:
                time.sleep(0.05)
            check(len(marked()) >= expected, "the program has not been started")
            time.sleep(0.2)
            os.kill(python.pid, signal.SIGINT)
            said = python.stderr.read()
        check("KeyboardInterrupt" in said and python.returncode == -signal.SIGINT, f"{python.returncode}: {said}")
        while marked() and time.monotonic() < deadline:
            time.sleep(0.05)
        check(not marked(), f"after Ctrl-C there are still the processes {marked()}")
        left = [name for name in os.listdir("interrupted") if name.startswith("mpmstab-")]
        check(not left, f"{left} are left")


def check_installed(path):
    """pip installs the package, with the pictures, from a folder that has no more than its sources."""
    missing = [name for name in ("pip", "setuptools", "wheel") if not importlib.util.find_spec(name)]
    if missing:
        print(f"check_package: the package is not installed by pip: this Python has no {missing[0]}")
        return
    for part in ("python", "report"):
        shutil.copytree(os.path.join(SCRIPTS, part), f"clone/scripts/{part}",
                        ignore=shutil.ignore_patterns("build", "*.egg-info", "__pycache__"))
    os.mkdir("clone/build")
    os.symlink(path, "clone/build/mpmstab")
    done = subprocess.run([sys.executable, "-m", "pip", "install", "-q", "--no-index", "--no-deps", "--no-build-isolation",
                           "--no-compile", "--target", "installed", "clone/scripts/python"],
                          capture_output=True, text=True, check=False)
    check(done.returncode == 0, f"pip: {done.stderr}")
    call = ("import mpmstab; from importlib.metadata import version; r = mpmstab.symbol(cells=4); "
            "print(mpmstab.__file__, mpmstab.program.find(), version('mpmstab'), r.version, "
            "r.plot()._repr_png_()[1:4].decode())")
    own = {name: value for name, value in os.environ.items() if name != "MPMSTAB"}
    done = subprocess.run([sys.executable, "-c", call], capture_output=True, text=True, check=False,
                          env={**own, "PYTHONPATH": os.path.abspath("installed")})
    said = done.stdout.split()
    check(done.returncode == 0 and said[0] == os.path.abspath("installed/mpmstab/__init__.py")
          and said[1] == os.path.abspath("clone/build/mpmstab") and said[2] == said[3] and said[4] == "PNG",
          f"the installed package: {done.stdout}{done.stderr}")


def main(path):
    os.environ["MPMSTAB"] = path
    for name in program.MPI:
        os.environ.pop(name, None)  # the package sets them itself
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        tempfile.tempdir = os.path.join(folder, "temporary")
        os.mkdir(tempfile.tempdir)
        check_words()
        check_same(path)
        check_spectrum()
        check_symbol_and_map()
        check_runs()
        check_refusals(path)
        gc.collect()
        check(not os.listdir(tempfile.tempdir), f"{os.listdir(tempfile.tempdir)} are left by results that are gone")
        tempfile.tempdir = None
        check_interrupt()
        check_installed(path)
        os.chdir("/")


if __name__ == "__main__":
    main(sys.argv[1])
