"""What a task found: the values of its JSON as attributes, and the arrays of its other files."""
import csv
import html
import json
import os
import shutil
import weakref

import numpy

from .drawing import draw, picture_module

COMPLEX = ("spectrum/eigenvalues", "symbol/factors")  # real and imaginary parts in turn in the file
TABLES = {"map": "map/growth"}  # what the attribute table stands for


def converted(value):
    """Returns a value of JSON with objects as Sections and lists of numbers as arrays, where null is NaN."""
    if isinstance(value, dict):
        return Section({key: converted(one) for key, one in value.items()})
    if isinstance(value, list):
        numbers = [numpy.nan if one is None else one for one in value]
        if value and all(isinstance(one, (int, float)) for one in numbers):
            return numpy.array(numbers)
        return [converted(one) for one in value]
    return value


class Section(dict):
    """An object of the JSON; its keys are attributes too."""

    def __getattr__(self, name):
        if name in self:
            return self[name]
        raise AttributeError(f"no '{name}' here, which means that it was not computed; there are {', '.join(self)}")

    def __dir__(self):
        return [*super().__dir__(), *self]


def column(texts):
    """Returns a column of a CSV as numbers, NaN where a cell is empty, or as texts."""
    try:
        return numpy.array([float(text) if text else numpy.nan for text in texts])
    except ValueError:
        return numpy.array(texts)


class Result:
    """What a task found.

    Attributes, or keys in brackets, are those of the program's JSON: r.verdict, r.growth, r.critical.critical_courant.
    Arrays of the HDF5 file are attributes by their own name (r.eigenvalues, r.beta, r.factors; r.table is the growth of
    a map), and r.array("step_0000000100/particles/u") by their path, of which r.arrays is the list. r.rows are the
    columns of the CSV by name. str(r) is the table that the program prints.

    Its files lie in a folder of their own, which is removed with the result.
    """

    def __init__(self, task, folder, files, status, complaint):
        self.task, self.files = task, files
        self.expectation_missed, self.complaint = status == 3, complaint
        self.json = {}
        if "json" in files:
            with open(files["json"], encoding="utf-8") as file:
                self.json = json.load(file)
        self.values = converted(self.json)
        with open(os.path.join(folder, "table.txt"), encoding="utf-8", errors="replace") as file:
            self.text = file.read()
        self._remove = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)

    def __getitem__(self, key):
        return self.values[key]

    def __getattr__(self, name):
        if name.startswith("_") or "values" not in self.__dict__:
            raise AttributeError(name)
        if name in self.values:
            return self.values[name]
        path = self._path_of(name)
        if path:
            return self.array(path)
        there = [*self.values, *sorted({path.rsplit("/", 1)[-1] for path in self._named()})]
        raise AttributeError(f"no '{name}' in this result of {self.task}, which means that it was not computed; "
                             f"there are {', '.join(there)}")

    def __dir__(self):
        return [*super().__dir__(), *self.values]

    def _named(self):
        """Returns the paths of arrays that a name stands for, those of the task's own group first."""
        groups = [self.task, *(group for group in ("spectrum", "symbol", "transient", "pseudospectrum")
                               if group != self.task)]
        arrays = self.arrays
        return [path for group in groups for path in arrays if path.startswith(f"{group}/")]

    def _path_of(self, name):
        if name == "table" and self.task in TABLES:
            return TABLES[self.task]
        return next((path for path in self._named() if path.rsplit("/", 1)[-1] == name), None)

    def _opened(self):
        import h5py  # here: adapters of this package run where h5py need not be

        return h5py.File(self.files["output"], "r")

    @property
    def arrays(self):
        """The paths of the arrays in the HDF5 file, in the order of their names."""
        paths = []
        if "output" in self.files:
            with self._opened() as file:
                file.visititems(lambda path, item: paths.append(path) if hasattr(item, "dtype") else None)
        return paths

    def array(self, path):
        """Returns an array of the HDF5 file; eigenvalues and factors are complex."""
        if path not in self.arrays:
            raise KeyError(f"no array '{path}' in this result of {self.task}; .arrays is the list of all")
        with self._opened() as file:
            values = file[path][()]
        if path not in COMPLEX:
            return values
        pairs = picture_module("picture_files").complex_pairs(values)
        return pairs[:, 0] if pairs.shape[1] == 1 else pairs

    @property
    def rows(self):
        """The columns of the CSV by name."""
        if "csv" not in self.files:
            return {}
        with open(self.files["csv"], newline="", encoding="utf-8") as file:
            lines = list(csv.reader(file))
        return {line[0]: column(line[1:]) for line in map(list, zip(*lines))}

    def plot(self, kind=None, **options):
        """Draws the result, as scripts/pictures.py does.

        kind: of spectrum 'spectrum', 'symbol', 'modes' (number=2), 'transient' or 'pseudospectrum'; of symbol 'symbol';
        of run 'growth' (last=STEP), 'spacetime' (field=NAME) or 'frame'; of map 'map'. The first is the default.
        """
        return draw(self, kind, options)

    def __str__(self):
        return self.text

    def __repr__(self):
        said = [f"{key}={self.json[key]!r}" for key in ("verdict", "growth") if key in self.json]
        return f"<mpmstab {self.task}: {', '.join(said) or 'no JSON'}>"

    def _repr_html_(self):
        own = self.json.get(self.task, {})
        listed = {key: self.json[key] for key in ("verdict", "growth", "evidence") if key in self.json}
        listed.update({key: value for key, value in own.items() if not isinstance(value, (list, dict))})
        if self.expectation_missed:
            listed["expectation missed"] = self.complaint
        title = self.text.splitlines()[:2]
        left = "style='text-align:left'"
        cells = "".join(f"<tr><th {left}>{html.escape(key)}</th><td {left}>{html.escape(str(value))}</td></tr>"
                        for key, value in listed.items())
        return f"<div><p>{'<br>'.join(map(html.escape, title))}</p><table>{cells}</table></div>"
