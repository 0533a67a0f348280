#!/usr/bin/python3
"""Checks the limit of a run of mpm88 that breaks: another program, with the particles as they stood, lives below and dies above.

check_layout_mpm88.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import csv
import os
import subprocess
import sys

import numpy

import falling_fluid as mpm88
from checks import check, forks, loaded

SCHEME = "usl -transfer apic -gradient mls -basis quadratic -dim 2 -cells 16 -length 1 -poisson 0.5 -density 1 -wave_speed 20"


def growth(x, J, dt, steps):
    """Factor by which a small motion of the particles grows from where they are, and the velocities at the end."""
    v, C, first, rest = 1e-10 * numpy.random.default_rng(4).standard_normal(x.shape), numpy.zeros((len(x), 2, 2)), None, J
    for _ in range(steps):
        x, v, C, J = mpm88.step(x, v, C, J, dt, 0.0, rest)
        first = numpy.linalg.norm(v) if first is None else first
    check(abs(J / rest - 1).max() < 0.01, "the motion is not small")
    return numpy.linalg.norm(v) / first, v


def main():
    program = os.path.join(os.path.dirname(os.path.abspath(__file__)), "falling_fluid.py")
    subprocess.run([sys.executable, program, "particles.csv"], check=True, capture_output=True)
    done = forks.run([sys.argv[2], "critical", *SCHEME.split(), "-layout", "particles.csv", "-write_layout", "found.csv",
                      "-json", "found.json"], capture_output=True, text=True, check=False)
    check(done.returncode == 0, done.stderr)
    found = loaded("found.json")["critical"]
    limit = found["critical_dt"]
    check(limit < mpm88.FACTOR * mpm88.DT, f"the step that breaks is below the limit {limit}")
    decides = [found["bounds"]["particle_decided_by"]["id"], found["mode_fastest"]["id"]]
    check(f"{limit:.4g}" == "0.002717" and decides == [54, 54], f"the README of your-layout has other numbers: {limit} {decides}")
    check(limit > mpm88.DT, f"mpm88's own step is above the limit {limit}")
    with open("found.csv", encoding="utf-8") as file:
        rows = [{name: float(cell) for name, cell in row.items()} for row in csv.DictReader(file)]
    x = numpy.array([[row["x"], row["y"]] for row in rows])
    mode = numpy.array([[row["mode_x"], row["mode_y"]] for row in rows])
    J = numpy.array([row["volume"] for row in rows]) / mpm88.VOLUME
    below, _ = growth(x, J, 0.99 * limit, 250)
    above, _ = growth(x, J, 1.01 * limit, 150)
    _, v = growth(x, J, 1.02 * limit, 90)
    check(below < 1, f"1 % below the limit mpm88 grows by {below}")
    check(above > 1e3, f"1 % above the limit mpm88 grows by {above} only")
    along = abs((v * mode).sum()) / numpy.linalg.norm(v) / numpy.linalg.norm(mode)
    check(along > 0.9, f"what grows in mpm88 is not the mode: cosine {along}")


main()
