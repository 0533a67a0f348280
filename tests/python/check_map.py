#!/usr/bin/python3
"""Checks the JSON, CSV and HDF5 of map: they are the same on 1, 2 and 3 ranks, and growth is what numpy finds.

check_map.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import csv
import json
import subprocess
import sys
from fractions import Fraction

import h5py
import numpy

from checks import check, forks

CELLS = 8
SCENE = f"-cells {CELLS} -ppc 1 -map_courant 1/10,1 -map_drift 0,1/2 -map_points 4,5".split()
MAP = {"axes", "shape", "courant", "drift", "phases", "unstable", "undecided", "published_limit", "corrected_limit",
       "seconds"}


def growth(courant, drift):
    """Returns the growth of gas2, from unit vectors marched over a period: u += k grad P r, r += k grad P u."""
    whole = numpy.eye(2 * CELLS)
    for step in range(drift.denominator):
        shape, grad = numpy.zeros((CELLS, CELLS)), numpy.zeros((CELLS, CELLS))
        for p in range(CELLS):
            x = p + Fraction(1, 2) + step * drift
            cell = x.numerator // x.denominator
            shape[p, cell % CELLS] += float(1 - (x - cell))
            shape[p, (cell + 1) % CELLS] += float(x - cell)
            grad[p, cell % CELLS] -= 1
            grad[p, (cell + 1) % CELLS] += 1
        push = courant * grad @ (shape.T / shape.sum(axis=0)[:, None])
        one, nothing = numpy.eye(CELLS), numpy.zeros((CELLS, CELLS))
        first = numpy.block([[one, push], [nothing, one]])
        whole = numpy.block([[one, nothing], [push, one]]) @ first @ whole
    return abs(numpy.linalg.eigvals(whole)).max() ** (1 / drift.denominator)


def check_mach(mpiexec, mpmstab):
    """Critical with a Mach number: the summary is that of the rows, on any number of ranks."""
    texts = []
    for ranks in (1, 3):
        done = forks.run([mpiexec, "-n", str(ranks), mpmstab, "critical", "-formulation", "usl", "-ppc", "1",
                          "-mach", "1/3", "-sound_speed", "10", "-cell_width", "0.1", "-json", "mach.json", "-csv", "mach.csv"],
                         capture_output=True, text=True, check=False)
        check(done.returncode == 0 and done.stderr == "", done.stderr)
        with open("mach.csv") as file:
            texts.append(file.read())
    check(texts[0] == texts[1], "critical -mach depends on the number of ranks")
    with open("mach.json") as file:
        found = json.load(file)["critical"]
    rows = list(csv.DictReader(texts[0].splitlines()))
    stable = [row["verdict"] == "stable" for row in rows]
    first = stable.index(False)
    check(len(rows) == found["searched"] and 0 < first, f"{len(rows)} rows, the first at {first} grows")
    check(float(rows[first - 1]["courant"]) == found["critical_courant"], f"{rows[first - 1]}")
    check(abs(found["critical_dt"] - found["critical_courant"] / 100) < 1e-15, f"dt {found['critical_dt']}")
    check(f"none of them grows: {found['critical_courant']:.6g}, dt {found['critical_dt']:.6g}\n" in done.stdout and
          "verdict" not in done.stdout, done.stdout)
    check(float(rows[first]["courant"]) == found["unstable_at"], f"{rows[first]}")
    check(float(rows[first]["growth"]) == found["growth_at_unstable"] > 1 + 1e-6, f"{rows[first]}")
    check(sum(row["verdict"] == "unstable" for row in rows) == found["unstable"], "number of unstable rows")
    check(all(abs(float(row["drift"]) * 3 - float(row["courant"])) < 1e-15 for row in rows), "drift is not k / 3")


def run(mpiexec, mpmstab, ranks):
    name = f"map_{ranks}"
    files = ["-json", name + ".json", "-csv", name + ".csv", "-output", name + ".h5"]
    done = forks.run([mpiexec, "-n", str(ranks), mpmstab, "map", *SCENE, *files], capture_output=True, text=True,
                     check=False)
    check(done.returncode == 0 and done.stderr == "", done.stderr)
    with open(name + ".json") as file:
        result = json.load(file)
    with open(name + ".csv") as file:
        text = file.read()
    with h5py.File(name + ".h5") as file:
        data = {key: file["map"][key][()].tolist() for key in file["map"]}
        check(file.attrs["formulation"] in (b"gas2", "gas2"), "attributes of the HDF5 file")
    table = [line for line in done.stdout.splitlines() if "rank" not in line and not line.startswith("time:")]
    for key in ("wall_s", "ranks"):
        del result[key]
    check(set(result["map"]) == MAP, f"keys of map {set(result['map']) ^ MAP}")
    del result["map"]["seconds"]
    return result, text, data, table


def check_letters(mpmstab):
    """Checks that the terminal shows every third row and every second column of a large map, from its corner on."""
    done = forks.run([mpmstab, "map", "-cells", "8", "-map_points", "60,70", "-csv", "large.csv"],
                     capture_output=True, text=True, check=True)
    lines = done.stdout.splitlines()
    lines = [line.split() for line in lines[lines.index("courant") + 1:lines.index("          drift 0 to 0.5")]]
    with open("large.csv") as file:
        rows = list(csv.DictReader(file))
    check(len(lines) == 20 and {len(letters) for _, letters in lines} == {35}, f"{len(lines)} lines of the picture")
    for i, (courant, letters) in enumerate(reversed(lines)):
        check(abs(float(courant) / float(rows[210 * i]["courant"]) - 1) < 1e-4, f"Courant number {courant}")
        for j, letter in enumerate(letters):
            row = rows[210 * i + 2 * j]
            size = numpy.digitize(float(row["growth"]) - 1, [1e-3, 1e-2, 1e-1])
            expected = {"stable": ".", "undecided": "?"}.get(row["verdict"], "-+x#"[size])
            check(letter == expected, f"{letter} for {row}")


def check_plane(mpmstab):
    """Checks that a map in two dimensions has a phase in each direction, in the CSV and in the HDF5 file."""
    forks.run([mpmstab, "map", "-dim", "2", "-formulation", "usl", "-cells", "4", "-map_axes", "courant,poisson",
               "-map_points", "3,2", "-csv", "plane.csv", "-output", "plane.h5", "-json", "plane.json"],
              stdout=subprocess.DEVNULL, check=True)
    with open("plane.csv") as file:
        rows = list(csv.DictReader(file))
    with open("plane.json") as file:
        found = json.load(file)["map"]
    check(list(rows[0]) == ["courant", "poisson", "growth", "beta_x", "beta_y", "verdict"], f"columns {list(rows[0])}")
    check(found["axes"] == ["courant", "poisson"] and found["poisson"] == [0, 0.49] and found["phases"] == 16,
          f"axes {found}")
    with h5py.File("plane.h5") as file:
        for name in ("beta_x", "beta_y"):
            check([float(row[name]) for row in rows] == list(numpy.ravel(file["map"][name])), f"{name} in the two files")
    check(all(abs(limit - 1.75**-0.5) < 1e-9 for limit in found["corrected_limit"]), f"{found['corrected_limit']}")


def check_refined(mpmstab):
    """With -refine a point has the growth that 'symbol -refine' finds: gas2 at drift 1/3 grows between 64 waves alone."""
    scene = ["-formulation", "gas2", "-ppc", "2"]
    said = {}
    for more in ([], ["-refine"]):
        done = forks.run([mpmstab, "map", *scene, "-map_courant", "0.1,0.2", "-map_drift", "0,1/3", "-map_points",
                          "2,2", "-csv", "refined.csv", "-json", "refined.json", *more], capture_output=True,
                         text=True, check=True)
        with open("refined.json") as file:
            found = json.load(file)["map"]
        said[bool(more)] = found["unstable"], "-refine looks for it" in done.stdout, found.get("refined", False)
    check(said == {False: (0, True, False), True: (2, False, True)}, f"without and with -refine: {said}")
    with open("refined.csv") as file:
        row = list(csv.DictReader(file))[1]
    forks.run([mpmstab, "symbol", *scene, "-courant", "0.1", "-drift", "1/3", "-refine", "-json", "symbol.json"],
              stdout=subprocess.DEVNULL, check=True)
    with open("symbol.json") as file:
        refined = json.load(file)["refined"]
    check(float(row["growth"]) == refined["growth"] > 1.0007 and
          abs(float(row["beta"]) - abs(refined["beta_at_max"][0])) < 1e-12, f"{row}, but symbol -refine finds {refined}")


def main(mpiexec, mpmstab):
    check_letters(mpmstab)
    check_refined(mpmstab)
    check_plane(mpmstab)
    result, text, data, table = run(mpiexec, mpmstab, 1)
    found, rows = result["map"], list(csv.DictReader(text.splitlines()))
    check(found["axes"] == ["courant", "drift"] and found["shape"] == [4, 5], f"axes {found}")
    check(numpy.allclose(found["courant"], [0.1, 0.4, 0.7, 1], rtol=1e-15, atol=0), f"courant {found['courant']}")
    check(found["drift"] == [0, 0.125, 0.25, 0.375, 0.5], f"drift {found['drift']}")
    check(found["courant"] == data["courant"] and found["drift"] == data["drift"], "axes of the HDF5 file")
    check(numpy.shape(data["growth"]) == (4, 5) == numpy.shape(data["beta"]), "shape of the HDF5 file")
    check(abs(found["published_limit"] - 0.5**0.5) < 1e-15, f"published limit {found['published_limit']}")
    check(abs(found["corrected_limit"][0] - 2) < 1e-8 and found["corrected_limit"][1:] == 4 * [None],
          f"corrected limit {found['corrected_limit']}")
    unstable = 0
    for row, (i, j) in zip(rows, numpy.ndindex(4, 5)):
        expected = growth(found["courant"][i], Fraction(j, 8))
        near = 1e-9 if expected > 1 + 1e-6 else 1e-7
        check(abs(float(row["growth"]) - expected) < near, f"numpy {expected}: {row}")
        check(row["verdict"] == ("unstable" if expected > 1 + 1e-6 else "stable"), f"numpy {expected}: {row}")
        check(float(row["growth"]) == data["growth"][i][j] and float(row["beta"]) == data["beta"][i][j],
              f"CSV and HDF5 differ: {row}")
        check((float(row["courant"]), float(row["drift"])) == (found["courant"][i], found["drift"][j]), f"axes: {row}")
        unstable += expected > 1 + 1e-6
    check(0 < unstable < 20 and found["unstable"] == unstable and found["undecided"] == 0, f"{unstable} unstable")
    check(result["verdict"] == "unstable" and result["growth"] == numpy.max(data["growth"]), "verdict or growth")
    check_mach(mpiexec, mpmstab)
    for ranks in (2, 3):
        check(run(mpiexec, mpmstab, ranks) == (result, text, data, table), f"{ranks} ranks say something else")


if __name__ == "__main__":
    main(*sys.argv[1:3])
