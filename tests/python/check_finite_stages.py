#!/usr/bin/python3
"""Steps of several stages at finite strain: growth about uniform states, energy of relaxed steps, order in time.

check_finite_stages.py MPIEXEC MPMSTAB. Silent when all is well.
"""
import csv
import json
import math
import os
import sys
import tempfile

import h5py
import numpy as np

from checks import check, on_ranks

MPMSTAB = sys.argv[-1]
SHAKEN = ("-kinematics finite -material neo -dim 2 -cells 8 -cell_width 1 -basis quadratic -mach 0.1,0 -initial mode "
          "-mode 1,0 -amplitude 0.3 -courant 0.6 -steps 500").split()


def ask(task, *words, ranks=1):
    done = on_ranks(ranks, MPMSTAB, task, *words, "-json", "out.json")
    check(done.returncode == 0, f"{task} {' '.join(words)}: status {done.returncode}: {done.stderr}")
    with open("out.json", encoding="utf-8") as file:
        return json.load(file)


def check_uniform(scheme, stretch, dim):
    """The tangent about a uniform stretch has the growth of the linear scheme about it."""
    cells = {1: "12", 2: "4,3"}[dim]
    words = ["-formulation", *scheme.split(), "-material", "neo", "-stretch", str(stretch), "-basis", "cubic", "-dim", str(dim),
             "-cells", cells, "-offset", "0.3", "-courant", "0.7"]
    if dim == 1:
        words += ["-lame_ratio", "0.7"]
    linear = ask("spectrum", *words)["growth"]
    tangent = ask("spectrum", *words, "-kinematics", "finite", "-initial", "uniform")["growth"]
    check(abs(tangent - linear) < 1e-6, f"{scheme}, F0 = {stretch}, dim {dim}: the tangent has {tangent}, the linear scheme {linear}")


def energies(*words):
    """The energy of each step, and what the run says."""
    found = ask("run", *SHAKEN, *words, "-csv", "series.csv")["run"]
    with open("series.csv", encoding="utf-8") as file:
        return np.array([float(row["energy"]) for row in csv.DictReader(file)]), found


def check_relaxed(*words):
    """No relaxed step raises the energy, and some step that is not relaxed does."""
    plain, _ = energies(*words)
    energy, found = energies(*words, "-rk_relax")
    rise = (np.diff(energy) / energy[0]).max()
    check(rise <= 3e-15, f"{words}: a relaxed step raises the energy by {rise:.1e}")
    check((np.diff(plain) / plain[0]).max() > 1e-8, f"{words}: no step raises the energy, so that nothing is tested")
    check(0.9 < found["relaxed"]["least_factor"] < 1 and found["relaxed"]["steps"] > 0, f"{words}: {found['relaxed']}")
    check(found["momentum_change"] < 1e-13, f"{words}: momentum changes by {found['momentum_change']}")
    return energy


def check_ranks():
    one = ask("run", *SHAKEN, "-formulation", "rk", "-rk_relax")["run"]
    two = ask("run", *SHAKEN, "-formulation", "rk", "-rk_relax", ranks=2)["run"]
    check(one["relaxed"]["steps"] == two["relaxed"]["steps"], f"two ranks relax {two['relaxed']}, one {one['relaxed']}")
    check(abs(one["energy"]["final"] - two["energy"]["final"]) < 1e-10, "two ranks have another energy")


def state(scheme, courant):
    """Places, F and velocity at the end of a vibration of an eighth of the speed of sound, particles by id."""
    ask("run", *"-kinematics finite -material neo -basis cubic -cells 16 -cell_width 1 -offset 0.4 -initial mode "
        "-amplitude 0.05".split(), "-formulation", *scheme.split(), "-courant", str(courant), "-steps",
        str(round(16 / courant)), "-output", "fields.h5")
    with h5py.File("fields.h5") as file:
        last = file[max((key for key in file if key.startswith("step_")), key=lambda key: int(key[5:]))]["particles"]
        return {name: last[name][...] for name in ("coordinates", "f", "v")}


def check_order(scheme, orders):
    """Halving the step three times: the order in time of places, F and velocity, against a fine step."""
    fine, errors = state(scheme, 1 / 256), {}
    for courant in (1 / 4, 1 / 8, 1 / 16):
        for name, values in state(scheme, courant).items():
            errors.setdefault(name, []).append(np.sqrt(np.mean((np.remainder(values - fine[name] + 8, 16) - 8) ** 2)))
    for name, least in zip(errors, orders):
        order = math.log2(errors[name][0] / errors[name][-1]) / 2
        check(least - 0.15 < order < least + 0.35, f"{scheme}: {name} has order {order:.2f}, not {least}")


def particles(*words, ranks=1):
    """What particles have after some steps in which they move to other cells, by id."""
    ask("run", *"-kinematics finite -material neo -dim 2 -cells 12,8 -cell_width 1 -basis quadratic -jitter 0.3 -mach 0.6,0.3 "
        "-initial mode -mode 1,1 -amplitude 0.2 -courant 0.8 -steps 24 -formulation rk -rk_places stages -output fields.h5".split(),
        *words, ranks=ranks)
    with h5py.File("fields.h5") as file:
        last = file[max((key for key in file if key.startswith("step_")), key=lambda key: int(key[5:]))]["particles"]
        return {name: last[name][...] for name in ("coordinates", "v", "f_xx", "f_yy") if name in last}


def check_places():
    """Stages that move particles: both marches, on 1, 2 and 3 ranks; no growth in a compressed bar, where frozen places give some."""
    one = particles()
    for march, ranks in (("fast", 3), ("plain", 2)):
        other = particles("-march", march, ranks=ranks)
        for name, values in one.items():
            off = np.abs(np.remainder(values - other[name] + 4, 8) - 4).max()
            check(off < 1e-12, f"march {march} on {ranks} ranks: {name} is off by {off:.1e}")
    for places, least, most in (("frozen", 1e-2, 1), ("stages", -1, 1e-7)):
        growth = ask("spectrum", *"-kinematics finite -formulation rk -material neo -stretch 0.7 -basis quadratic -cells 12 "
                     "-courant 1/2 -initial uniform -rk_places".split(), places)["growth"] - 1
        check(least < growth < most, f"places {places}: growth - 1 is {growth:.1e} in compression")
    for task in ("spectrum", "critical"):
        one, two = (ask(task, *"-formulation rk -basis quadratic -cells 12 -rk_places".split(), places) for places in
                    ("frozen", "stages"))
        check(one["growth"] == two["growth"] and one.get("critical", {}).get("critical_courant") ==
              two.get("critical", {}).get("critical_courant"), f"{task}: at rest and small strain places make a difference")


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for scheme in ("verlet", "verlet -move_share 1/2", "rk -rk kg5", "rk -rk_on nodes -move_share 3/4"):
            for stretch, dim in ((1.8, 1), (0.7, 1), (1.3, 2)):
                check_uniform(scheme, stretch, dim)
        check_relaxed("-formulation", "rk")
        check_relaxed("-formulation", "rk", "-jitter", "0.3")
        check_ranks()
        check_places()
        check_order("rk", (1, 1, 1))
        check_order("rk -rk_places stages", (2, 2, 2))
        check_order("verlet", (2.2, 1.2, 1))
        check_order("verlet -move_share 1/2", (1.3, 1.25, 1))


main()
