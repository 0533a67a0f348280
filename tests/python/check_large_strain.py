#!/usr/bin/python3
"""Runs the scenes at large strain of examples/ and checks that their pages quote what comes out.

check_large_strain.py MPIEXEC PROGRAM [long]. Silent when all is well.
"""
import os
import re
import sys
import tempfile

import h5py

from checks import ROOT, check, forks, loaded, text_of

MPIEXEC, PROGRAM, *PART = sys.argv[1:]


def launch(name, *options, ranks=1):
    return forks.run([MPIEXEC, "-n", str(ranks), PROGRAM, "run",
                      os.path.join(ROOT, "examples", name, "scene.yaml"), *options],
                     capture_output=True, text=True, check=False)


def run(name, *options, ranks=1):
    """Returns the JSON of a run of a scene, which must meet what the scene or the options expect."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "result.json")
        done = launch(name, "-json", path, *options, ranks=ranks)
        check(done.returncode == 0, f"{name} {' '.join(options)}: status {done.returncode}: {done.stderr}")
        run.said = done.stdout
        return loaded(path)["run"]


def page(name):
    return re.sub(r"\s+", " ", text_of(os.path.join(ROOT, "examples", name, "README.md")))


def quotes(name, *texts):
    found = page(name)
    for text in texts:
        check(text in found, f"the page of {name} does not have '{text}'")


def row(cells, values):
    return " | ".join([f"| {cells}", *[f"{value:.4f}" for value in values]]) + " |"


def check_bar():
    every = "-expect_error", "0,1"
    for cells in (16, 32, 64):
        error = run("manufactured-bar", "-cells", str(cells), *every)["error"]
        quotes("manufactured-bar", row(cells, [error[field]["l2"] for field in "xvf"]))
    hats = [run("manufactured-bar", "-basis", "linear", "-cells", str(cells), *every)["error"]["x"]["l2"]
            for cells in (16, 32, 64)]
    quotes("manufactured-bar", "{:.3f}, {:.3f} and {:.3f}".format(*hats))


def check_tube():
    for cells in (512,) if PART else (64, 128, 256):
        error = run("shock-tube", "-cells", str(cells))["error"]
        quotes("shock-tube", row(cells, [error[field]["l1"] for field in ("v", "rho")]))
    if PART:
        return
    error = run("shock-tube", "-transfer", "flip", "-gradient", "basis", "-expect_error", "0,1")["error"]
    quotes("shock-tube", f"{error['v']['l1']:.3f} and {error['rho']['l1']:.3f} at 128 cells")


def vortex_errors(*options, ranks=1):
    """Returns the largest l2 errors of places, velocities and F, with three digits."""
    error = run("vortex", *options, ranks=ranks)["error"]
    return [f"{max(error[field]['l2'] for field in error if field[0] in names):.3f}" for names in ("xy", "v", "f")]


def check_vortex():
    quotes("vortex", "{} of places, {} of velocities and at most {} of F".format(*vortex_errors(ranks=2)),
           "{}, {} and {}. With A = 1".format(*vortex_errors("-cells", "80", "-expect_error", "0,1")))
    done = launch("vortex", "-amplitude", "1")
    check(done.returncode == 1 and "cells in this step: a cell or more" in done.stderr, f"vortex: {done.stderr}")


def check_cantilever():
    """Its energy; scenes_long has the places of its tip."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "beam.h5")
        energy = run("cantilever", "-output", path, "-output_every", "3000")["energy"]
        with h5py.File(path) as file:
            heights = [file[step]["particles/coordinates"][:, 1] for step in sorted(file) if "step_" in step]
    lost = energy["initial"] - energy["final"]
    gravity = 10 * 8 * (heights[0].mean() - heights[1].mean())  # on the beam's area, which is 8
    quotes("cantilever", f"from {energy['initial']:.1f} to {energy['final']:.1f}",
           f"the lost {lost:.1f} is {100 * lost / gravity:.0f}% of")


def check_steps():
    """The steps that a run chooses, and three numbers that are given in their place."""
    found = run("chosen-steps")
    auto = found["courant_auto"]
    quotes("chosen-steps", f"K = {auto['first_limit']:.6g},", f"dt = {auto['dt_largest']:.6g},", f"falls to {auto['dt_least']:.6g}.",
           f"takes {found['steps']} steps, changes dt {auto['changes']} times")
    check("measured    -             a motion at finite deformation has no growth\n" in run.said,
          "another reason why a motion has no growth")
    other, least = run("chosen-steps", ranks=2)["courant_auto"], auto.pop("decided")
    check(other.pop("decided")["id"] == least["id"] and other == auto, "other steps on two ranks")
    quotes("chosen-steps", f"{auto['certificates']} certificates")
    for courant, words in (("1.08", "(`-courant 1.08`) the run fails at step {}:"), ("0.8", "With `-courant 0.8` it fails at step {}.")):
        done = launch("chosen-steps", "-courant", courant)
        check(done.returncode == 1, f"chosen-steps at {courant}: {done.stdout}")
        quotes("chosen-steps", words.format(re.search(r"step (\d+): particle", done.stderr)[1]))
    beam = run("cantilever", "-courant", "auto", "-time", "0.3", "-expect_energy", "0,2")["courant_auto"]
    check(f"{beam['first_limit']:.6g}, and" in page("chosen-steps") and f"particle {beam['decided']['id']}," in page("chosen-steps"),
          f"cantilever: {beam}")
    fast = launch("cantilever", "-courant", "1.05643")
    check(fast.returncode == 1, f"cantilever: {fast.stdout}")
    quotes("chosen-steps", f"fails at step {re.search(r'step (.+?): particle', fast.stderr)[1]}.")
    run("shock-tube", "-courant", "auto", "-time", "0.15")
    quotes("chosen-steps", f"it ends, after {run('chosen-steps', '-courant', '0.6')['steps']} steps")


if __name__ == "__main__":
    for part in (check_tube, check_cantilever) if PART else (check_steps, check_bar, check_tube, check_vortex):
        part()
