#!/usr/bin/python3
"""Checks that pictures.py refuses, in one line, files that are damaged or do not belong together.

check_picture_files.py MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import glob
import json
import os
import shutil
import sys

import h5py
import numpy

from checks import check, loaded
import pictures
from check_pictures import SCENES, check_refused, make, mpmstab

MPMSTAB = sys.argv[1]


def damaged():
    """Files that are HDF5 but not whole."""
    for name, values in (("flat", [1.0, 0, 0, 1]), ("empty", numpy.zeros((0, 2))), ("lost", None)):
        shutil.copy("gas2.h5", f"{name}.h5")
        with h5py.File(f"{name}.h5", "r+") as file:
            if values is None:
                del file.attrs["courant"]
            else:
                del file["spectrum/eigenvalues"]
                file["spectrum/eigenvalues"] = values
    if not os.path.islink("full.png.part"):
        os.symlink("/dev/full", "full.png.part")


def check_refusals():
    damaged()
    with open("plain.h5", "w", encoding="utf-8") as file:
        file.write("not HDF5")
    with open("list.json", "w", encoding="utf-8") as file:
        file.write("[1]")
    for arguments, says in (
            (("spectrum", "none.h5"), "none.h5: no such file"), (("spectrum", "plain.h5"), "is not HDF5"),
            (("modes", "gas1-symbol.h5"), "gas1-symbol.h5: no /modes in it"),
            (("spacetime", "gas1.h5"), "no /step_... in it"), (("frames", "gas1.h5"), "no /step_... in it"),
            (("spacetime", "drift-run.h5", "v"), "no field 'v' in it; allowed: u or r"),
            (("transient", "list.json"), "not a result"), (("growth", "plain.h5"), "is not JSON"),
            (("growth", "gas1.json"), "is of the task spectrum"), (("symbol", "gas1-run.csv"), "no column 'beta'"),
            (("modes", "gas2.h5", "-o", "nowhere/x"), "nowhere/x.png: No such file"),
            (("circle", "gas2.h5"), "invalid choice: 'circle'"), (("modes", "gas2.h5", "-n", "9"), "invalid choice: 9"),
            (("spectrum", "flat.h5"), "/spectrum/eigenvalues has the shape (4,)"),
            (("spectrum", "empty.h5"), "no numbers in /spectrum/eigenvalues"),
            (("spectrum", "lost.h5"), "no 'courant' in its attributes"),
            (("modes", "gas2.h5", "-o", "full"), "full.png: No space left")):
        check_refused(arguments, says)
    check(not glob.glob("full.png*"), "a .part is left")


def check_scenes():
    """Files of other scenes and other tasks do not lend one another numbers; drift 1/8 and 0.125 are the same."""
    with open("map.json", "w", encoding="utf-8") as file:
        json.dump({**loaded("gas2.json"), "task": "map"}, file)
    for arguments, says in (
            (("spectrum", "gas2.h5", "gas1.json"), "gas2.h5 and gas1.json: of different scenes: gas2 and gas1"),
            (("spectrum", "gas2.h5", "jitter.json"), "offset 0.5 and offset 0.5, jitter 0.4"),
            (("spectrum", "gas2.h5", "map.json"), "gas2.h5 and map.json: the second is of the task map"),
            (("spectrum", "gas1.h5", "gas1-run.json"), "the second is of the task run"),
            (("symbol", "gas1-symbol.h5", "gas2.h5"), "gas1-symbol.h5 and gas2.h5: of different scenes"),
            (("symbol", "drift-symbol.h5", "drift.h5", "pic.json"), "drift-symbol.h5 and pic.json: of different"),
            (("symbol", "gas1-symbol.csv", "gas1.h5", "gas2.json"), "scenes: largest growth 1.11803399 and 1"),
            (("symbol", "gas1-symbol.csv", "gas2.h5", "gas1.json"), "gas1.json and gas2.h5: of different scenes"),
            (("pseudospectrum", "powers.h5", "gas1.json"), "powers.h5 and gas1.json: of different scenes")):
        check_refused(arguments, says)
    SCENES["bar"] = "-formulation usl -courant 0.5 -material two -inclusion 0.25,0.5 -density_ratio 3"
    for name, *options in (("gas2", "-counts", "1,3"), ("gas2", "-transfer", "blend", "-blend_ratio", "0.3"),
                           ("bar",),
                           ("gas2", "-drift", "1/3", "-offset", "1/3"), ("jitter", "-cluster", "0.2,0.7")):
        mpmstab(MPMSTAB, "spectrum", name, *options, "-output", "own.h5", "-json", "own.json")
        pictures.spectrum("own.h5", "own.json")


def main():
    make(MPMSTAB)
    mpmstab(MPMSTAB, "spectrum", "gas2", "-pseudospectrum", "8", "-output", "powers.h5")
    check_refusals()
    check_scenes()


if __name__ == "__main__":
    main()
