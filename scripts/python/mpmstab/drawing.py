"""Draws results with the code of scripts/pictures.py.

That code lies in the folder pictures/ of an installed package, and in scripts/report/ of the sources.
"""
import importlib
import os
import sys

from .errors import BadInput

HERE = os.path.dirname(os.path.abspath(__file__))
INSTALLED = os.path.join(HERE, "pictures")
FOLDER = INSTALLED if os.path.isdir(INSTALLED) else os.path.join(os.path.dirname(os.path.dirname(HERE)), "report")


def picture_module(name):
    """Returns a module of the pictures. They import one another by name, so their folder is searched meanwhile."""
    if name not in sys.modules:
        sys.path.insert(0, FOLDER)
        try:
            importlib.import_module(name)
        finally:
            sys.path.remove(FOLDER)
    return sys.modules[name]


class Picture:
    """A picture, which notebooks show. figure is matplotlib's, save(NAME) writes NAME.png and NAME.svg."""

    def __init__(self, figure):
        self.figure = figure

    def save(self, name):
        picture_module("picture_style").save(self.figure, os.fspath(name))

    def _repr_png_(self):
        return picture_module("picture_style").encoded(self.figure, "png")


def spectrum(files):
    return picture_module("picture_spectra").spectrum(files["output"], files["json"])


def symbol(files):
    return picture_module("picture_spectra").symbol(files["output"], files["json"])


def modes(files, number=2):
    return picture_module("picture_modes").modes(files["output"], number)


def transient(files):
    return picture_module("picture_maps").transient(files["json"])


def pseudospectrum(files):
    return picture_module("picture_maps").pseudospectrum(files["output"], files["json"])


def growth(files, last=None):
    return picture_module("picture_runs").growth([files["json"]], last)


def spacetime(files, field=None):
    return picture_module("picture_runs").spacetime(files["output"], field)


def frame(files):
    return picture_module("picture_runs").last_frame(files["output"])


def growth_map(files):
    return picture_module("picture_maps").growth_map(files["output"], files["json"], files["csv"])


KINDS = {"spectrum": {"spectrum": spectrum, "symbol": symbol, "modes": modes, "transient": transient,
                      "pseudospectrum": pseudospectrum},
         "symbol": {"symbol": symbol},
         "run": {"growth": growth, "spacetime": spacetime, "frame": frame},
         "map": {"map": growth_map}}


def draw(result, kind, options):
    """Returns the picture of this kind. matplotlib's settings are as before afterwards."""
    if result.task not in KINDS:
        raise BadInput(f"there is no picture of {result.task}; there are of {', '.join(KINDS)}")
    kinds = KINDS[result.task]
    kind = kind or next(iter(kinds))
    if kind not in kinds:
        raise BadInput(f"plot {kind}: there is no such picture of {result.task}; allowed: {', '.join(kinds)}")
    if "formulation" not in result.json:
        raise BadInput("there is no picture of a matrix or of blocks; allowed: a scene of the program's own")
    import matplotlib  # here, since only pictures need it

    with matplotlib.rc_context():
        matplotlib.rcParams.update(picture_module("picture_style").LOOK)
        try:
            return Picture(kinds[kind](result.files, **options))
        except picture_module("picture_files").Refusal as refusal:
            raise BadInput(str(refusal)) from None
