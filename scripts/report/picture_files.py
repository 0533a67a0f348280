"""Reads what the program has written, for pictures and reports, and refuses files that it has not written."""
import csv
import json
import math
import os

import h5py
import numpy

from whole_files import fault_of


class Refusal(Exception):
    """Bad input; its text is the one line that is said."""


NUMBER, OPTIONAL = (int, float), (int, float, type(None))
WORDS = {str: "a text", int: "a whole number", NUMBER: "a number", OPTIONAL: "a number or null", dict: "an object"}
# The types of values in JSON.
KINDS = {"task": str, "formulation": str, "basis": str, "transfer": str, "boundary": str, "dim": int, "cells": int,
         "ppc": NUMBER, "particles": int, "courant": NUMBER, "drift": NUMBER, "growth": OPTIONAL, "predicted": dict,
         "run": dict, "spectrum": dict, "symbol": dict, "map": dict, "transient": dict, "pseudospectrum": dict}
EACH = ("cells", "ppc", "drift")  # with more than one dimension these are lists, with a value for each direction
CODE = ("program", "plugin")  # one of them stands for a code in the place of a scene
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


def is_of(value, kinds, dim):
    """Says whether a value is of these types; with more than one dimension it must be a list, with one for each."""
    if dim > 1:
        return isinstance(value, list) and len(value) == dim and all(is_of(one, kinds, 1) for one in value)
    return isinstance(value, kinds) and not isinstance(value, bool)


def read_json(path, of_code=False):
    """Returns a result of a scene, or of a code that was probed."""
    made = "a file that mpmstab has written with -json"
    require_file(path, made)
    try:
        with open(path, encoding="utf-8") as file:
            result = json.load(file)
    except RecursionError:
        return refuse(path, "is nested too deep", made)
    except ValueError:
        return refuse(path, "is not JSON", made)
    whole = isinstance(result, dict) and "task" in result
    if not whole or not (any(key in result for key in CODE) if of_code else all(key in result for key in SCENE)):
        refuse(path, "is not a result of mpmstab", made)
    for key, kinds in KINDS.items():
        dim = result.get("dim", 1) if key in EACH else 1
        if key in result and not is_of(result[key], kinds, dim):
            refuse(path, f"'{key}' is not {f'a list of {dim}, each ' if dim > 1 else ''}{WORDS[kinds]}", made)
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


def complex_pairs(values):
    """Returns rows of re, im, re, im, ... as complex numbers."""
    return values[:, 0::2] + 1j * values[:, 1::2]


def steps_of(file):
    """Returns the numbers and groups of the output steps of a run."""
    names = sorted(name for name in file if name.startswith("step_"))
    if not names:
        refuse(file.filename, "no /step_... in it", "a file that 'mpmstab run -output -output_every n' has written")
    return [(int(name[len("step_"):]), file[name]) for name in names]


def fields_of(group):
    """Returns the fields that both nodes and particles have, with displacement or velocity first."""
    return sorted((name for name in group["nodes"] if name in group["particles"]), key="uvrwsc".find)


def finite_range(values):
    values = values[numpy.isfinite(values)]
    return (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)
