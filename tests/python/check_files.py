#!/usr/bin/python3
"""Checks the files that a run writes: HDF5, XDMF, JSON and CSV, on 1, 2 and 3 ranks.

check_files.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import csv
import json
import math
import os
import sys
import xml.etree.ElementTree as ElementTree

import h5py
import numpy

from checks import check, forks, run_script

CELLS, PPC, STEPS, EVERY, COURANT, LENGTH = 30, 2, 24, 8, 0.2, 3.0
DRIFT = 1 / 7
OPTIONS = (f"run -formulation gas2 -cells {CELLS} -ppc {PPC} -steps {STEPS} -courant {COURANT} -drift 1/7 "
           f"-length {LENGTH} -wave_speed 2 -output_every {EVERY}").split()

TOP = {"version", "task", "formulation", "basis", "transfer", "boundary", "gradient", "dim", "cells", "ppc", "particles", "courant",
       "drift",
       "ranks", "wall_s", "verdict", "growth", "predicted", "run"}
RUN = {"steps", "time", "loop_s", "ns_per_particle_step", "bytes_per_particle_step", "load", "error", "growth_measured", "growth_kind", "energy",
       "mass_change"}


def run(mpiexec, mpmstab, ranks):
    name = f"files_{ranks}"
    for ending in (".h5", ".xmf", ".json", ".csv"):
        if os.path.exists(name + ending):
            os.remove(name + ending)
    command = [mpiexec, "-n", str(ranks), mpmstab, *OPTIONS, "-output", name + ".h5", "-json", name + ".json", "-csv",
               name + ".csv"]
    done = forks.run(command, capture_output=True, text=True, check=False)
    check(done.returncode == 0, f"{' '.join(command)}: {done.stderr}")
    check(done.stderr == "", f"a progress line or more on standard error that is no terminal: {done.stderr!r}")
    left = [f for f in os.listdir(".") if f.endswith(".part")]
    check(not left, f"left behind: {left}")
    return name


def check_hdf5(name):
    fields = {}
    with h5py.File(name + ".h5", "r") as file:
        check(file.attrs["formulation"] in ("gas2", b"gas2"), f"formulation {file.attrs['formulation']!r}")
        check("version" in file.attrs and file.attrs["cells"] == CELLS, "scene attributes")
        groups = [f"step_{step:010d}" for step in range(0, STEPS + 1, EVERY)]
        check(sorted(file.keys()) == groups, f"groups {sorted(file.keys())}")
        h = LENGTH / CELLS
        for step, group in zip(range(0, STEPS + 1, EVERY), groups):
            data = file[group]
            check(math.isclose(data.attrs["time"], step * COURANT * h / 2, abs_tol=1e-15), "time")
            x = data["particles/coordinates"][:]
            check(x.shape == (CELLS * PPC, 3), f"coordinates {x.shape}")
            check(not x[:, 1:].any(), "y and z are not 0")
            home = (numpy.arange(CELLS * PPC) + 0.5) / PPC  # in the order of global ids
            off = (x[:, 0] / h - home - step * DRIFT + CELLS / 2) % CELLS - CELLS / 2
            check(abs(off).max() < 1e-12, f"particle off its place by {abs(off).max()} cells")
            for field in ("u", "r"):
                q, g = data[f"particles/{field}"][:], data[f"nodes/{field}"][:]
                check(q.shape == (CELLS * PPC,) and g.shape == (CELLS,), f"{field}: {q.shape}, {g.shape}")
                check(numpy.isclose(g, p2g(x[:, 0] / h, q), atol=1e-12).all(), f"nodes/{field} is not P2G of the particles")
                fields[group, field] = q
    return fields


def p2g(x, q):
    cell = numpy.floor(x + 1e-12).astype(int) % CELLS
    xi = numpy.clip(x - numpy.floor(x + 1e-12), 0, 1)
    total, mass = numpy.zeros(CELLS), numpy.zeros(CELLS)
    for node, weight in ((cell, 1 - xi), ((cell + 1) % CELLS, xi)):
        numpy.add.at(total, node, weight * q)
        numpy.add.at(mass, node, weight)
    return total / mass


def check_xdmf(name):
    """Checks that every dataset that the XDMF names is there, with the shape that it says."""
    root = ElementTree.parse(name + ".xmf").getroot()
    times = [float(t.get("Value")) for t in root.iter("Time")]
    check(len(times) == STEPS // EVERY + 1 and times == sorted(times), f"times {times}")
    items = [i for i in root.iter("DataItem") if i.get("Format") == "HDF"]
    check(len(items) == len(times) * 5, f"{len(items)} datasets named")
    with h5py.File(name + ".h5", "r") as file:
        for item in items:
            path, dataset = item.text.strip().split(":")
            shape = [int(n) for n in item.get("Dimensions").split()]
            check(path == name + ".h5", f"XDMF names {path}")
            check(numpy.prod(shape) == file[dataset].size, f"{dataset}: {shape} and {file[dataset].shape}")


def check_vtk(name):
    """Reads the files by ParaView's own reader, where it is installed."""
    try:
        from vtkmodules.vtkIOXdmf2 import vtkXdmfReader
    except ImportError:
        print("skipped: ParaView's reader (vtkXdmfReader) is not installed")
        return
    reader = vtkXdmfReader()
    reader.SetFileName(name + ".xmf")
    reader.UpdateInformation()
    reader.Update()
    step = reader.GetOutputDataObject(0)
    particles, nodes = step.GetBlock(0), step.GetBlock(1)
    check(particles.GetNumberOfPoints() == CELLS * PPC, f"{particles.GetNumberOfPoints()} particles read")
    check(nodes.GetNumberOfPoints() == CELLS, f"{nodes.GetNumberOfPoints()} nodes read")
    check(particles.GetPointData().GetArray("u") is not None, "no field u")


def check_json(name, ranks):
    with open(name + ".json") as file:
        result = json.load(file)
    check(set(result) == TOP, f"keys {set(result) ^ TOP}")
    check(set(result["run"]) == RUN, f"keys of run {set(result['run']) ^ RUN}")
    check(set(result["run"]["error"]) == {"u", "r"}, "error fields")
    check(all(set(e) == {"l1", "l2", "linf"} for e in result["run"]["error"].values()), "error norms")
    check(result["ranks"] == ranks and result["task"] == "run" and result["particles"] == CELLS * PPC, "scene")
    check(result["predicted"]["published"] is None, "the slides' formula does not cover drift")
    check(result["drift"] == DRIFT and result["run"]["steps"] == STEPS, "numbers are not in full precision")
    return result


def check_csv(name, result):
    with open(name + ".csv") as file:
        rows = list(csv.DictReader(file))
    check([int(r["step"]) for r in rows] == list(range(STEPS + 1)), "a row a step")
    check(math.isclose(float(rows[0]["energy"]), result["run"]["energy"]["initial"]), "first energy")
    check(math.isclose(float(rows[-1]["energy"]), result["run"]["energy"]["final"]), "last energy")
    check(math.isclose(float(rows[-1]["error_l2_u"]), result["run"]["error"]["u"]["l2"]), "last error")
    check(all(math.isclose(math.log10(float(r["norm"])), float(r["log10_norm"]), abs_tol=1e-9) for r in rows), "log10_norm")


def check_scripts(name):
    """Checks the words on the picture and in the summary of this run."""
    with open(name + "-spectrum.json", "w") as file:  # what summary.py takes from the task spectrum
        json.dump({"formulation": "gas2", "courant": 0.2, "drift": DRIFT, "verdict": "unstable", "spectrum": {},
                   "predicted": {"published": None, "corrected": None, "symbol": 1.25}}, file)
    for command in (["pictures.py", "growth", "-o", name, name + ".json"], ["report/summary.py", ".", name]):
        done = run_script(*command)
        check(done.returncode == 0, f"{command[0]}: {done.stderr}")
    with open(name + ".svg") as file:
        picture = file.read()
    for text in ("k = 0.2, drift 0.142857", "time step", "size of the state"):
        check(text in picture, f"'{text}' is not on the picture")
    lines = done.stdout.splitlines()
    check(lines[3].split() == ["gas2", "0.2", "0.142857", "-", "-", "1.250000", "-", "-", "-", "unstable"], f"{lines}")
    check(lines[-2].split()[:5] == ["scheme", "k", "drift", "predicted", "measured"], f"summary: {lines}")
    check(lines[-1].split()[:4] == ["gas2", "0.2", "0.142857", "-"], f"summary: {lines}")


def main(mpiexec, mpmstab):
    first_fields = first_error = None
    for ranks in (1, 3):
        name = run(mpiexec, mpmstab, ranks)
        fields = check_hdf5(name)
        check_xdmf(name)
        result = check_json(name, ranks)
        check_csv(name, result)
        first_fields, first_error = first_fields or fields, first_error or result["run"]["error"]
        for key, values in fields.items():
            check(abs(values - first_fields[key]).max() < 1e-12, f"{key} on {ranks} ranks differs")
        for field, error in result["run"]["error"].items():
            for norm, value in error.items():
                check(math.isclose(value, first_error[field][norm], rel_tol=1e-10), f"error of {field} on {ranks} ranks")
    check_vtk(name)
    check_scripts(name)


if __name__ == "__main__":
    main(*sys.argv[1:3])
