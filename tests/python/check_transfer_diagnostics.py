#!/usr/bin/python3
"""Checks the slides' diagnostics of run (weights, source_term, ringing) against numpy, from the run's own HDF5 output.

check_transfer_diagnostics.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import csv
import json
import sys

import h5py
import numpy

from checks import check, forks

CELLS, STEPS = 12, 9
# Each line has a scene, its fields, drift and basis, and the ranks that run it.
SCENES = [
    ("-drift 2/7 -courant 0.4 -initial random", "ur", 2 / 7, "linear", (1, 3)),
    ("-jitter 0.7 -drift -0.3 -courant 0.4 -ppc 3 -initial random", "ur", -0.3, "linear", (1,)),
    ("-formulation musl -basis quadratic -drift 1.4 -courant 0.4 -ppc 2 -initial random", "vs", 1.4, "quadratic",
     (2,)),
    ("-formulation elastic -drift 0.21 -transfer nullspace -courant 0.4", "uw", 0.21, "linear", (1,)),
    ("-formulation usl -boundary fixed,free -ppc 2 -courant 0.4 -initial random", "vs", 0, "walls", (3,)),
]


def shapes(x, basis):
    """Returns phi_ip, a row for each particle at x (in cells). Between walls the nodes are 0..CELLS, else they wrap."""
    nodes = CELLS + 1 if basis == "walls" else CELLS
    phi = numpy.zeros((len(x), nodes))
    for p, place in enumerate(x):
        for node in range(int(numpy.floor(place)) - 2, int(numpy.floor(place)) + 4):
            far = abs(place - node)
            if basis == "quadratic":
                value = 0.75 - far**2 if far < 0.5 else max(0, 1.5 - far) ** 2 / 2
            else:
                value = max(0, 1 - far)
            if value:
                phi[p, node if basis == "walls" else node % CELLS] += value
    return phi


def project(phi, q):
    return phi.T @ q / phi.sum(axis=0)


def ringing(phi, q, fixed):
    """Returns what a least-squares fit by nodes leaves of q. A node at a fixed wall is 0."""
    inside = phi[:, 1:] if fixed else phi
    rest = q - inside @ numpy.linalg.lstsq(inside, q, rcond=None)[0]
    return numpy.linalg.norm(rest) / numpy.linalg.norm(q)


def near(row, key, value, tolerance=1e-9):
    if not numpy.isfinite(value):
        check(row[key] == "", f"step {row['step']}: {key} is {row[key]}, there is nothing to divide by")
    else:
        check(abs(float(row[key]) - value) < tolerance, f"step {row['step']}: {key} is {row[key]}, numpy {value}")


def compare(rows, file, fields, drift, basis):
    largest = {f: 0 for f in fields}
    for row in rows:
        group = file[f"step_{int(row['step']):010d}/particles"]
        x = group["coordinates"][:, 0] * CELLS
        now, then = shapes(x, basis), shapes(x + drift, basis)
        if basis == "linear":
            left = numpy.array([now[(x >= i - 1) & (x < i), i % CELLS].sum() for i in range(1, CELLS + 1)])
            c1 = left / numpy.roll(now.sum(axis=0), -1)
            for key, value in (("c1_mean", c1.mean()), ("c1_min", c1.min()), ("c1_max", c1.max())):
                near(row, key, value)
        for f in fields:
            q = group[f][()]
            before = project(now, q)
            with numpy.errstate(invalid="ignore", divide="ignore"):
                near(row, "source_" + f,
                     numpy.linalg.norm(project(then, q) - before) / numpy.linalg.norm(before))
                near(row, "ringing_" + f, ringing(now, q, basis == "walls" and f == "v"), 1e-7)
            largest[f] = max(largest[f], float(row["ringing_" + f] or 0))
    return largest


def run(mpiexec, mpmstab, number, ranks):
    scene, fields, drift, basis, _ = SCENES[number]
    name = f"diagnostics_{number}_{ranks}"
    asked = ["-source_term", "true", "-ringing", "true"] + (["-weights", "true"] if basis == "linear" else [])
    files = ["-csv", name + ".csv", "-json", name + ".json", "-output", name + ".h5", "-output_every", "1"]
    done = forks.run([mpiexec, "-n", str(ranks), mpmstab, "run", *scene.split(), "-cells", str(CELLS), "-steps",
                      str(STEPS), *asked, *files], capture_output=True, text=True, check=False)
    check(done.returncode == 0 and done.stderr == "", f"{scene}: {done.stderr}")
    with open(name + ".csv") as file:
        rows = list(csv.DictReader(file))
    check(len(rows) == STEPS + 1, f"{scene}: {len(rows)} rows")
    with h5py.File(name + ".h5") as file:
        largest = compare(rows, file, fields, drift, basis)
    with open(name + ".json") as file:
        result = json.load(file)["run"]
    for f in fields:
        check(result["ringing"][f].get("largest", 0) == largest[f], f"{scene}: largest ringing of {f}")
        check(result["ringing"][f].get("last") == (float(rows[-1]["ringing_" + f] or "nan")), f"{scene}: last of {f}")
        source = [float(row["source_" + f]) for row in rows if row["source_" + f]]
        check(result["source_term"][f]["largest"] == max(source), f"{scene}: source of {f}")
        check((max(source) > 1e-3) == (drift != 0), f"{scene}: source of {f} is {max(source)}")
    if basis == "linear":
        c1 = [float(row["c1_max"]) for row in rows]
        least = [float(row["c1_min"]) for row in rows]
        check(result["weights"] == {"c1_min": min(least), "c1_max": max(c1)}, f"{scene}: C1 {result['weights']}")
    return rows


def main(mpiexec, mpmstab):
    for number, (scene, fields, _, _, all_ranks) in enumerate(SCENES):
        for ranks in all_ranks:
            rows = run(mpiexec, mpmstab, number, ranks)
        if "nullspace" in scene:  # each step filters it; one step makes the rest
            check(max(float(row["ringing_w"]) for row in rows[1:]) < 0.2, f"{scene}: the filter leaves ringing")


if __name__ == "__main__":
    main(*sys.argv[1:3])
