#!/usr/bin/python3
"""Follows the section 'A scheme of your own' of CONTRIBUTING.md to the letter.

scheme.py ROOT PREFIX COMPILER: copies the sources of ROOT to a temporary folder, adds the file that the page shows,
changes the list as it shows, builds a program of these and of the library that is installed in PREFIX, and runs the
commands of the page. Growth must be the closed form that the page states.
"""
import json
import math
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile


def fail(message):
    sys.exit(f"scheme.py: {message}")


def blocks_of(section):
    """The code blocks of a section, by language: the last path named before each, and the text."""
    blocks = {}
    for found in re.finditer(r"^```(\w+)\n(.*?)^```$", section, re.M | re.S):
        paths = re.findall(r"`(src/[\w/]+\.\w+)`", section[:found.start()])
        blocks.setdefault(found[1], []).append((paths[-1] if paths else None, found[2]))
    return blocks


def apply_change(path, change):
    """Puts each run of '+' lines of a change in the place of the '-' lines before it, which must be there once."""
    text = path.read_text(encoding="utf-8")
    for old, new in re.findall(r"((?:^-.*\n)+)((?:^\+.*\n)+)", change, re.M):
        old, new = (re.sub(r"^.", "", lines, flags=re.M) for lines in (old, new))
        if text.count(old) != 1:
            fail(f"{path.name} has {text.count(old)} times, not once, what CONTRIBUTING.md changes there:\n{old}")
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")


def build(folder, sources, prefix, compiler):
    environment = os.environ | {"PKG_CONFIG_PATH": f"{prefix}/lib/pkgconfig:{os.environ.get('PKG_CONFIG_PATH', '')}"}
    flags = subprocess.run(["pkg-config", "--cflags", "--libs", "mpmstab"], env=environment, check=True,
                           capture_output=True, text=True).stdout.split()
    command = [compiler, "-std=c11", "-D_XOPEN_SOURCE=700", "-O2", "-Wall", "-Wextra", "-Werror", "-Isrc", "-Iinclude",
               *sources, "-o", "mpmstab", *flags]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode:
        fail(f"the code of CONTRIBUTING.md does not build:\n{done.stderr}")


def check_growth(folder, command, expected):
    """Runs a command of the page with the new program; what it finds must agree with the closed form."""
    words = [str(folder / "mpmstab"), *shlex.split(command)[1:], "-json", "found.json"]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
    if done.returncode:
        fail(f"{command}: exit status {done.returncode}\n{done.stdout}{done.stderr}")
    found = json.loads((folder / "found.json").read_text(encoding="utf-8"))
    for name, growth, tolerance in (("growth", found["growth"], 1e-6 if found["task"] == "symbol" else 2e-5),
                                    ("predicted.corrected", found["predicted"]["corrected"], 1e-6)):
        if abs(growth - expected) > tolerance:
            fail(f"{command}: {name} is {growth}, the closed form {expected}")
    return found["task"]


def main():
    root, prefix, compiler = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
    page = (root / "CONTRIBUTING.md").read_text(encoding="utf-8")
    section = re.search(r"^## A scheme of your own\n(.*?)^## ", page, re.M | re.S)[1]
    blocks = blocks_of(section)
    (file, code), (changed, change), (_, commands) = blocks["c"][0], blocks["diff"][0], blocks["sh"][0]
    k = 0.5
    expected = math.sqrt(1 + k**2 / 3)
    if f"sqrt(1 + k^2 / 3): {expected:.6f} for k = {k}" not in section.replace("\n", " "):
        fail("CONTRIBUTING.md no longer states the closed form sqrt(1 + k^2 / 3) that this test compares with")
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        for name in ("src", "include"):
            shutil.copytree(root / name, folder / name)
        if (folder / file).exists():
            fail(f"{file} exists already")
        (folder / file).write_text(code, encoding="utf-8")
        apply_change(folder / changed, change)
        build(folder, [file, changed, "src/main.c"], prefix, compiler)
        tasks = [check_growth(folder, command, expected) for command in commands.splitlines()]
        if tasks != ["symbol", "run"]:
            fail(f"CONTRIBUTING.md runs {tasks}; expected symbol and run")


if __name__ == "__main__":
    main()
