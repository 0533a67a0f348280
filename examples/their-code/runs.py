#!/usr/bin/python3
"""Prints the table of runs.md: growth that mpmstab predicts of codes at rest and in motion, and growth of their runs.

runs.py [--check]

With --check it fails unless the page has each row. MPMAT_DIR and MLSMPM_DIR name clones of mpmat and mls-mpm.js, MPMSTAB_TAICHI a Python that
has Taichi. Rows of codes that are not there are left out; the status is 77 if none is.
"""
import os
import pathlib
import shutil
import sys

from sources import HERE, ROOT, ask, finish, skip

BLOCK = ["-program_scene", "cells=6,fill=2,4"]
os.environ["PYTHONPATH"] = str(ROOT / "scripts/python")


def row(name, command, dt, drift, steps, velocity, cell_width, *words):
    """The largest growth of all modes, and that of a run. velocity: the name of the field; drift: cells a step in each direction."""
    asked = ["-program", command, "-program_set", f"dt={dt!r}", *words]
    predicted = ask("spectrum", *asked, *(["-drift", drift] if drift else []))
    moves = ["-program_base", f"{velocity}={cell_width / float(drift[2:]) / dt!r}"] if drift else []
    run = ask("spectrum", *asked, *moves, "-program_run", steps)["measured"]
    return (f"| {name} | {dt:.6g} | {drift or 0} | {predicted['growth']:.4f} | {run['growth']:.4f} | "
            f"{run['low']:.4f} to {run['high']:.4f} |")


def mpm88():
    python = os.environ.get("MPMSTAB_TAICHI")
    if python:
        code = f"{python} {HERE / 'taichi_mpm.py'} mpm88 f64"
        yield row("mpm88", code, 4e-4, None, 200, "v", 1 / 128, *BLOCK)
        yield row("mpm88", code, 3.8e-4, "1/4", 200, "v", 1 / 128, *BLOCK)


def mls_mpm_js():
    folder = pathlib.Path(os.environ.get("MLSMPM_DIR", "mls-mpm.js")).resolve()
    if shutil.which("node") and (folder / "mls-mpm.js").exists():
        code = f"node {HERE / 'mlsmpm.js'} {folder} elastic"
        yield row("mls-mpm.js", code, 1.38e-4, None, 80, "v", 1 / 80, *BLOCK)
        yield row("mls-mpm.js", code, 1.36e-4, "1/4", 100, "v", 1 / 80, *BLOCK)


def mpmat():
    folder = pathlib.Path(os.environ.get("MPMAT_DIR", "mpmat")).resolve()
    if shutil.which("octave-cli") and (folder / "example1D").exists():
        code = f"octave-cli -q {HERE / 'mpmat.m'} {folder} doubleMapping=1 L=150 noElems=96 middle=8 shift=0.01"
        h, c = 150 / 96, 10
        yield row("mpmat", code, 1.75 * h / c, None, 200, "vp", h)
        yield row("mpmat", code, 0.5 * h / c, "1/8", 320, "vp", h)


if __name__ == "__main__":
    rows = [*mpm88(), *mls_mpm_js(), *mpmat()]
    if not rows:
        skip("none of the codes is there")
    finish("runs.md", rows)
    print(f"{len(rows)} of 6 rows", file=sys.stderr)
