#!/usr/bin/python3
"""Bodies of particles by shape and from files, against what is exact: the same particles by other words, free flight, the
velocity between two bars that meet, each of several materials as in a run of it alone, a ball by its signed distance as by
its formula, and equal results on all ranks.

check_bodies.py MPIEXEC MPMSTAB. Silent when all is well.
"""
import json
import math
import re
import sys
import tempfile
import os
import subprocess

import h5py
import numpy as np

from checks import check, check_one_line, forks

MPIEXEC, MPMSTAB = sys.argv[1:]
SCENE = ("-dim 2 -kinematics finite -formulation usl -basis quadratic -cells 16 -length 1 -boundary free -ppc 2 "
         "-material neo -poisson 0.3 -density 1000 -young 1e5").split()


def run(*words, ranks=1):
    launch = [MPIEXEC, "-q", "-n", str(ranks)] if ranks > 1 else []
    done = forks.run([*launch, MPMSTAB, "run", *words], capture_output=True, text=True, check=False)
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


APART = ["{shape: sphere, center: [0.18, 0.28], radius: 0.12, velocity: [0, -0.4]",
         "{shape: box, center: [0.54, 0.31], size: [0.16, 0.3], velocity: [0, -0.3]",
         "{shape: sphere, center: [0.85, 0.7], radius: 0.1, velocity: [0.8, 0], young: 3e5"]
LAWS = [("sand", "friction_angle", 25), ("mises", "yield", 0.0005), ("neo", "", None)]
PUSH = ["-colliders", "[{shape: plane, point: [0, 0.14], normal: [0, 1], contact: separating, friction: 0.3}, "
        "{shape: box, center: [1.13, 0.5], size: [0.3, 1], contact: separating}]"]


def check_materials():
    """Bodies of several materials that do not touch are what each is in a run of its own: also on ranks, by the plain march, and
    when the run is resumed."""
    words = [word if word != "16" else "32" for word in [*SCENE, *PUSH, "-courant", "0.2", "-steps", "250"]]
    own = [f"{{body}}, material: {law}{f', {key}: {value}' if key else ''}}}" for law, key, value in LAWS]
    both = "[" + ", ".join(text.replace("{body}", body).rstrip("}") + "}" for text, body in zip(own, APART)) + "]"
    run(*words, "-bodies", both, "-output", "all.h5", "-checkpoint", "all.c.h5")
    all_of = steps("all.h5")[-1][1]
    check(set(all_of["material"]) == {0, 1, 2}, f"numbers of materials {set(all_of['material'])}")
    for number, ((law, key, value), body) in enumerate(zip(LAWS, APART)):
        option = [f"-{key}", str(value)] if key else []
        alone = [word if word != "neo" else law for word in words]
        run(*alone, *option, "-bodies", body + "}", "-output", "one.h5")
        one = steps("one.h5")[-1][1]
        here = all_of["material"] == number
        check(0 < here.sum() == len(one["v_x"]), f"{law}: {here.sum()} particles")
        compare(law, {name: item for name, item in one.items() if name in all_of},
                {name: item[here] for name, item in all_of.items()}, 1e-11)
        moved = {"sand": "volume_gain", "mises": "plastic_strain"}.get(law)
        check(not moved or np.abs(one[moved]).max() > 1e-4, f"{law} has not flowed")
    for ranks in (2, 3):
        run(*words, "-bodies", both, "-output", "other.h5", ranks=ranks)
        compare(f"materials on {ranks} ranks", all_of, steps("other.h5")[-1][1], 1e-10)
    run(*words, "-bodies", both, "-output", "other.h5", "-march", "plain")
    compare("materials by the plain march", all_of, steps("other.h5")[-1][1], 1e-10)
    run(*words[:-2], "-steps", "120", "-bodies", both, "-checkpoint", "half.h5")
    run(*words, "-bodies", both, "-restart", "half.h5", "-output", "other.h5", ranks=2)
    compare("materials resumed", all_of, steps("other.h5")[-1][1], 1e-10)


def check_tangent():
    """The tangent's step is the march's, with bodies of several moduli and materials that meet, on either branch."""
    words = ("-dim 2 -kinematics finite -formulation usl -basis quadratic -cells 8 -length 1 -boundary free -ppc 1 -density 1000 "
             "-young 1e5 -poisson 0.3 -courant 0.3 -at_step 10").split()
    one, other = "{shape: box, center: [0.25, 0.5], size: [0.25, 0.25], velocity: [0.5, 0]", \
        "{shape: sphere, center: [0.6, 0.52], radius: 0.2, velocity: [-0.5, 0.1]"
    for left, right in (("", ", young: 3e5"), (", material: sand", ", material: mises, yield: 1e-4, young: 3e5, poisson: 0.1"),
                        (", material: snow", ", material: tait, bulk: 1e5")):
        done = forks.run([MPMSTAB, "spectrum", *words, "-bodies", f"[{one}{left}}}, {other}{right}}}]"], capture_output=True,
                         text=True, check=False)
        found = re.search(r"its step differs from the march's by (\S+)", done.stdout)
        check(found and float(found[1]) < 1e-12, f"tangent with {left} and {right}: {found and found[1]} {done.stderr}")


def write_distance(path, h, center=(0.5, 0.45), radius=0.18):
    x, y = np.meshgrid(np.arange(0.2, 0.8 + h / 2, h), np.arange(0.15, 0.75 + h / 2, h), indexing="ij")
    with h5py.File(path, "w") as file:
        file["distance"] = np.hypot(x - center[0], y - center[1]) - radius
        file["origin"], file["spacing"] = [0.2, 0.15], h


def check_distance():
    """A body by its signed distance has the particles of the ball, and a collider acts as the ball does, to order 1: its
    normal has that order."""
    write_distance("ball.h5", 0.002)
    words = [*SCENE, "-courant", "0.2", "-steps", "60"]
    ball = "{shape: sphere, center: [0.5, 0.45], radius: 0.18"
    run(*words, "-bodies", ball + "}", "-output", "ball.out.h5")
    run(*words, "-bodies", "{shape: distance, path: ball.h5}", "-output", "grid.out.h5")
    compare("particles inside a signed distance", steps("ball.out.h5")[0][1], steps("grid.out.h5")[0][1], 0)
    falls = ["-gravity", "0,-9.81", "-bodies", "{shape: box, center: [0.55, 0.8], size: [0.3, 0.2], velocity: [0, -2]}"]
    run(*words, *falls, "-colliders", ball + ", contact: separating, friction: 0.2}", "-output", "ball.out.h5")
    exact, off = steps("ball.out.h5")[-1][1], []
    check(exact["v_y"].max() > -2, "the block has not met the ball")
    for h in (0.02, 0.01, 0.005):
        write_distance("ball.h5", h)
        run(*words, *falls, "-colliders", "{shape: distance, path: ball.h5, contact: separating, friction: 0.2}", "-output",
            "grid.out.h5")
        found = steps("grid.out.h5")[-1][1]
        off.append(np.abs(found["coordinates"] - exact["coordinates"]).max())
    check(off[0] < 1e-3 and off[2] < off[0] / 2.5, f"a ball by its signed distance is off by {off}")


def check_bad_distance():
    """What is no signed distance is refused in one line, on one rank and on two."""
    good = np.hypot(*np.meshgrid(np.linspace(-0.5, 0.5, 11), np.linspace(-0.5, 0.5, 11), indexing="ij")) - 0.3
    holed = good.copy()
    holed[2, 3] = np.nan
    bad = [("its distance has 1 dimension; allowed: as many as the scene, 2", good[0], [0, 0], 0.1),
           ("its distance has 3 dimensions", good[None], [0, 0], 0.1),
           ("its distance has 1 nodes along a direction", good[:1], [0, 0], 0.1),
           ("number 25 of its distance is nan; allowed: finite numbers", holed, [0, 0], 0.1),
           ("its distance is above 0 everywhere", good + 1, [0, 0], 0.1),
           ("its distance is not above 0 everywhere", good - 1, [0, 0], 0.1),
           ("its distance changes by", 100 * good, [0, 0], 0.1),
           ("there is no array origin of 2 numbers", good, [0, 0, 0], 0.1),
           ("there is no array spacing of 2 numbers", good, [0, 0], [0.1, 0.1, 0.1]),
           ("spacing -0.1; allowed: finite numbers above 0", good, [0, 0], -0.1),
           ("origin inf; allowed: finite numbers", good, [0, np.inf], 0.1),
           ("there is no array distance", None, [0, 0], 0.1)]
    for ranks, (says, distance, origin, spacing) in enumerate(bad):
        with h5py.File("bad.h5", "w") as file:
            if distance is not None:
                file["distance"] = distance
            file["origin"], file["spacing"] = origin, spacing
        launch = [MPIEXEC, "-q", "-n", "2"] if ranks == 3 else []
        done = forks.run([*launch, MPMSTAB, "run", *SCENE, "-courant", "0.2", "-steps", "1", "-bodies",
                          "{shape: distance, path: bad.h5}"], capture_output=True, text=True, check=False)
        lines = done.stderr.strip().splitlines()
        check(done.returncode == 2 and len(lines) == 1 and f"bodies: path of body 1: bad.h5: {says}" in lines[0],
              f"{says}: status {done.returncode}: {done.stderr}")
    with h5py.File("large.h5", "w") as file:  # zeros, which a file of 8 MB can have packed; as numbers they take twice what the shell grants
        file.create_dataset("distance", (32000, 32000), chunks=(1000, 1000))
        file["origin"], file["spacing"], file["more"] = [0, 0], 1e-3, np.zeros(1000000)
    done = subprocess.run(["sh", "-c", 'ulimit -v 4000000 && exec "$@"', "sh", MPMSTAB, "run", *SCENE, "-courant", "0.2", "-steps", "1", "-bodies",
                           "{shape: distance, path: large.h5}"], capture_output=True, text=True, check=False)
    check_one_line(done, "a distance larger than memory", "bodies: path of body 1: large.h5: to read it takes about 7.6 GB; allowed: ")


def bound_of(modulus, *words):
    """The bound of the first step in units of time. modulus: rho c^2 of the scene."""
    run(*words, "-courant", "auto", "-steps", "1", "-json", "step.json")
    with open("step.json", encoding="utf-8") as file:
        return json.load(file)["run"]["courant_auto"]["decided"]["number"] / math.sqrt(modulus)


def stiffness(young, nu):
    return young * (1 - nu) / ((1 + nu) * (1 - 2 * nu))


def check_bounds():
    """The bound of bodies of several materials that do not touch is the least of theirs, each with its own Poisson's ratio."""
    without = [word for i, word in enumerate(SCENE) if not {"-young", "-poisson", "-material", "-cells"} & {word, SCENE[max(i - 1, 0)]}]
    without += ["-cells", "32"]
    ball, box = "{shape: sphere, center: [0.25, 0.3], radius: 0.12", "{shape: box, center: [0.7, 0.6], size: [0.2, 0.3]"
    solid = ["-material", "neo", "-young", "3e5", "-poisson", "0.1"]
    for bound in ("lone", "particle"):
        words = [*without, "-step_bound", bound]
        one = bound_of(stiffness(3e5, 0.1), *words, *solid, "-bodies", ball + "}")
        for bulk in ("1e5", "9e5"):
            other = bound_of(float(bulk), *words, "-material", "tait", "-bulk", bulk, "-shear", "0", "-bodies", box + "}")
            both = bound_of(stiffness(1e5, 0.3), *words, "-material", "sand", "-young", "1e5", "-poisson", "0.3", "-bodies",
                           f"[{ball}, material: neo, young: 3e5, poisson: 0.1}}, {box}, material: tait, bulk: {bulk}}}]")
            check(abs(both / min(one, other) - 1) < 1e-12, f"{bound} of both {both}, of each {one} and {other}")


def check_watch():
    """A run with a number for courant says which steps were above the bound: none at 0.9 of it, all at 1.1 of it."""
    words = [*SCENE, "-bodies", "{shape: sphere, center: [0.5, 0.5], radius: 0.3}", "-step_bound", "particle", "-steps", "5"]
    run(*words, "-courant", "auto", "-safety", "1", "-json", "auto.json")
    with open("auto.json", encoding="utf-8") as file:
        auto = json.load(file)["run"]["courant_auto"]
    check([row["share"] for row in auto["under"]] == [1, 0, 0, 0, 0], f"{auto['under']}")
    for part, above in ((0.9, 0), (1.2, 1)):
        run(*words, "-courant", str(part * auto["limit"]), "-json", "watch.json")
        with open("watch.json", encoding="utf-8") as file:
            watch = json.load(file)["run"]["step_watch"]
        shares = [row["share"] for row in watch["under"]]
        check(shares == [1 - above, 1 - above, 0, 0, 0] and watch.get("first_above", 0) == above, f"{part}: {watch}")
        check(watch["decided"]["id"] == auto["decided"]["id"], f"{part}: {watch['decided']}")
    run(*words, "-courant", "0.1", "-json", "watch.json", ranks=2)


def check_ranks():
    bodies = ("[{shape: sphere, center: [0.25, 0.5], radius: 0.15, velocity: [0.8, 0], density: 500}, "
              "{shape: sphere, center: [0.7, 0.55], radius: 0.15, velocity: [-0.8, 0], young: 4e5, ppc: 3}]")
    colliders = ("[{shape: cone, tip: [0.5, 0.4], axis: [0, -1], angle: 40, contact: separating, friction: 0.2}, "
                 "{shape: plane, point: [0, 0.05], normal: [0, 1], contact: slip, velocity: [[0, 0, 0], [0.1, 0, 0.2]]}]")
    words = [*SCENE, "-gravity", "0,-9.81", "-bodies", bodies, "-colliders", colliders, "-courant", "0.2", "-time", "0.15"]
    for ranks in (1, 3):
        run(*words, "-output", f"ranks{ranks}.h5", ranks=ranks)
        if ranks > 1:
            compare(f"{ranks} ranks", steps("ranks1.h5")[-1][1], steps(f"ranks{ranks}.h5")[-1][1], 1e-9)


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    check_same()
    check_flight()
    check_bars()
    check_materials()
    check_tangent()
    check_distance()
    check_bad_distance()
    check_bounds()
    check_watch()
    check_ranks()
