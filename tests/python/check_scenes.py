#!/usr/bin/python3
"""Scenes that people know: equal by particle id on several ranks, and the numbers of their pages.

check_scenes.py MPIEXEC MPMSTAB ranks|pages|long. Silent when all is well. long is for the pages whose runs take seconds.
"""
import json
import math
import os
import re
import sys
import tempfile

import h5py
import numpy as np

from checks import ROOT, check, forks, text_of

MPIEXEC, MPMSTAB, PART = sys.argv[1:]
# The sand slides, and snow packs: rounding grows in them.
SCENES = {"sand-column": 1e-8, "snow-wedge": 1e-8, "dam-break": 1e-10, "bouncing-block": 1e-10, "taylor-bar": 1e-10,
          "cantilever": 1e-10, "billet": 1e-10, "cone-in-clay": 1e-8, "clay-bank": 1e-10, "colliding-discs": 1e-10,
          "ball-in-sand": 1e-9}


def run(name, *words, ranks=1):
    """Returns the arrays of the particles at each output step."""
    launch = [MPIEXEC, "-q", "-n", str(ranks)] if ranks > 1 else []
    done = forks.run([*launch, MPMSTAB, "run", os.path.join(ROOT, "examples", name, "scene.yaml"), "-output",
                      f"{name}.h5", *words], capture_output=True, text=True, check=False)
    check(done.returncode == 0, f"{name} {' '.join(words)}: status {done.returncode}: {done.stderr}")
    with h5py.File(f"{name}.h5") as file:
        return [{"time": file[key].attrs["time"], **{field: item[...] for field, item in file[key + "/particles"].items()}}
                for key in sorted(key for key in file if key.startswith("step_"))]


def quotes(name, *texts):
    found = re.sub(r"\s+", " ", text_of(os.path.join(ROOT, "examples", name, "README.md")))
    for text in texts:
        check(text in found, f"the page of {name} does not have '{text}'")


def check_ranks():
    for at, (name, bound) in enumerate(SCENES.items()):
        more = [] if name == "billet" else ["-expect_energy", "0,10"]  # billet starts without energy
        steps = "40" if name == "taylor-bar" else "150"  # it has hit the wall at once
        one, other = (run(name, "-steps", steps, *more, ranks=ranks)[-1] for ranks in (1, 2 + at % 2))
        for field in one:
            off = np.abs(other[field] - one[field]).max() / max(1, np.abs(one[field]).max())
            check(off <= bound, f"{name}: {field} differs between ranks by {off}")


def check_bar():
    last = run("taylor-bar")[-1]
    x, half = last["coordinates"], 0.2
    length, radius = 1e3 * x[:, 1].max() + half, 1e3 * x[:, 0].max() + half
    quotes("taylor-bar", f"| {length:.1f} mm | 21.3 to 21.7 mm |", f"| {radius:.1f} mm | 7.0 to 7.2 mm |",
           f"| {last['plastic_strain'].max():.1f} | 2.5 to 3.2 |")
    check(21.3 <= round(length, 1) <= 21.7 and 7 <= round(radius, 1) <= 7.2, f"taylor-bar: {length} and {radius}")


def check_billet():
    last = run("billet")[-1]
    exact = 2 / math.sqrt(3) * math.log(0.15 / (0.15 - 20 * (last["time"] - 0.0001)))
    mean = last["plastic_strain"].mean()
    quotes("billet", f"= {exact:.2f}.", f"is {mean:.2f}.")
    check(abs(mean - exact) < 0.1 * exact, f"billet: {mean} and {exact}")


def check_clay():
    steps = run("cone-in-clay")
    heave = steps[-1]["coordinates"][:, 1].max() - steps[0]["coordinates"][:, 1].max()
    quotes("cone-in-clay", f"by {heave:.2f} m.", f"a plastic loss of {steps[-1]['plastic_loss'].max():.2f} ")


def check_bank():
    for words, says in (((), "sinks by {:.2f} m, and comes to rest"), (("-yield", "0.000977"), "it sinks by {:.2f} m, which")):
        steps = run("clay-bank", *words)
        edge = steps[0]["coordinates"].sum(axis=1).argmax()
        quotes("clay-bank", says.format(steps[0]["coordinates"][edge, 1] - steps[-1]["coordinates"][edge, 1]))


def check_beam():
    """Small swings under a thousandth of the weight, against those of a beam."""
    steps = run("cantilever", "-gravity", "0,-0.01", "-time", "2.8", "-expect_energy", "0,2", "-output_interval", "0.02")
    tip = steps[0]["coordinates"][:, 0] > steps[0]["coordinates"][:, 0].max() - 1e-6
    sinks = np.array([(steps[0]["coordinates"] - step["coordinates"])[tip, 1].mean() for step in steps])
    lowest = sinks.argmax()
    back = steps[lowest + sinks[lowest:].argmin()]["time"]
    beam = 2 * math.pi / 1.8751**2 * 64 / math.sqrt(2e7 / (1 - 0.3**2) / 1000 / 12)
    quotes("cantilever", f"is back after {back:.2f}", f"{beam:.2f} of a thin beam")
    check(abs(back / beam - 1) < 0.02, f"cantilever: {back} and {beam}")


def energy(name):
    """The energies at the start and at the end of the last run, which has written NAME.json."""
    with open(f"{name}.json", encoding="utf-8") as file:
        found = json.load(file)["run"]["energy"]
    return found["initial"], found["final"]


def check_sand():
    steps = run("sand-column", "-json", "sand-column.json")
    first, last = steps[0]["coordinates"], steps[-1]["coordinates"]
    start, end = energy("sand-column")
    half = (first[1, 0] - first[0, 0]) / 2
    speed = np.hypot(steps[-1]["v_x"], steps[-1]["v_y"]).max()
    quotes("sand-column", f"at rest to {speed:.2f} m/s", f"is {last[:, 1].max():.2f} m high", f"particle is {last[:, 0].max():.2f} m from",
           f"{last[:, 0].max() - (first[:, 0].max() + half):.2f} times", f"within {np.quantile(last[:, 0], 0.99):.2f} m.")
    way = last[:, 0].max() - 1  # 1.2 times its height (Lube et al. 2005), to 20 % on this coarse grid
    check(abs(way / (1.2 * 20 / 12) - 1) < 0.2, f"sand-column: it runs out by {way}")
    check(abs(end / start - 0.5) < 0.04, f"sand-column: {end / start} of the energy")


def check_dam():
    steps = run("dam-break", "-output_every", "50", "-json", "dam-break.json")
    at = min(steps, key=lambda step: abs(step["time"] - 0.4))
    start, end = energy("dam-break")
    way = at["coordinates"][:, 0].max() - steps[0]["coordinates"][:, 0].max()
    quotes("dam-break", f"the front is {way:.1f} from", f"= {2 * math.sqrt(9.81 * 0.8) * 0.4:.2f},", f"has {100 * end / start:.1f} %")
    check(way < 2 * math.sqrt(9.81 * 0.8) * at["time"], f"dam-break: {way} at {at['time']}")


def check_energies():
    run("bouncing-block", "-json", "bouncing-block.json")
    start, end = energy("bouncing-block")
    quotes("bouncing-block", f"has {100 * end / start:.1f} % of its energy")
    run("colliding-discs", "-json", "colliding-discs.json")
    start, end = energy("colliding-discs")
    quotes("colliding-discs", f"is {1e3 * start:.3f}e-3 until", f"{1e3 * end:.3f}e-3 at the end", f"is {100 * end / start:.1f}%")


def check_ball():
    last = run("ball-in-sand", "-json", "ball-in-sand.json")[-1]
    start, end = energy("ball-in-sand")
    quotes("ball-in-sand", f"comes back with {last['v_y'][last['material'] == 1].mean():.2f} m/s", f"{100 * end / start:.1f} % of the energy")


def check_swing():
    steps = run("cantilever", "-output_interval", "0.01", "-json", "cantilever.json")
    start, end = energy("cantilever")
    first = steps[0]["coordinates"]
    tip = (first[:, 0] - first[:, 1]).argmax()
    y = [step["coordinates"][tip, 1] for step in steps]
    lowest = int(np.argmin(y))
    quotes("cantilever", f"falls from {y[0]:.1f} to {y[lowest]:.1f} in {steps[lowest]['time']:.1f} units", f"back at {y[-1]:.1f} after",
           f"from {start:.1f} to {end:.1f}; the lost {start - end:.1f}")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    for part in {"ranks": (check_ranks,), "long": (check_bar, check_clay, check_beam, check_swing),
                 "pages": (check_billet, check_bank, check_sand, check_dam, check_energies, check_ball)}[PART]:
        part()
