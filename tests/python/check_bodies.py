#!/usr/bin/python3
"""Bodies of particles by shape and from files, against what is exact: the same particles by other words, free flight, the
velocity between two bars that meet, and equal results on all ranks.

check_bodies.py MPIEXEC MPMSTAB. Silent when all is well.
"""
import math
import subprocess
import sys
import tempfile
import os

import h5py
import numpy as np

from checks import check

MPIEXEC, MPMSTAB = sys.argv[1:]
SCENE = ("-dim 2 -kinematics finite -formulation usl -basis quadratic -cells 16 -length 1 -boundary free -ppc 2 "
         "-material neo -poisson 0.3 -density 1000 -young 1e5").split()


def run(*words, ranks=1):
    launch = [MPIEXEC, "-q", "-n", str(ranks)] if ranks > 1 else []
    done = subprocess.run([*launch, MPMSTAB, "run", *words], capture_output=True, text=True, check=False)
    check(done.returncode == 0, f"{' '.join(words)}: status {done.returncode}: {done.stderr}")


def steps(path):
    """The time and the arrays of the particles of each step of a file."""
    with h5py.File(path) as file:
        return [(file[key].attrs["time"], {name: item[...] for name, item in file[key + "/particles"].items()})
                for key in sorted(key for key in file if key.startswith("step_"))]


def compare(what, one, other, bound):
    for name in one:
        if name != "id":
            size = max(1, np.abs(one[name]).max())
            off = np.abs(one[name] - other[name]).max() / size
            check(off <= bound, f"{what}: {name} is off by {off}")


def check_same():
    """A box that fill names, that bodies name, and whose particles a file has."""
    words = [*SCENE, "-gravity", "0,-9.81", "-courant", "0.3", "-steps", "60", "-colliders",
             "{shape: plane, point: [0.5, 0.2], normal: [0, 1], contact: separating}"]
    run(*words, "-fill", "4,9,4,8", "-initial", "uniform", "-output", "fill.h5")
    run(*words, "-bodies", "{shape: box, center: [0.40625, 0.375], size: [0.3125, 0.25]}", "-output", "body.h5")
    with h5py.File("fill.h5") as file:
        x = file["step_000000/particles/coordinates"][...] if "step_000000" in file else \
            file[min(key for key in file if key.startswith("step_"))]["particles/coordinates"][...]
    np.savetxt("box.csv", x, delimiter=",", header="x,y", fmt="%.17g")
    run(*words, "-bodies", "{shape: file, path: box.csv}", "-output", "file.h5")
    for name in ("body", "file"):
        compare(f"fill and {name}", steps("fill.h5")[-1][1], steps(f"{name}.h5")[-1][1], 1e-11)


def check_flight():
    """Bodies that nothing touches keep their velocity, whatever they are made of, and fall as points do."""
    bodies = ("[{shape: sphere, center: [0.2, 0.6], radius: 0.12, velocity: [0.5, 1], density: 300}, "
              "{shape: cylinder, from: [0.7, 0.6], to: [0.85, 0.7], radius: 0.07, velocity: [-0.2, 0.3], young: 3e5, ppc: 3}]")
    run(*SCENE, "-gravity", "0,-2", "-bodies", bodies, "-dt", "0.001", "-time", "0.1", "-output", "fly.h5",
        "-output_interval", "0.03")
    all_steps = steps("fly.h5")
    check([round(time, 9) for time, _ in all_steps] == [0, 0.03, 0.06, 0.09, 0.1],
          f"output at {[time for time, _ in all_steps]}")
    first, (time, last) = all_steps[0][1], all_steps[-1]
    n = round(time / 0.001)
    light = np.isclose(first["v_x"], 0.5)
    check(0 < light.sum() < len(light), "two bodies")
    fall = -2 * 0.001**2 * n * (n + 1) / 2
    way = last["coordinates"] - first["coordinates"]
    for body, v in ((light, (0.5, 1)), (~light, (-0.2, 0.3))):
        check(np.abs(way[body] - (v[0] * time, v[1] * time + fall)).max() < 1e-12, f"flight with {v}")
        check(np.abs(last["v_y"][body] - (v[1] - 2 * time)).max() < 1e-12, f"fall with {v}")


def check_bars():
    """Two bars meet with impedances Z = rho c of 1 and 4 times 3: between the waves they have the velocity (Z v + Z' v') /
    (Z + Z'), and the pressure Z Z' (v - v') / (Z + Z')."""
    bodies = ("[{shape: box, center: 0.24, size: 0.48, velocity: 0.01}, "
              "{shape: box, center: 0.76, size: 0.48, velocity: -0.01, density: 4, young: 9}]")
    run("-kinematics", "finite", "-formulation", "usl", "-basis", "quadratic", "-transfer", "apic", "-material", "neo",
        "-cells", "400", "-boundary", "free", "-density", "1", "-young", "1", "-bodies", bodies, "-courant", "0.2",
        "-time", "2.2", "-output", "bars.h5")
    last = steps("bars.h5")[-1][1]
    x = last["coordinates"][:, 0]
    middle = last["v"][(x > 0.45) & (x < 0.55)] if "v" in last else last["v_x"][(x > 0.45) & (x < 0.55)]
    z = 1, math.sqrt(4 * 9)
    expected = (z[0] * 0.01 - z[1] * 0.01) / sum(z)
    check(len(middle) > 10 and abs(np.median(middle) - expected) < 2e-4, f"between the waves {np.median(middle)}, not {expected}")


def check_ranks():
    bodies = ("[{shape: sphere, center: [0.25, 0.5], radius: 0.15, velocity: [0.8, 0], density: 500}, "
              "{shape: sphere, center: [0.7, 0.55], radius: 0.15, velocity: [-0.8, 0], young: 4e5, ppc: 3}]")
    colliders = ("[{shape: cone, tip: [0.5, 0.4], axis: [0, -1], angle: 40, contact: separating, friction: 0.2}, "
                 "{shape: plane, point: [0, 0.05], normal: [0, 1], contact: slip, velocity: [[0, 0, 0], [0.1, 0, 0.2]]}]")
    words = [*SCENE, "-gravity", "0,-9.81", "-bodies", bodies, "-colliders", colliders, "-courant", "0.2", "-time", "0.15"]
    for ranks in (1, 2, 3):
        run(*words, "-output", f"ranks{ranks}.h5", ranks=ranks)
        if ranks > 1:
            compare(f"{ranks} ranks", steps("ranks1.h5")[-1][1], steps(f"ranks{ranks}.h5")[-1][1], 1e-9)


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    check_same()
    check_flight()
    check_bars()
    check_ranks()
