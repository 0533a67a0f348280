#!/usr/bin/python3
"""Checks the files that a run writes in one, two and three dimensions: HDF5, XDMF, JSON and CSV, on 1, 2 and 3 ranks.

check_files.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import csv
import itertools
import json
import math
import os
import sys
import xml.etree.ElementTree as ElementTree

import h5py
import numpy

from checks import check, forks, loaded, run_script

STEPS, EVERY, COURANT = 24, 8, 0.2

# name, options, cells, particles per cell, drift, periodic directions, wave numbers K / pi, polarisation
CASES = [
    ("line", "-formulation gas2 -cells 30 -ppc 2 -length 3 -wave_speed 2 -drift 1/7", (30,), (2,), (1 / 7,), (True,), None, None),
    ("plane", "-formulation usl -cells 12,8 -ppc 2,3 -length 3,2 -drift 1/7,-1/3 -mode 1,-2 -polarisation s",
     (12, 8), (2, 3), (1 / 7, -1 / 3), (True, True), (2 / 3, -2.0), "s"),
    ("box", "-formulation usl -transfer apic -cells 9,6 -ppc 2 -length 3,2 -boundary symmetry,periodic -mode 1,0",
     (9, 6), (2, 2), (0, 0), (False, True), (1 / 3, 0), "p"),
    ("space", "-formulation gas2 -cells 6,5,4 -ppc 1 -length 6,5,4 -drift 0,1/2,1/8 -mode 1,0,1",
     (6, 5, 4), (1, 1, 1), (0, 1 / 2, 1 / 8), (True,) * 3, (1 / 3, 0, 1 / 2), "p"),
]

TOP = {"version", "task", "formulation", "basis", "transfer", "boundary", "gradient", "dim", "cells", "ppc", "particles", "courant",
       "drift",
       "ranks", "wall_s", "verdict", "growth", "predicted", "run"}
RUN = {"steps", "time", "loop_s", "ns_per_particle_step", "bytes_per_particle_step", "load", "error", "growth_measured", "growth_kind", "energy",
       "mass_change"}


def run(mpiexec, mpmstab, ranks, name, dim, options):
    name = f"files_{name}_{ranks}"
    for ending in (".h5", ".xmf", ".json", ".csv"):
        if os.path.exists(name + ending):
            os.remove(name + ending)
    command = [mpiexec, "-n", str(ranks), mpmstab, "run", "-dim", str(dim), *options.split(), "-steps", str(STEPS),
               "-output_every", str(EVERY), "-courant", str(COURANT), "-output", name + ".h5", "-json", name + ".json",
               "-csv", name + ".csv"]
    done = forks.run(command, capture_output=True, text=True, check=False)
    check(done.returncode == 0 and done.stderr == "", f"{' '.join(command)}: {done.stderr}")
    left = [f for f in os.listdir(".") if f.endswith(".part")]
    check(not left, f"left behind: {left}")
    return name


def width(cells):
    """The width of a cell, and the time of a step, of which the waves of the line go twice as far."""
    h = 3 / cells[0] if len(cells) < 3 else 1
    return h, COURANT * h / (2 if len(cells) == 1 else 1)


def homes(cells, ppc):
    """Resting places in cells, in the order of global ids: x fastest."""
    axes = [(numpy.arange(c * n) + 0.5) / n for c, n in zip(cells, ppc)]
    grids = numpy.meshgrid(*axes[::-1], indexing="ij")
    return numpy.stack([g.ravel() for g in grids[::-1]], axis=1)


def p2g(x, q, cells, periodic):
    """P2G of hats, on an array whose last index is that of x. No hat reaches beyond an end."""
    nodes = [c + (not p) for c, p in zip(cells, periodic)]
    total, mass = numpy.zeros(nodes[::-1]), numpy.zeros(nodes[::-1])
    cell = numpy.floor(x + 1e-12).astype(int)
    xi = numpy.clip(x - cell, 0, 1)
    for corner in itertools.product((0, 1), repeat=len(cells)):
        weight, index = numpy.ones(len(x)), []
        for a, side in enumerate(corner):
            weight = weight * (xi[:, a] if side else 1 - xi[:, a])
            index.append((cell[:, a] + side) % nodes[a] if periodic[a] else cell[:, a] + side)
        numpy.add.at(total, tuple(index[::-1]), weight * q)
        numpy.add.at(mass, tuple(index[::-1]), weight)
    return total / mass


def components(file):
    return sorted(file["step_0000000000/particles"].keys() - {"coordinates"})


def check_hdf5(name, cells, ppc, drift, periodic):
    fields, dim = {}, len(cells)
    with h5py.File(name + ".h5", "r") as file:
        ends = [""] if dim == 1 else ["_x", "_y", "_z"][:dim]
        check([int(file.attrs[f"cells{end}"]) for end in ends] == list(cells), "attributes cells_x ...")
        check(file.attrs[f"mode{ends[0]}"] == 1 and (dim < 3 or file.attrs["mode_z"] == 1), "attributes mode_x ...")
        check("version" in file.attrs, "the version")
        check(sorted(file.keys()) == [f"step_{s:010d}" for s in range(0, STEPS + 1, EVERY)], "groups")
        for step, group in zip(range(0, STEPS + 1, EVERY), sorted(file.keys())):
            x, rest = file[group]["particles/coordinates"][:], homes(cells, ppc)
            h, dt = width(cells)
            check(math.isclose(file[group].attrs["time"], step * dt, abs_tol=1e-15), "time")
            check(x.shape == (len(rest), 3 if dim == 1 else dim) and not x[:, dim:].any(), f"coordinates {x.shape}")
            x = x[:, :dim]
            off = x / h - rest - step * numpy.array(drift)
            off -= numpy.round(off / cells) * cells
            check(abs(off).max() < 1e-12 and (x >= 0).all() and (x <= h * numpy.array(cells)).all(), f"places: {abs(off).max()}")
            for field in components(file):
                q, g = file[group]["particles"][field][:], file[group]["nodes"][field][:]
                if not field.startswith("c_"):
                    expected = p2g(x / h, q, cells, periodic)
                    check(g.shape == expected.shape, f"nodes/{field}: {g.shape}")
                    check(numpy.isclose(g, expected, atol=1e-12).all(), f"nodes/{field} is not P2G of the particles")
                fields[group, field] = q
    return fields


def check_start(fields, cells, ppc, waves, polarisation):
    """The velocity at the start is that of a plane wave, d sin(K.X)."""
    h = width(cells)[0]
    wave = numpy.pi * numpy.array(waves)
    n = wave / math.sqrt((wave**2).sum())
    d = n if polarisation == "p" else numpy.array([-n[1], n[0]])
    for a, axis in enumerate("xyz"[:len(cells)]):
        name = f"v_{axis}" if ("step_0000000000", f"v_{axis}") in fields else f"u_{axis}"
        expected = d[a] * numpy.sin(h * homes(cells, ppc) @ wave)
        check(abs(fields["step_0000000000", name] - expected).max() < 1e-13, f"{name} at the start")


def check_xdmf(name, dim):
    """Checks extents and datasets; a vector has a dataset for each direction and three components."""
    root = ElementTree.parse(name + ".xmf").getroot()
    check(len(list(root.iter("Time"))) == STEPS // EVERY + 1, "times")
    with h5py.File(name + ".h5", "r") as file:
        for item in root.iter("DataItem"):
            if item.get("Format") == "HDF":
                path, dataset = item.text.strip().split(":")
                shape = tuple(int(n) for n in item.get("Dimensions").split())
                same = shape == file[dataset].shape or (dim == 1 and math.prod(shape) == file[dataset].size)
                check(path == name + ".h5" and same, f"{dataset}: {shape} and {file[dataset].shape}")
        for attribute in root.iter("Attribute"):
            items = attribute.findall("DataItem/DataItem")
            letter = attribute.get("Name")
            vector = dim > 1 and letter in "uv"
            check((attribute.get("AttributeType") == "Vector") == vector, f"{letter} as a vector")
            if vector:
                ends = [f"/{letter}_{a}" for a in "xyz"[:dim]]
                check([i.text[-4:] for i in items] == ends, f"components of {letter}")
                whole = attribute.find("DataItem")
                check(whole.get("Function") == f"JOIN($0, $1, {'0*$0' if dim == 2 else '$2'})", "JOIN")
                check(whole.get("Dimensions") == items[0].get("Dimensions") + " 3", "extents of a vector")
        fields = {a.get("Name") for a in root.iter("Attribute")} | {f"{a.get('Name')}_{c}" for a in root.iter("Attribute")
                                                                    for c in "xyz"[:dim] if a.get("Name") in "uv"}
        check(set(components(file)) <= fields, f"not described: {set(components(file)) - fields}")
    kinds = {t.get("TopologyType") for t in root.iter("Topology")}, {g.get("GeometryType") for g in root.iter("Geometry")}
    check(kinds == ({"Polyvertex", f"{2 if dim == 2 else 3}DCoRectMesh"}, {"XY", "ORIGIN_DXDY"} if dim == 2 else {"XYZ", "ORIGIN_DXDYDZ"}),
          f"{kinds}")


def check_vtk(name, cells, ppc):
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
    particles = reader.GetOutputDataObject(0).GetBlock(0)
    check(particles.GetNumberOfPoints() == math.prod(cells) * math.prod(ppc), "particles read")
    vector = particles.GetPointData().GetArray("v") or particles.GetPointData().GetArray("u")
    check(vector.GetNumberOfComponents() == (1 if len(cells) == 1 else 3), "components of the vector read")


def check_json(name, ranks):
    result = loaded(name + ".json")
    check(set(result) == TOP, f"keys {set(result) ^ TOP}")
    check(set(result["run"]) == RUN, f"keys of run {set(result['run']) ^ RUN}")
    check(set(result["run"]["error"]) == {"u", "r"}, "error fields")
    check(all(set(e) == {"l1", "l2", "linf"} for e in result["run"]["error"].values()), "error norms")
    check(result["ranks"] == ranks and result["task"] == "run" and result["particles"] == 60, "scene")
    check(result["predicted"]["published"] is None, "the slides' formula does not cover drift")
    check(result["drift"] == 1 / 7 and result["run"]["steps"] == STEPS, "numbers are not in full precision")
    with open(name + ".csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    check([int(r["step"]) for r in rows] == list(range(STEPS + 1)), "a row a step")
    check(math.isclose(float(rows[0]["energy"]), result["run"]["energy"]["initial"]), "first energy")
    check(math.isclose(float(rows[-1]["energy"]), result["run"]["energy"]["final"]), "last energy")
    check(math.isclose(float(rows[-1]["error_l2_u"]), result["run"]["error"]["u"]["l2"]), "last error")
    check(all(math.isclose(math.log10(float(r["norm"])), float(r["log10_norm"]), abs_tol=1e-9) for r in rows), "log10_norm")


def check_scripts(name):
    """Checks the words on the picture and in the summary of this run."""
    with open(name + "-spectrum.json", "w") as file:  # what summary.py takes from the task spectrum
        json.dump({"formulation": "gas2", "courant": 0.2, "drift": 1 / 7, "verdict": "unstable", "spectrum": {},
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


def mpmstab_json(command, name):
    done = forks.run([*command, "-json", name], capture_output=True, text=True, check=False)
    check(done.returncode == 0, f"{' '.join(command)}: {done.stderr}")
    return loaded(name)


def check_modes(mpiexec, mpmstab):
    """A mode that spectrum writes grows at its own rate in a run, on any number of ranks."""
    scene = "-dim 2 -formulation usl -cells 6,5 -ppc 2 -courant 0.9".split()
    mpmstab_json([mpmstab, "spectrum", *scene, "-measure", "false", "-output", "modes_nd.h5"], "modes_nd.json")
    with h5py.File("modes_nd.h5", "r") as file:
        x = file["modes/coordinates"][:]
        check(x.shape == (120, 2) and abs(x - homes((6, 5), (2, 2)) / 6).max() < 1e-14, f"coordinates of modes {x.shape}")
        growth = float(file["modes/0001"].attrs["growth"])
        check({f"{f}_{part}" for f in ("v_x", "v_y", "s_xx", "s_xy", "s_yy") for part in ("re", "im")}
              <= set(file["modes/0001"].keys()), "fields of modes")
    check(growth > 1.01, f"growth {growth}")
    for ranks in (1, 2):
        run_of = mpmstab_json([mpiexec, "-n", str(ranks), mpmstab, "run", *scene, *("-initial eigenmode -mode 1 -mode_file "
                              "modes_nd.h5 -steps 100").split()], "modes_nd.json")
        check(math.isclose(run_of["run"]["growth_measured"], growth, rel_tol=1e-6), f"{run_of['run']} for {growth}")


def check_predictions(mpmstab):
    """Of waves along an axis the P wave is predicted as in one dimension, the S wave as there at k sqrt(mu)."""
    def predicted(courant, *options):
        done = forks.run([mpmstab, "run", "-formulation", "usl", "-transfer", "pic", "-mode", "3", "-courant",
                               str(courant), "-cells", "16", "-steps", "4", *options], capture_output=True, text=True, check=True)
        return float(next(line.split()[2] for line in done.stdout.splitlines() if "this mode" in line))
    plane = ("-dim", "2", "-poisson", "0.25")
    for courant, options, same in ((0.6, (), 0.6), (0.6, ("-polarisation", "s"), 0.6 / math.sqrt(3))):
        check(math.isclose(predicted(courant, *plane, *options), predicted(same), rel_tol=1e-8), f"prediction of {options}")


def main(mpiexec, mpmstab):
    check_modes(mpiexec, mpmstab)
    check_predictions(mpmstab)
    for case, options, cells, ppc, drift, periodic, waves, polarisation in CASES:
        first_fields = first_error = None
        for ranks in (1, 2, 3) if len(cells) == 1 else (1, 3):
            name = run(mpiexec, mpmstab, ranks, case, len(cells), options)
            fields = check_hdf5(name, cells, ppc, drift, periodic)
            if waves:
                check_start(fields, cells, ppc, waves, polarisation)
            else:
                check_json(name, ranks)
            check_xdmf(name, len(cells))
            error = loaded(name + ".json")["run"]["error"]
            check(set(error) == {field for _, field in fields}, f"errors of {set(error)}")
            check(all(0 <= e["l2"] <= e["linf"] < 2 for e in error.values()), f"errors: {error}")
            first_fields, first_error = first_fields or fields, first_error or error
            for key, values in fields.items():
                check(abs(values - first_fields[key]).max() < 1e-12, f"{key} on {ranks} ranks differs")
            for field, norms in error.items():
                check(all(math.isclose(v, first_error[field][n], rel_tol=1e-9, abs_tol=1e-12) for n, v in norms.items()),
                      f"error of {field} on {ranks} ranks")
        check_vtk(name, cells, ppc)
        if not waves:
            check_scripts(name)


if __name__ == "__main__":
    main(*sys.argv[1:3])
