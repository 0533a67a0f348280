#!/usr/bin/python3
"""Runs of materials that flow: waves of metal, steps that live and steps that do not, restarts and other ranks.

check_plastic.py MPIEXEC MPMSTAB. Silent when all is well.
"""
import json
import math
import os
import sys

import numpy as np

from checks import check, check_same_runs, forks, loaded, on_ranks, particles

MPMSTAB = sys.argv[-1]
EXAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../examples")
NOISE = "-kinematics finite -formulation usl -basis quadratic -cells 32 -initial random -amplitude 1e-3 -lame_ratio 1 -stretch 0.9".split()
# dense metal that hardens, sand, and snow that has packed together before the first step ends
LIVES = {"mises": "-material mises -yield 0.05 -hardening 0.3", "snow": "-material snow", "sand": "-material sand"}
FLOWS = {"mises": "-material mises -yield 0.002 -saturation 0.01", "snow": "-material snow -hardening 5",
         "sand": "-material sand", "clay": "-material clay -yield 0.002"}
DIMS = {"mises": (1, 3), "snow": (2,), "sand": (3,), "clay": (2,)}  # each law in one at least
INTERNAL = {"mises": "plastic_strain", "snow": "plastic_volume", "sand": "volume_gain", "clay": "plastic_loss"}


def run(ranks, *words):
    return on_ranks(ranks, MPMSTAB, "run", *words)


def done(ranks, *words):
    process = run(ranks, *words)
    check(process.returncode == 0, f"{' '.join(words)}: status {process.returncode}: {process.stderr}")
    return process.stdout


def check_wave():
    """
    Metal that is hit carries a wave of its yield stress, of speed 1, and behind it a plastic one, of speed sqrt(dT/de) of
    uniaxial strain: T = K e + 2/3 Y(q), q = (2 mu e - Y) / (H + 3 mu). Speeds are in the material ahead of the wave, and
    are taken between two times, since a wave is some cells wide from the start on.
    """
    lam, mu, limit, hardening, velocity = 3 / 7, 2 / 7, 0.001, 0.05, 0.005
    first = limit / (2 * mu)
    plastic = math.sqrt(lam + 2 * mu / 3 + 2 / 3 * hardening * 2 * mu / (hardening + 3 * mu))
    strain = first + (velocity - first) / plastic
    ways = []
    for time in ("0.1", "0.2"):
        done(1, EXAMPLES + "/plastic-wave/scene.yaml", "-time", time, "-output", "wave.h5", "-expect_energy", "0,1")
        fronts, between, flow = fronts_of("wave.h5", first, velocity)
        ways.append(fronts)
    for name, speed, at in (("elastic", 1 - velocity, 0), ("plastic", plastic * (1 - first) - (velocity - first), 1)):
        found = (ways[0][at] - ways[1][at]) / 0.1
        check(abs(found / speed - 1) < 0.01, f"the {name} wave has the speed {found}, not {speed}")
    check(abs(between / (velocity - first) - 1) < 0.01, f"the velocity between the waves is {between}, not {velocity - first}")
    expected = (2 * mu * strain - limit) / (hardening + 3 * mu)
    check(abs(flow / expected - 1) < 0.03, f"the plastic strain is {flow}, not {expected}")


def fronts_of(path, first, velocity):
    """Where the two waves to the left are, the velocity between them, and the plastic strain behind them."""
    found = particles(path)
    order = np.argsort(found["coordinates"][:, 0])
    x, v, q = (found[name][order] for name in ("coordinates", "v", "plastic_strain"))
    x = x[:, 0]
    left = (x > 0.25) & (x < 0.499)
    x, v, q = x[left], v[left], q[left]
    fronts = [x[np.flatnonzero(v < level)[0]] for level in (velocity - first / 2, (velocity - first) / 2)]
    between = np.median(v[(x > fronts[0] + 0.005) & (x < fronts[0] + 0.012)])
    return fronts, between, np.median(q[(x > fronts[1] + 0.01) & (x < 0.49)])


def check_steps():
    """The step of courant auto lives, and 1.1 times the largest stable one does not, by the moduli after the first step."""
    forks.run([MPMSTAB, "critical", "-formulation", "usl", "-basis", "quadratic", "-json", "lattice.json"], check=True, capture_output=True)
    with open("lattice.json", encoding="utf-8") as file:
        lattice = json.load(file)["critical"]["critical_courant"]
    for name, words in LIVES.items():
        scene = [*NOISE, *words.split(), "-steps", "2000"]
        said = done(1, *scene, "-courant", "auto", "-safety", "0.9", "-json", "auto.json")
        with open("auto.json", encoding="utf-8") as file:
            auto = json.load(file)["run"]["courant_auto"]
        check("verdict: unstable" not in said, f"{name}: courant auto grows: {said}")
        largest = auto["dt_least"] * 32 / 0.9 * lattice / auto["first_limit"]  # the exact limit in place of the certificate
        process = run(1, *scene, "-courant", str(1.1 * largest))
        check(process.returncode == 1 and "has the volume det F" in process.stderr,
              f"{name}: 1.1 times the limit lives, status {process.returncode}: {process.stderr}{process.stdout}")
    # snow that packs together: 0.9 of the limit at rest dies in the first collision, and so does half of it
    scene = ["-kinematics", "finite", "-formulation", "usl", "-basis", "quadratic", "-cells", "64", "-initial", "collision",
             "-mach", "0.4", "-boundary", "fixed", "-lame_ratio", "1", "-material", "snow", "-steps", "300"]
    done(1, *scene, "-courant", "auto")
    for courant in ("1.2", "0.6"):
        check(run(1, *scene, "-courant", courant).returncode == 1, f"snow that packs together lives at {courant}")


def check_ranks():
    """A run that resumes is one that does not end; other ranks and the plain march have the same particles."""
    for name, words in FLOWS.items():
        for dim in DIMS[name]:
            scene = ["-kinematics", "finite", "-formulation", "musl", "-basis", "quadratic", "-dim", str(dim), "-cells", "12,5,5"[:(2, 4, 6)[dim - 1]],
                     "-initial", "random", "-amplitude", "0.02", "-mach", "0.3" + ",0" * (dim - 1), "-courant", "0.3", *words.split()]
            whole = check_same_runs(done, f"{name}, dim {dim}", *scene)
            flown = whole[INTERNAL[name]]
            check(np.ptp(flown) > 1e-3, f"{name}, dim {dim}: nothing flows")

    bodies = "[{shape: sphere, center: [6,8], radius: 2, velocity: [0.1,0]}, {shape: sphere, center: [11,8], radius: 2, velocity: [-0.1,0]}]"
    tangents = []
    for ranks in (1, 3):  # clay without a load stands on the yield surface, and rounding does not say on which side
        done(ranks, "-kinematics", "finite", "-formulation", "musl", "-dim", "2", "-cells", "16,16", "-cell_width", "1", "-boundary", "fixed",
             "-basis", "quadratic", "-ppc", "2", "-courant", "0.2", "-steps", "20", "-material", "clay", "-yield", "1e-4",
             "-bodies", bodies, "-tangent", "random", "-json", "t.json")
        tangents.append(loaded("t.json")["run"]["tangent"])
    check(tangents[0]["on_surface"] > 0, tangents[0])
    for other in tangents[1:]:
        check(other["on_surface"] == tangents[0]["on_surface"] and abs(other["growth"][0] - tangents[0]["growth"][0]) < 1e-10,
              f"tangents on ranks: {tangents}")


def check_refusals():
    scene = "-kinematics finite -formulation usl"
    for words, why in (("-formulation usl -material mises", "-material mises: it flows, and a linear scheme"),
                       (f"{scene} -material neo -yield 1", "-yield 1: allowed: only with material mises"),
                       (f"{scene} -material mises -stretch_limit 1", "-stretch_limit 1: allowed: only with material snow"),
                       (f"{scene} -material neo -hardening 1", "-hardening 1: allowed: only with material mises or snow"),
                       (f"{scene} -material snow -compression_limit 1", "-compression_limit 1: allowed with material snow: from"),
                       (f"{scene} -material mises -yield 0", "-yield 0: allowed"),
                       (f"{scene} -material mises -yield nan", "-yield nan: "),
                       ("-kinematics finite -formulation rk -material mises", "-material mises: rk has no steps of one stage"),
                       ("-kinematics finite -formulation implicit -material snow", "-material snow: implicit has no steps of one stage"),
                       (f"{scene} -material snow -initial manufactured -amplitude 0.01", "it is of a solid; allowed: material uniform")):
        process = run(1, *words.split())
        check(process.returncode == 2 and why in process.stderr and len(process.stderr.splitlines()) == 1,
              f"{words}: status {process.returncode}: {process.stderr}")


def check_surface():
    """A uniform state on the yield surface has two tangents, and the larger growth counts."""
    for material, courant, word in (("mises -hardening 0.01", "2.2", "unloading"), ("mises -hardening 0.01", "0.5", ""), ("snow", "2.2", "unloading"),
                                    ("sand -friction_angle 20", "2.2", "unloading"), ("clay", "2.2", "unloading")):
        process = forks.run([MPMSTAB, "spectrum", *"-kinematics finite -formulation usl -basis cubic -cells 8 -lame_ratio 1".split(),
                             *f"-stretch 0.9 -initial uniform -at_step 3 -material {material} -courant {courant}".split()],
                            capture_output=True, text=True, check=False)
        said = process.stdout
        check("16 particles stand on the yield surface: growth " in said and word + " counts" in said, f"{said}{process.stderr}")
        check(("verdict: unstable" in said) == (courant == "2.2"), said)


def check_failure():
    """A return that does not converge ends the run with one message and the state of the step before, from which a run fails alike."""
    scene = ("-kinematics finite -dim 2 -formulation usl -basis quadratic -material clay -yield 1000 -hardening 50 -cells 6 -initial random -amplitude 0.5 "
             "-courant 0.05 -steps 60").split()
    for ranks in (1, 3):
        failed = run(ranks, *scene, "-checkpoint", "last.h5")
        says, end, left = failed.stderr.strip().partition("; the checkpoint has the state of step ")
        step = int(left or 0)
        check(failed.returncode == 1 and len(failed.stderr.splitlines()) == 1 and step > 1 and f": step {step + 1}: particle " in says
              and " with the stretch F = " in says and says.endswith(" does not come back to the yield surface of material clay"), failed.stderr)
        again = run(1, *scene, "-restart", "last.h5")
        check(again.returncode == 1 and again.stderr.strip() == says, f"from the last whole state: {again.stderr}")
        said = done(1, *scene[:-1], str(step), "-restart", "last.h5")
        check(f"the checkpoint last.h5 is of the last step, {step}: nothing is left" in said, said)


check_wave()
check_steps()
check_ranks()
check_refusals()
check_surface()
check_failure()
