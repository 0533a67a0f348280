#!/usr/bin/python3
"""Runs with colliders, against what is exact: friction, sticking, no adhesion, energy, and equal results on all ranks.

check_colliders.py MPIEXEC MPMSTAB. Silent when all is well.
"""
import csv
import math
import os
import sys
import tempfile

import h5py
import numpy as np

from checks import check, on_ranks

MPMSTAB = sys.argv[-1]
LAYER = ("-dim 2 -kinematics finite -basis quadratic -cells 12,12 -boundary periodic,free -fill 0,12,3,6 -ppc 2 "
         "-material neo -poisson 0.2 -wave_speed 10 -initial uniform -courant 0.3").split()
BODIES = ("[{shape: plane, point: [0.5, 0.2], normal: [0.1, 1], contact: separating, friction: 0.3}, "
          "{shape: sphere, center: [0.7, 0.2], radius: 0.15, contact: slip}, "
          "{shape: box, center: [0.1, 0.5], size: [0.1, 0.4], contact: sticky, velocity: [0.2, 0]}]")
BLOCK = ("-dim 2 -kinematics finite -basis quadratic -cells 16 -boundary free -fill 5,10,5,10 -ppc 2 -material neo "
         "-poisson 0.3 -wave_speed 10 -initial uniform -gravity 0.3,-1 -courant 0.2 -time 0.7").split()


def run(*words, ranks=1):
    done = on_ranks(ranks, MPMSTAB, "run", *words)
    check(done.returncode == 0, f"{' '.join(words)}: status {done.returncode}: {done.stderr}")


def last(path):
    """The time, and the arrays of the particles, of a file's last step."""
    with h5py.File(path) as file:
        step = max(key for key in file if key.startswith("step_"))
        return file.attrs["dt"] * int(step[5:]), {name: item[...] for name, item in file[step + "/particles"].items()}


def slide(formulation, transfer, friction, angle, time):
    """Time and mean velocity of a layer that starts at rest on a plane. Gravity has the angle with its normal."""
    gravity = math.sin(angle), -math.cos(angle)
    floor = f"{{shape: plane, point: [0.5, 0.25], normal: [0, 1], contact: separating, friction: {friction}}}"
    run(*LAYER, "-formulation", formulation, "-transfer", transfer, "-gravity", f"{gravity[0]},{gravity[1]}", "-time",
        str(time), "-colliders", floor, "-output", "slide.h5")
    at, particles = last("slide.h5")
    return at, gravity, [particles[name].mean() for name in ("v_x", "v_y")]


def check_slide():
    """Each node loses mu times as much velocity along the plane as it gains across it, so the layer does, too. Its mean
    acceleration is sin a - mu cos a but for the bounce that is left across the plane. Below atan mu it sticks: it swings
    and bounces, where without friction it would have a velocity of 0.48."""
    for formulation, transfer in zip(("usl", "musl", "verlet", "rk"), ("flip", "apic", "apic", "flip")):
        what = f"{formulation} {transfer}"
        at, gravity, v = slide(formulation, transfer, 0.2, 0.5, 1)
        ratio = (v[0] - gravity[0] * at) / (v[1] - gravity[1] * at)
        check(abs(ratio + 0.2) < (1e-12 if transfer == "flip" else 1e-4), f"{what}: friction has the ratio {ratio}")
        check(abs(v[0] / at - gravity[0] - 0.2 * gravity[1]) < 0.02, f"{what}: acceleration {v[0] / at}")
        at, gravity, v = slide(formulation, transfer, 0.7, 0.5, 1)
        check(abs(v[0]) < 0.1, f"{what}: it slides at {v[0]} where it should stick")


def check_leaving():
    """A body that leaves a floor keeps all its momentum with contact separating; sticky holds it, and stops in one step
    what is inside. A falling block bounces, and gravity alone acts on it from there."""
    rising = [word if word != "uniform" else "random" for word in LAYER] + ["-amplitude", "1e-9", "-formulation", "usl"]
    for contact, keeps in (("separating", True), ("sticky", False)):
        run(*rising, "-velocity", "0,0.5", "-time", "0.3", "-colliders",
            f"{{shape: plane, point: [0.5, 0.25], normal: [0, 1], contact: {contact}}}", "-output", "leave.h5")
        v = last("leave.h5")[1]["v_y"].mean()
        check((abs(v - 0.5) < 1e-8) == keeps, f"{contact}: a body that leaves goes on at {v} of 0.5")
    run(*rising, "-velocity", "0.3,0.5", "-steps", "1", "-colliders",
        "{shape: plane, point: [0.5, 0.8], normal: [0, 1], contact: sticky}", "-output", "stop.h5")
    left = max(np.abs(last("stop.h5")[1][name]).max() for name in ("v_x", "v_y"))
    check(left < 1e-7, f"particles inside a sticky body keep a velocity of {left:.2e}")
    fall = [word if word != "0.3,-1" else "0,-1" for word in BLOCK[:-2]] + ["-formulation", "usl", "-colliders",
            "{shape: plane, point: [0.5, 0.2], normal: [0, 1], contact: separating}", "-output", "fall.h5"]
    v = []
    for time in ("0.5", "0.7", "0.8"):
        run(*fall, "-time", time)
        v.append(last("fall.h5")[1]["v_y"].mean())
    check(v[0] > 0.2, f"a block does not bounce: {v[0]}")
    check(abs(v[1] - v[2] - 0.1) < 1e-12, f"a floor acts on a block that has left it: {v[1] - v[2]} for 0.1")


def check_energy():
    """Bodies at rest take energy alone, and none comes back. Where particles with flip keep velocities that nodes do not
    see, as with musl, a part of what these have comes back as motion of the nodes, so that this is for other schemes."""
    rest = BODIES.replace(", velocity: [0.2, 0]", "")
    for formulation, transfer in (("usl", "flip"), ("musl", "apic"), ("usf", "apic")):
        run(*BLOCK, "-formulation", formulation, "-transfer", transfer, "-colliders", rest, "-csv", "energy.csv")
        with open("energy.csv", encoding="utf-8") as file:
            energy = np.array([float(row["energy"]) for row in csv.DictReader(file)])
        check(len(energy) == 281 and (np.diff(energy) < 0).all(),
              f"{formulation} {transfer}: of {len(energy)} energies one rises by {np.diff(energy).max():.2e}")


def check_ranks(dim):
    """The plain march and the fast one, on one rank and more, come to the same particles."""
    words, bodies = [*BLOCK, "-formulation", "musl"], BODIES
    if dim == 3:
        words += ["-dim", "3", "-cells", "8", "-fill", "2,5,2,5,2,5", "-gravity", "0.3,0.1,-1"]
        words = words[2:]
        bodies = ("[{shape: plane, point: [0.5, 0.5, 0.3], normal: [0.1, 0.05, 1], contact: separating, friction: 0.3}, "
                  "{shape: sphere, center: [0.7, 0.5, 0.2], radius: 0.2, contact: slip, velocity: [0, 0, 0.1]}]")
    words = list(dict(zip(words[::2], words[1::2])).items())
    words = [word for pair in words for word in pair]
    run(*words, "-colliders", bodies, "-march", "plain", "-output", "plain.h5")
    expected = last("plain.h5")[1]
    for ranks in (1, 3):
        run(*words, "-colliders", bodies, "-output", "fast.h5", ranks=ranks)
        for name, values in last("fast.h5")[1].items():
            apart = np.abs(values - expected[name]).max()
            check(apart < 1e-11, f"dim {dim}, {ranks} ranks: {name} is off by {apart:.2e}")


def check_restart():
    """A run that ends and resumes goes on with bodies where they are by then."""
    words = [*BLOCK[:-2], "-formulation", "usl", "-colliders", BODIES]
    run(*words, "-steps", "200", "-checkpoint", "whole.h5")
    run(*words, "-steps", "90", "-checkpoint", "part.h5")
    run(*words, "-steps", "200", "-restart", "part.h5", "-checkpoint", "resumed.h5", "-output", "resumed_fields.h5")
    run(*words, "-steps", "200", "-output", "whole_fields.h5")
    whole, resumed = last("whole_fields.h5")[1], last("resumed_fields.h5")[1]
    check(all(np.array_equal(whole[name], resumed[name]) for name in whole), "a restart comes to another state")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    check_slide()
    check_leaving()
    check_energy()
    check_ranks(2)
    check_ranks(3)
    check_restart()
