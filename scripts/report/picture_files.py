"""Reads what the program has written, for pictures and reports, and refuses files that it has not written."""
import csv
import json
import math
import os

import h5py
import numpy

from program import fault_of


class Refusal(Exception):
    """Bad input; its text is the one line that is said."""


NUMBER, OPTIONAL = (int, float), (int, float, type(None))
WORDS = {str: "a text", int: "a whole number", NUMBER: "a number", OPTIONAL: "a number or null", dict: "an object"}
# The types of values in JSON.
KINDS = {"task": str, "formulation": str, "basis": str, "transfer": str, "boundary": str, "cells": int, "ppc": NUMBER,
         "particles": int, "courant": NUMBER, "drift": NUMBER, "growth": OPTIONAL, "predicted": dict, "run": dict,
         "spectrum": dict, "symbol": dict, "map": dict, "transient": dict, "pseudospectrum": dict}
SCENE = ("formulation", "basis", "transfer", "boundary", "cells", "ppc", "particles", "courant", "drift")


def refuse(path, why, allowed):
    raise Refusal(f"{path}: {why}; allowed: {allowed}")


def require_file(path, made_by):
    """Refuses what is not a file that can be read from its beginning to its end."""
    fault = fault_of(path)
    if fault:
        refuse(path, fault, made_by)


def open_hdf5(path):
    require_file(path, "an HDF5 file that mpmstab has written with -output")
    try:
        return h5py.File(path, "r")
    except OSError:
        return refuse(path, "is not HDF5, or damaged", "an HDF5 file that mpmstab has written with -output")


def array(file, name, made_by, columns=None):
    """Returns a whole dataset of numbers, with so many columns; made_by names the command that writes it."""
    made = f"a file that 'mpmstab {made_by}' has written"
    found = file.get(name)
    if not isinstance(found, h5py.Dataset):
        refuse(file.file.filename, f"no /{name} in it", made)
    if found.dtype.kind in "fiu" and found.size * found.dtype.itemsize > os.path.getsize(file.file.filename):
        refuse(file.file.filename, f"/{name} is larger than the file, which is damaged", made)
    values = found[()]
    if not numpy.size(values) or values.dtype.kind not in "fiu":
        refuse(file.file.filename, f"no numbers in /{name}", made)
    if columns and (values.ndim != 2 or values.shape[1] != columns):
        refuse(file.file.filename, f"/{name} has the shape {values.shape}", made)
    return values


def read_json(path):
    made = "a file that mpmstab has written with -json"
    require_file(path, made)
    try:
        with open(path, encoding="utf-8") as file:
            result = json.load(file)
    except RecursionError:
        return refuse(path, "is nested too deep", made)
    except ValueError:
        return refuse(path, "is not JSON", made)
    if not isinstance(result, dict) or any(key not in result for key in (*SCENE, "task")):
        refuse(path, "is not a result of mpmstab", made)
    for key, kinds in KINDS.items():
        if key in result and (not isinstance(result[key], kinds) or isinstance(result[key], bool)):
            refuse(path, f"'{key}' is not {WORDS[kinds]}", made)
    return result


def part(result, key, path, made_by):
    if key not in result:
        refuse(path, f"no '{key}' in it", f"a file that 'mpmstab {made_by}' has written")
    return result[key]


def read_csv(path, columns, made_by):
    """Returns the rows as dicts of floats, NaN where a cell is empty. The file must have all these columns."""
    require_file(path, f"a file that 'mpmstab {made_by}' has written")
    try:
        with open(path, newline="", encoding="utf-8") as file:
            reader = csv.DictReader(file)
            head = reader.fieldnames or []
            rows = [{key: float(text) if text else math.nan for key, text in row.items()} for row in reader]
    except (TypeError, ValueError, csv.Error):
        return refuse(path, "holds what is no number", f"a file that 'mpmstab {made_by}' has written")
    missing = [column for column in columns if column not in head]
    if missing:
        refuse(path, f"no column '{missing[0]}' in it", f"a file that 'mpmstab {made_by}' has written")
    return rows


def read_words(path, column, made_by):
    """Returns one column of a CSV, as texts."""
    require_file(path, f"a file that 'mpmstab {made_by}' has written")
    try:
        with open(path, newline="", encoding="utf-8") as file:
            return [row[column] for row in csv.DictReader(file)]
    except KeyError:
        return refuse(path, f"no column '{column}' in it", f"a file that 'mpmstab {made_by}' has written")
    except (ValueError, csv.Error):
        return refuse(path, "is not CSV", f"a file that 'mpmstab {made_by}' has written")


def attributes(file):
    """Returns the scene that an HDF5 file holds in its attributes."""
    scene = {}
    for key, value in file.attrs.items():
        scene[key] = value.decode() if isinstance(value, bytes) else value
    missing = [key for key in SCENE if key not in scene]
    if missing:
        refuse(file.filename, f"no '{missing[0]}' in its attributes", "a file that mpmstab has written with -output")
    return scene


def complex_pairs(values):
    """Returns rows of re, im, re, im, ... as complex numbers."""
    return values[:, 0::2] + 1j * values[:, 1::2]


def period(scene):
    """Returns the number of steps after which drifting particles lie in their cells as before."""
    return int(str(scene.get("drift_exact", "0/1")).rsplit("/", maxsplit=1)[-1])


def steps_of(file):
    """Returns the numbers and groups of the output steps of a run."""
    names = sorted(name for name in file if name.startswith("step_"))
    if not names:
        refuse(file.filename, "no /step_... in it", "a file that 'mpmstab run -output -output_every n' has written")
    return [(int(name[len("step_"):]), file[name]) for name in names]


def fields_of(group):
    """Returns the fields that both nodes and particles have, with displacement or velocity first."""
    return sorted((name for name in group["nodes"] if name in group["particles"]), key="uvrwsc".find)


def drift_text(scene):
    exact = str(scene.get("drift_exact", ""))
    if exact.endswith("/1") or not exact:
        return f"{float(scene['drift']):.6g}"
    return exact


def scene_parts(scene):
    """Describes a scene, as texts by key. It comes from the attributes of an HDF5 file or from a JSON object."""
    layout = [f"offset {float(scene.get('offset', 0.5)):.6g}"]
    jitter = float(scene.get("jitter", 0))
    if jitter:
        layout.append(f"jitter {jitter:.6g} (seed {int(scene['seed'])})")
    counts = scene.get("counts", "")
    counts = counts if isinstance(counts, str) else ",".join(str(count) for count in counts)
    if "," in counts:
        layout.append(f"counts {counts}")
    low, high = scene.get("cluster", (scene.get("cluster_from", 0), scene.get("cluster_to", 1)))
    if high - low < 1:
        layout.append(f"cluster {low:.6g},{high:.6g}")
    material = scene.get("material", "uniform")
    kind = material if isinstance(material, str) else material["kind"]
    if kind != "uniform":
        ratios = scene if isinstance(material, str) else material
        layout.append(f"material {kind} (density ratio {ratios['density_ratio']:.6g}, "
                      f"stiffness ratio {ratios['stiffness_ratio']:.6g})")
    transfer = scene["transfer"]
    for option in ("blend_ratio", "xpic_order"):
        if option in scene:
            transfer += f" ({option} {float(scene[option]):g})"
    return {"formulation": scene["formulation"], "basis": f"{scene['basis']} basis", "transfer": transfer,
            "courant": f"k = {float(scene['courant']):.6g}", "drift": f"drift {drift_text(scene)}",
            "cells": f"{int(scene['cells'])} cells",
            "ppc": f"{int(scene['ppc'])} particle{'s' if scene['ppc'] > 1 else ''} a cell",
            "layout": ", ".join(layout), "boundary": f"ends {scene['boundary']}"}


def compared(scene):
    """Returns the parts of a scene that must agree in two files. Drift is a number here, as in JSON."""
    material = scene.get("material", "uniform")
    inclusion = material.get("inclusion", (0, 0)) if isinstance(material, dict) else (0, 0)
    if material == "two":
        inclusion = scene["inclusion_from"], scene["inclusion_to"]
    return {**scene_parts(scene), "courant": f"k = {float(scene['courant']):.12g}",
            "drift": f"drift {float(scene['drift']):.12g}", "particles": f"{int(scene['particles'])} particles",
            "inclusion": f"inclusion {inclusion[0]:.12g},{inclusion[1]:.12g}"}


def require_same(path, scene, other_path, other):
    """Refuses two files that are of different scenes."""
    ours, theirs = compared(scene), compared(other)
    differs = [f"{ours[key]} and {theirs[key]}" for key in ours if ours[key] != theirs[key]]
    if differs:
        refuse(f"{path} and {other_path}", f"of different scenes: {differs[0]}", "files of one scene")


def result_beside(path, scene, result_path, *tasks):
    """Returns a JSON result, which must be of one of these tasks and of the scene of another file.

    The scene is None when that file does not say it.
    """
    result = read_json(result_path)
    if result["task"] not in tasks:
        refuse(f"{path} and {result_path}", f"the second is of the task {result['task']}", " or ".join(tasks))
    if scene:
        require_same(path, scene, result_path, result)
    return result


def scene_text(scene):
    parts = scene_parts(scene)
    return (", ".join(parts[key] for key in ("formulation", "basis", "transfer", "courant")) + f", {parts['drift']} "
            "(cells per step)\n" + ", ".join(parts[key] for key in ("cells", "ppc", "layout", "boundary")))


def finite_range(values):
    values = values[numpy.isfinite(values)]
    return (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)
