#!/usr/bin/python3
"""The implicit step at finite strain: small waves, uniform states, order in time, energy, ranks, and steps in parts.

check_finite_implicit.py MPIEXEC MPMSTAB. Silent when all is well.
"""
import json
import math
import os
import sys
import tempfile

import h5py
import numpy as np

from checks import check, on_ranks

MPMSTAB = sys.argv[-1]
IMPLICIT = "-kinematics finite -material neo -formulation implicit".split()


def run(*words, ranks=1):
    return on_ranks(ranks, MPMSTAB, *words, "-json", "out.json")


def ask(*words, ranks=1):
    done = run(*words, ranks=ranks)
    check(done.returncode == 0, f"{' '.join(words)}: status {done.returncode}: {done.stderr}")
    with open("out.json", encoding="utf-8") as file:
        return json.load(file)


def particles(*words, ranks=1):
    """The particles by id at the end of a run."""
    ask("run", *words, "-output", "fields.h5", ranks=ranks)
    with h5py.File("fields.h5") as file:
        last = file[max((key for key in file if key.startswith("step_")), key=lambda key: int(key[5:]))]["particles"]
        return {name: last[name][...] for name in last}


def check_small_waves(words):
    """At a small amplitude the step is the linear one, but for terms of second order in the amplitude."""
    words = ["-formulation", "implicit", "-basis", "quadratic", "-courant", "2", "-steps", "3", "-initial", "mode", *words.split()]
    apart = []
    for amplitude in (1e-4, 1e-5):
        finite, linear = (particles(*words, "-amplitude", str(amplitude), *kinematics)
                          for kinematics in (["-kinematics", "finite", "-material", "neo"], []))
        apart.append(max(np.abs(finite[name] - linear[name]).max() for name in linear if name.startswith("v")) / amplitude)
    check(apart[1] < 1e-4 and 5 < apart[0] / apart[1] < 20, f"{words}: small waves differ from the linear step's by {apart}")


def check_uniform(theta, stretch, dim):
    """The tangent about a uniform stretch has the growth of the linear scheme about it, and of its symbol."""
    words = ["-formulation", "implicit", "-theta", str(theta), "-material", "neo", "-stretch", str(stretch), "-basis", "cubic",
             "-dim", str(dim), "-cells", {1: "8", 2: "3,3"}[dim], "-offset", "0.3", "-courant", "1.5"]
    linear, symbol = (ask(task, *words)["growth"] for task in ("spectrum", "symbol"))
    tangent = ask("spectrum", *words, "-kinematics", "finite", "-initial", "uniform")["growth"]
    check(abs(tangent - linear) < 1e-6 and abs(linear - symbol) < 1e-6,
          f"theta {theta}, F0 = {stretch}, dim {dim}: the tangent has {tangent}, the linear scheme {linear}, its symbol {symbol}")
    if theta < 0.5:
        check(linear > 1.001, f"theta {theta}: no growth, so that nothing is compared")


def check_order():
    """Against the exact solution of the manufactured problem, with a time step like the cells: order 2."""
    errors = []
    for cells in (32, 128):
        errors.append(ask("run", *IMPLICIT, *"-basis cubic -initial manufactured -ppc 4 -amplitude 0.05 -courant 2".split(),
                          "-cells", str(cells), "-steps", str(cells // 4))["run"]["error"])
    for name in errors[0]:
        order = math.log2(errors[0][name]["l2"] / errors[1][name]["l2"]) / 2
        check(1.85 < order < 2.1, f"{name} has order {order:.2f}")


def check_energy():
    """A vibration of 0.3 c at k = 5: the midpoint rule makes no energy, and usl breaks."""
    shaken = ("-kinematics finite -material neo -dim 2 -cells 8 -cell_width 1 -basis quadratic -mach 0.1,0 -initial mode "
              "-mode 1,0 -amplitude 0.3 -courant 5 -steps 60").split()
    for transfer in ("flip", "apic", "blend"):
        found = ask("run", *shaken, "-formulation", "implicit", "-transfer", transfer, "-csv", "series.csv")["run"]
        energy = np.genfromtxt("series.csv", delimiter=",", names=True)["energy"]
        rise = 1.1 if transfer == "apic" else 1.001  # the energy is without that of the affine part, in which some is at times
        check(len(energy) == 61 and energy.max() <= energy[0] * rise and energy[-1] < energy[0] / 2,
              f"{transfer}: energy from {energy[0]} to {energy.max()}")
        check(2 < found["newton_per_step"] < 20 < found["iterations_per_step"], f"{transfer}: {found}")
    check(run("run", *shaken, "-formulation", "usl").returncode == 1, "usl does not break at k = 5")


def check_ranks():
    words = [*IMPLICIT, *"-dim 2 -cells 12 -basis quadratic -jitter 0.4 -initial random -amplitude 0.05 -courant 5 -steps 5".split(),
             *"-boundary fixed,periodic -transfer apic".split()]
    one, *others = (particles(*words, ranks=ranks) for ranks in (1, 3))
    for other in others:
        for name, values in one.items():
            check(np.abs(values - other[name]).max() < 1e-11, f"{name} depends on the ranks")


def check_parts():
    """A step that would take a particle a cell is taken in parts; without halvings the run ends, and goes on from its checkpoint."""
    words = [*IMPLICIT, *"-cells 8 -cell_width 1 -basis quadratic -initial mode -amplitude 0.6 -courant 5 -steps 12".split()]
    whole = ask("run", *words)["run"]
    check(whole["halved"]["parts"] >= 2 and whole["halved"]["steps"] >= 1, f"no step was halved: {whole}")
    failed = run("run", *words, "-halvings", "0", "-checkpoint", "last.chk")
    check(failed.returncode == 1 and "a cell or more" in failed.stderr and "more -halvings" in failed.stderr and
          "the checkpoint has the state of step" in failed.stderr, f"status {failed.returncode}: {failed.stderr}")
    again = ask("run", *words, "-restart", "last.chk")["run"]
    check(abs(again["energy"]["final"] - whole["energy"]["final"]) < 1e-11, f"{again['energy']} is not {whole['energy']}")
    stuck = run("run", *words, "-halvings", "2", "-implicit_snes_max_it", "1", "-checkpoint", "first.chk")
    check(stuck.returncode == 1 and "step 1 from t = 0 on: the nonlinear system" in stuck.stderr and "in 4 parts" in stuck.stderr
          and "DIVERGED_MAX_IT" in stuck.stderr and "the state of step 0" in stuck.stderr, stuck.stderr)


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        check_small_waves("-cells 8")
        check_small_waves("-dim 2 -cells 5,4 -jitter 0.3 -boundary fixed,periodic -transfer blend -mode 1,0")
        for theta, stretch, dim in ((0.1, 1.8, 1), (0.1, 0.7, 1), (0.1, 1.3, 2), (0.5, 0.7, 1)):
            check_uniform(theta, stretch, dim)
        check_order()
        check_energy()
        check_ranks()
        check_parts()


main()
