#!/usr/bin/python3
"""Compiles each public header alone, against an installed tree: none may need another one before it, or one of src/.

headers.py PREFIX COMPILER INCLUDE: INCLUDE is the source tree's folder of public headers. The installed headers must be
these, and mpmstab.h must include every other one.
"""
import os
import pathlib
import re
import subprocess
import sys

ALONE = {"mpmstab.h", "plugin.h"}  # plugin.h is for libraries that mpmstab loads


def main():
    prefix, compiler, include = pathlib.Path(sys.argv[1]), sys.argv[2], pathlib.Path(sys.argv[3])
    installed = sorted(path.name for path in (prefix / "include" / "mpmstab").iterdir())
    source = sorted(path.name for path in include.iterdir())
    faults = [] if installed == source else [f"installed are {installed}, the source tree has {source}"]
    included = set(re.findall(r"#include <mpmstab/(\S+)>", (include / "mpmstab.h").read_text(encoding="utf-8")))
    if included != set(source) - ALONE:
        faults.append(f"mpmstab.h and the folder of headers differ in {included ^ (set(source) - ALONE)}")
    environment = os.environ | {"PKG_CONFIG_PATH": f"{prefix}/lib/pkgconfig:{os.environ.get('PKG_CONFIG_PATH', '')}"}
    flags = subprocess.run(["pkg-config", "--cflags", "mpmstab"], env=environment, check=True, capture_output=True,
                           text=True).stdout.split()
    for name in installed:
        command = [compiler, "-std=c11", "-O1", "-Wall", "-Wextra", "-Werror", *flags, "-fsyntax-only", "-xc", "-"]
        done = subprocess.run(command, input=f"#include <mpmstab/{name}>\n", capture_output=True, text=True)
        if done.returncode:
            faults.append(f"{name} does not compile alone:\n{done.stderr}")
    for fault in faults:
        print(f"headers.py: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
