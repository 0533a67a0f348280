#!/usr/bin/python3
"""Checks that layers.py reports includes that run up, circles and unknown folders, in small trees made here.

check_layers.py. Silent when all is well.
"""
import os
import pathlib
import subprocess
import sys
import tempfile

from checks import check

SCRIPT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "layers.py")
GOOD = {"src/base/errors.h": "", "src/base/errors.c": '#include "base/errors.h"\n#include <stdio.h>\n',
        "src/march/grid.h": '#include "base/errors.h"\n', "src/march/grid.c": '#include <mpmstab/grid.h>\n',
        "src/scheme/basis/hdf5_2.h": "#include <mpmstab/basis.h>\n", "include/mpmstab/basis.h": "",
        "include/mpmstab/grid.h": '#include "base/errors.h"\n'}
FAULTS = {  # what is added to the good tree, and what layers.py must say
    "an upward include": ({"src/base/memory.c": '#include "march/grid.h"\n'},
                          ["base/memory.c (base) includes march/grid.h (march), which is of a later layer"]),
    "an upward include with a digit in its name": (
        {"src/base/memory.c": '  #  include "scheme/basis/hdf5_2.h"\n'},
        ["base/memory.c (base) includes scheme/basis/hdf5_2.h (scheme), which is of a later layer"]),
    "an upward include of a public header": (
        {"src/scene/scene.c": "#include <mpmstab/grid.h>\n"},
        ["scene/scene.c (scene) includes mpmstab/grid.h (march), which is of a later layer"]),
    "a circle": ({"src/io/one.h": '#include "io/two.h"\n', "src/io/two.h": '#include "io/one.h"\n'},
                 ["circle: io/one -> io/two -> io/one"]),
    "a circle of a source and two headers": (
        {"src/io/one.h": "", "src/io/one.c": '#include "io/two.h"\n', "src/io/two.h": '#include "io/one.h"\n'},
        ["circle: io/one -> io/two -> io/one"]),
    "a file that includes itself": ({"src/io/one.h": '#include "io/one.h"\n'}, ["circle: io/one -> io/one"]),
    "an unknown folder": ({"src/misc/odd.c": ""}, ["misc/odd.c: belongs to no layer"]),
    "a public header of no layer": ({"include/mpmstab/odd.h": ""}, ["mpmstab/odd.h: belongs to no layer"]),
    "a header that is not there": ({"src/io/one.c": '#include "io/lost.h"\n'},
                                   ["io/one.c includes io/lost.h, which does not exist"]),
    "two at once": ({"src/misc/odd.c": "", "src/base/memory.c": '#include "march/grid.h"\n'},
                    ["base/memory.c (base) includes", "misc/odd.c: belongs to no layer"])}


def said_of(tree):
    """Runs layers.py on a tree of files, which are texts by path. Returns its status and its lines."""
    with tempfile.TemporaryDirectory() as folder:
        for path, text in tree.items():
            file = pathlib.Path(folder, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="ascii")
        done = subprocess.run([sys.executable, SCRIPT, "--root", folder], capture_output=True, text=True, check=False)
    return done.returncode, done.stderr.splitlines()


def main():
    check(said_of(GOOD) == (0, []), f"the good tree: {said_of(GOOD)}")
    for name, (added, expected) in FAULTS.items():
        status, lines = said_of({**GOOD, **added})
        check(status == 1 and len(lines) == len(expected), f"{name}: status {status}, {lines}")
        for words in expected:
            check(any(words in line for line in lines), f"{name}: no '{words}' in {lines}")
    status, lines = said_of({})
    check(status == 1 and len(lines) == 1 and "no C files" in lines[0], f"an empty tree: status {status}, {lines}")


if __name__ == "__main__":
    main()
