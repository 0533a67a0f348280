"""What a command has written, as a dictionary without levels: short, and without what is time, memory or version."""
import csv
import itertools
import json
import math
import os
import re

import h5py
import numpy

NOTHING = 1e-11  # numbers below it that are printed for people are rounding
SHOWN = 5        # of a long array, besides its norm
# Times, memory, versions: of the machine, not of the answer.
MACHINE = re.compile(r"(^|[._:/@])(\w*_s|seconds|ns_per_particle_step|memory\w*|version\w*|created|command|host\w*)$")
MASKED = ((re.compile(r"^(time|memory): .*"), r"\1: *"),
          (re.compile(r"^mpmstab \d[\w.]* "), "mpmstab * "),
          (re.compile(r"^( *(?:PETSc|SLEPc|MPI|mpmstab) +).*\d\.\d.*"), r"\1*"))


def lines(text):
    """The lines of a text for people, with what is of the machine masked."""
    found = text.rstrip("\n").split("\n") if text else []
    for pattern, mask in MASKED:
        found = [pattern.sub(mask, line) for line in found]
    return found


def flat(path, value):
    """Yields the numbers and words of a tree with their paths."""
    if isinstance(value, dict):
        for key, below in value.items():
            yield from flat(f"{path}.{key}" if path[-1] != ":" else path + key, below)
    elif isinstance(value, list) and any(isinstance(below, (dict, list)) for below in value):
        for number, below in enumerate(value):
            yield from flat(f"{path}[{number}]", below)
    elif isinstance(value, list) and value and all(below is None or isinstance(below, float) for below in value):
        yield from numbers(path, [math.nan if below is None else below for below in value])
    else:
        yield path, value


def numbers(path, values):
    """Yields an array: whole when short, else some of it and its norm."""
    values = numpy.asarray(values).ravel()
    if numpy.iscomplexobj(values):
        values = values.view(float)
    if values.size <= 2 * SHOWN:
        yield path, values.tolist()
        return
    at = numpy.linspace(0, values.size - 1, SHOWN).astype(int)
    yield f"{path} ({values.size})", values[at].tolist()
    with numpy.errstate(over="ignore", invalid="ignore"):
        yield f"{path} norm", float(numpy.linalg.norm(values.astype(float)))


def table(path, name):
    """Yields the columns of a CSV file; columns of words as words and how often each comes one after another."""
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    yield f"{name}:columns", ",".join(rows[0])
    yield f"{name}:rows", len(rows) - 1
    for k, column in enumerate(rows[0]):
        values = [row[k] for row in rows[1:]]
        try:
            yield from numbers(f"{name}:{column}", [float(value) if value else numpy.nan for value in values])
        except ValueError:
            yield f"{name}:{column}", [f"{len(list(same))} {word}" for word, same in itertools.groupby(values)]


def array(path, values):
    """Yields the shape, type and numbers of an array of a file."""
    yield f"{path}:shape", f"{values.dtype.kind} {values.shape}"
    if values.dtype.kind in "fiuc":
        yield from numbers(path, values)
    else:
        yield path, str(values.tolist())[:200]


def hdf5(path, name):
    """Yields the data sets and attributes of an HDF5 file."""
    with h5py.File(path, "r") as file:
        objects = {}
        file.visititems(lambda key, value: objects.update({key: value}))
        for key, value in [("", file), *sorted(objects.items())]:
            for word, attribute in sorted(value.attrs.items()):
                yield f"{name}:{key}@{word}", str(attribute) if isinstance(attribute, (bytes, str)) \
                    else numpy.asarray(attribute).tolist()
            if isinstance(value, h5py.Dataset):
                yield from array(f"{name}:{key}", numpy.asarray(value[()]))


def file(path, name):
    """Yields what a file has, by its ending."""
    ending = os.path.splitext(name)[1]
    if ending == ".json":
        with open(path, encoding="utf-8") as opened:
            yield from flat(f"{name}:", json.load(opened))
    elif ending == ".csv":
        yield from table(path, name)
    elif ending in (".h5", ".hdf5"):
        yield from hdf5(path, name)
    elif ending == ".npz":
        with numpy.load(path) as opened:
            for key in opened.files:
                yield from array(f"{name}:{key}", opened[key])
    elif ending == ".mtx":
        with open(path, encoding="utf-8") as opened:
            rows = opened.read().split("\n")
        comments = [row for row in rows if row.startswith("%")]
        yield f"{name}:text", comments
        yield from numbers(f"{name}:entries", [float(word) for row in rows[len(comments):] for word in row.split()])
    elif ending in (".xmf", ".yaml", ".txt"):
        with open(path, encoding="utf-8") as opened:
            yield f"{name}:text", lines(opened.read())
    elif ending == ".so":
        yield f"{name}", "written"
    else:
        yield f"{name}:bytes", os.path.getsize(path)


def files(folder):
    """What the files of a folder have; links lead to what was there before."""
    found = {}
    for name in sorted(os.listdir(folder)):
        path = os.path.join(folder, name)
        if not os.path.islink(path):
            found.update((key, value) for key, value in file(path, name) if not MACHINE.search(key))
    return found
