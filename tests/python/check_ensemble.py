#!/usr/bin/python3
"""Checks the JSON and CSV of ensemble: they are the same on 1, 2 and 3 ranks, and growth is what numpy finds.

check_ensemble.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import csv
import json
import math
import sys

import numpy

from checks import check, forks

CELLS, PPC, COURANT, JITTER, SEED, LAYOUTS = 20, 2, 1.3, 0.4, 5, 14
SCENE = (f"-formulation elastic -cells {CELLS} -ppc {PPC} -courant {COURANT} -jitter {JITTER} -seed {SEED} "
         f"-layouts {LAYOUTS}").split()
TOP = {"version", "task", "formulation", "basis", "transfer", "boundary", "dim", "cells", "ppc", "particles", "courant",
       "drift", "ranks", "wall_s", "verdict", "growth", "tolerance", "uncertainty", "evidence", "ensemble",
       "jitter", "seed", "gradient"}
ENSEMBLE = {"layouts", "unstable", "undecided", "share", "interval", "growth_min", "growth_median", "growth_max",
            "worst_seed", "tolerance", "seconds"}
WORD = 2**64 - 1


def uniform(seed, particle):
    """Returns the random number of a particle by splitmix64, as in docs/theory.md."""
    z = (seed + (particle + 1) * 0x9E3779B97F4A7C15) & WORD
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & WORD
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & WORD
    return ((z ^ (z >> 31)) >> 11) * 2.0**-53


def growth(seed):
    """Returns the largest abs eigenvalue of elastic: a = k LAP P u, v = P w + a, then w += S a and u += k S v."""
    n = CELLS * PPC
    shape = numpy.zeros((n, CELLS))
    for p in range(n):
        x = (p + 0.5 + JITTER * (uniform(seed, p) - 0.5)) / PPC
        cell = math.floor(x)
        shape[p, cell % CELLS] += 1 - (x - cell)
        shape[p, (cell + 1) % CELLS] += x - cell
    p2g = shape.T / shape.sum(axis=0)[:, None]
    one = numpy.eye(CELLS)
    a = COURANT * (numpy.roll(one, 1, 0) + numpy.roll(one, -1, 0) - 2 * one) @ p2g
    whole = numpy.block([[numpy.eye(n) + COURANT * shape @ a, COURANT * shape @ p2g], [shape @ a, numpy.eye(n)]])
    return abs(numpy.linalg.eigvals(whole)).max()


def run(mpiexec, mpmstab, ranks):
    name = f"ensemble_{ranks}"
    command = [mpiexec, "-n", str(ranks), mpmstab, "ensemble", *SCENE, "-json", name + ".json", "-csv", name + ".csv"]
    done = forks.run(command, capture_output=True, text=True, check=False)
    check(done.returncode == 0 and done.stderr == "", f"{' '.join(command)}: {done.stderr}")
    with open(name + ".json") as file:
        result = json.load(file)
    with open(name + ".csv") as file:
        text = file.read()
    table = [line for line in done.stdout.splitlines() if "rank" not in line and not line.startswith("time:")]
    for key in ("wall_s", "ranks"):
        del result[key]
    del result["ensemble"]["seconds"]
    return result, text, table


def main(mpiexec, mpmstab):
    result, text, table = run(mpiexec, mpmstab, 1)
    check(set(result) | {"wall_s", "ranks"} == TOP, f"keys {set(result) ^ TOP}")
    check(set(result["ensemble"]) | {"seconds"} == ENSEMBLE, f"keys of ensemble {set(result['ensemble']) ^ ENSEMBLE}")
    rows = list(csv.DictReader(text.splitlines()))
    check([int(r["seed"]) for r in rows] == list(range(SEED, SEED + LAYOUTS)), "seeds of the CSV")
    expected = [growth(SEED + i) for i in range(LAYOUTS)]
    for row, value in zip(rows, expected):
        check(abs(float(row["growth"]) - value) < (1e-11 if value > 1 + 1e-6 else 1e-7), f"numpy {value}: {row}")
        check(row["verdict"] == ("unstable" if value > 1 + 1e-6 else "stable"), f"numpy {value}: {row}")
    e, unstable = result["ensemble"], sum(value > 1 + 1e-6 for value in expected)
    check(0 < unstable < LAYOUTS, f"{unstable} unstable: the scene shows nothing")
    check((e["layouts"], e["unstable"], e["undecided"]) == (LAYOUTS, unstable, 0), f"counts {e}")
    check(math.isclose(e["share"], unstable / LAYOUTS), f"share {e['share']}")
    check(e["interval"][0] < e["share"] < e["interval"][1], f"interval {e['interval']}")
    check(abs(e["growth_median"] - numpy.median(expected)) < 1e-7, f"median {e['growth_median']}")
    check(e["worst_seed"] == SEED + int(numpy.argmax(expected)), f"worst seed {e['worst_seed']}")
    check(result["growth"] == e["growth_max"] and result["verdict"] == "unstable", "growth or verdict")
    for ranks in (2, 3):
        check(run(mpiexec, mpmstab, ranks) == (result, text, table), f"{ranks} ranks say something else")


if __name__ == "__main__":
    main(*sys.argv[1:3])
