#!/usr/bin/python3
"""Checks that pictures.py refuses, in one line, files that are damaged or do not belong together.

check_picture_files.py MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import glob
import json
import os
import resource
import shutil
import sys

import h5py
import numpy

from checks import check, loaded, run_script, text_of
import pictures
from check_pictures import SCENES, check_refused, make, mpmstab

MPMSTAB = sys.argv[1]


def damaged():
    """Makes files that are HDF5 but not whole."""
    for name, values in (("flat", [1.0, 0, 0, 1]), ("empty", numpy.zeros((0, 2))), ("lost", None)):
        shutil.copy("gas2.h5", f"{name}.h5")
        with h5py.File(f"{name}.h5", "r+") as file:
            if values is None:
                del file.attrs["courant"]
            else:
                del file["spectrum/eigenvalues"]
                file["spectrum/eigenvalues"] = values


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
            (("growth", "gas1-run.json", "-s", "-1"), "-s -1: allowed: 1 or more steps"),
            (("growth", "gas1-run.json", "-s", "0"), "-s 0: allowed: 1 or more steps")):
        check_refused(arguments, says)


def check_full_disk():
    """A picture that does not fit on the disk must leave nothing behind, and no file of the user may be overwritten."""
    with open("full.png.part", "w", encoding="utf-8") as file:
        file.write("mine")
    limit = (5000, resource.getrlimit(resource.RLIMIT_FSIZE)[1])
    check_refused(("modes", "gas2.h5", "-o", "full"), "full.png: File too large",
                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, limit))
    check(run_script("pictures.py", "modes", "gas2.h5", "-o", "full").returncode == 0, "there is space again")
    check(text_of("full.png.part") == "mine", "a file of the user's was overwritten")
    check(glob.glob("*.part") == ["full.png.part"], f"left behind: {glob.glob('*.part')}")
    os.remove("full.png.part")


def check_not_regular():
    """A pipe without a writer and a device without an end must be refused, not read for ever."""
    for name in ("pipe.h5", "pipe.json", "pipe.csv"):
        if not os.path.exists(name):
            os.mkfifo(name)
    shutil.copy("gas1-run.json", "pipe.result")
    SCENES["grid"] = "-formulation gas2"  # the axes of a map take the place of the Courant number
    mpmstab(MPMSTAB, "map", "grid", "-map_points", "3,3", "-output", "grid.h5", "-json", "grid.json")
    for arguments, name in ((("spectrum", "pipe.h5"), "pipe.h5"), (("frames", "pipe.h5"), "pipe.h5"),
                            (("spectrum", "gas2.h5", "pipe.json"), "pipe.json"), (("growth", "pipe.json"), "pipe.json"),
                            (("transient", "/dev/zero"), "/dev/zero"), (("modes", "/dev/zero"), "/dev/zero"),
                            (("symbol", "pipe.csv"), "pipe.csv"), (("growth", "pipe.result"), "pipe.csv"),
                            (("map", "grid.h5", "grid.json", "pipe.csv"), "pipe.csv")):
        check_refused(arguments, f"{name}: is not a regular file", timeout=60)
    check_refused(("modes", "."), ".: is a folder")


def check_wrong_types():
    """JSON that is not a result of mpmstab must be refused, whatever its form."""
    run, powers = loaded("gas1-run.json"), {**loaded("gas2.json"), "transient": {"steps": 5}}
    shutil.copy("gas1-run.csv", "wrong.csv")
    for kind, content, says in (
            ("growth", "[" * 1000 + "]" * 1000, "is nested too deep"),
            ("growth", '{"a":' * 100000 + "1" + "}" * 100000, "is nested too deep"),
            ("growth", json.dumps({**run, "courant": "fast"}), "'courant' is not a number"),
            ("growth", json.dumps({**run, "drift": True}), "'drift' is not a number"),
            ("growth", json.dumps({**run, "cells": [1]}), "'cells' is not a whole number"),
            ("growth", json.dumps({**run, "run": []}), "'run' is not an object"),
            ("growth", json.dumps({**run, "predicted": None}), "'predicted' is not an object"),
            ("growth", json.dumps({**run, "predicted": {"corrected": "x"}}), "cannot be drawn"),
            ("growth", json.dumps({**run, "counts": [None], "courant": 10**400}), "cannot be drawn"),
            ("transient", json.dumps(powers), "cannot be drawn"),
            ("transient", json.dumps({**powers, "growth": "1"}), "'growth' is not a number or null")):
        with open("wrong.json", "w", encoding="utf-8") as file:
            file.write(content)
        check_refused((kind, "wrong.json"), f"wrong.json: {says}")


def check_outputs():
    """An output must be refused when it is an input, by any name or link, or when it is no regular file."""
    os.makedirs("kept", exist_ok=True)
    for source, target in (("gas2.json", "kept/in.png"), ("drift-run.h5", "kept/movie.gif"),
                           ("gas2.h5", "kept/gas2.h5"), ("gas1-run.json", "kept/run.json"),
                           ("gas1-run.csv", "kept/run.csv")):
        shutil.copy(source, target)
    for name, target in (("link.png", "gas2.h5"), ("csv.svg", "run.csv"), ("device.png", "/dev/full")):
        if not os.path.lexists(f"kept/{name}"):
            os.symlink(target, f"kept/{name}")
    for name in ("pipe.svg", "step_0000000000.png"):
        if not os.path.exists(f"kept/{name}"):
            os.mkfifo(f"kept/{name}")
    for arguments, says in (
            (("transient", "kept/in.png", "-o", "kept/in"), "kept/in.png: would replace the input kept/in.png"),
            (("spectrum", "kept/gas2.h5", "-o", "kept/link"), "kept/link.png: would replace the input kept/gas2.h5"),
            (("growth", "kept/run.json", "-o", "kept/csv"), "kept/csv.svg: would replace the input kept/run.csv"),
            (("spectrum", "kept/gas2.h5", "-o", "kept/pipe"), "kept/pipe.svg: is not a regular file"),
            (("spectrum", "kept/gas2.h5", "-o", "kept/device.png"), "kept/device.png: is not a regular file"),
            (("frames", "drift-run.h5", "-o", "kept"), "kept/step_0000000000.png: is not a regular file")):
        before = sorted(os.listdir("kept"))
        check_refused(arguments, says)
        check(sorted(os.listdir("kept")) == before, f"{arguments}: something was written")
    os.remove("kept/step_0000000000.png")
    check_refused(("frames", "kept/movie.gif", "-o", "kept"), "kept/movie.gif: would replace the input kept/movie.gif")


def check_scenes():
    """Files of different scenes or tasks must not be combined. Drift 1/8 and 0.125 are the same."""
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
    check_full_disk()
    check_not_regular()
    check_wrong_types()
    check_outputs()
    check_scenes()


if __name__ == "__main__":
    main()
