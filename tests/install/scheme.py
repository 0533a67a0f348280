#!/usr/bin/python3
"""Follows CONTRIBUTING.md and docs/dev/formulation.md to the letter.

scheme.py ROOT PREFIX COMPILER: copies the sources of ROOT to a temporary folder, adds the files that the pages show,
changes the lists as they show, builds a program of these and of the library that is installed in PREFIX, and runs the
commands of the pages. Growth must be the closed forms; unit_laws must hold for the new material.
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


def squeezed(text):
    return re.sub(r"\s+", "", text)


def apply_change(path, change):
    """Puts each run of '+' lines of a change in the place of the '-' lines before it, which must be there once."""
    text = path.read_text(encoding="utf-8")
    for old, new in re.findall(r"((?:^-.*\n)+)((?:^\+.*\n)+)", change, re.M):
        old, new = (re.sub(r"^.", "", lines, flags=re.M) for lines in (old, new))
        if squeezed(new) in squeezed(text):
            continue
        if text.count(old) != 1:
            fail(f"{path.name} has {text.count(old)} times, not once, what a page changes there:\n{old}")
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
        fail(f"the code of a page does not build:\n{done.stderr}")


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


def add(root, folder, text):
    """Adds the files of a page to a copy of the sources, and changes the lists. Returns the files that are new or changed.

    Where somebody has followed the page, the files and the lines are there already.
    """
    blocks = blocks_of(text)
    for file, code in blocks["c"]:
        (folder / file).write_text(code, encoding="utf-8")
    for changed, change in blocks["diff"]:
        apply_change(folder / changed, change)
    return [path for path, _ in blocks["c"] + blocks["diff"]]


def copy_of(root, temporary, name):
    folder = pathlib.Path(temporary) / name
    for part in ("src", "include", "tests/unit", "tests/support"):
        shutil.copytree(root / part, folder / part)
    return folder


def follow_formulation(root, folder, prefix, compiler):
    text = (root / "docs/dev/formulation.md").read_text(encoding="utf-8")
    k = 0.5
    expected = math.sqrt(1 + k**2 / 3)
    if f"sqrt(1 + k^2 / 3): {expected:.6f} for k = {k}" not in text.replace("\n", " "):
        fail("formulation.md no longer states the closed form sqrt(1 + k^2 / 3) that this test compares with")
    build(folder, [*add(root, folder, text), "src/main.c"], prefix, compiler)
    tasks = [check_growth(folder, command, expected) for command in blocks_of(text)["sh"][0][1].splitlines()]
    if tasks != ["symbol", "run"]:
        fail(f"formulation.md runs {tasks}; expected symbol and run")


def follow_contributing(root, folder, prefix, compiler):
    """The quartic spline and the solid that hardens."""
    text = (root / "CONTRIBUTING.md").read_text(encoding="utf-8")
    files = add(root, folder, text)
    build(folder, [*files, "src/main.c"], prefix, compiler)
    found = {}
    for words in re.findall(r"^    build/mpmstab (.*)$", text, re.M):
        done = subprocess.run([folder / "mpmstab", *words.split(), "-json", "found.json"], cwd=folder,
                              capture_output=True, text=True)
        if done.returncode:
            fail(f"{words}: exit status {done.returncode}\n{done.stdout}{done.stderr}")
        found[words.split()[0]] = json.loads((folder / "found.json").read_text(encoding="utf-8"))
    s = found["spectrum"]
    growths = [s["growth"], s["predicted"]["symbol"], s["predicted"]["corrected"]]
    if max(growths) - min(growths) > 1e-8 or growths[0] < 1.01 or s["spectrum"]["step_mismatch"] > 1e-13:
        fail(f"the quartic spline grows by {growths}, and A q differs from a step by {s['spectrum']['step_mismatch']}")
    build(folder, [*files, "tests/unit/test_laws.c", "-Itests/support"], prefix, compiler)
    done = subprocess.run([folder / "mpmstab"], cwd=folder, capture_output=True, text=True)
    if done.returncode:
        fail(f"unit_laws with the new material: {done.stderr}")


def main():
    root, prefix, compiler = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3]
    with tempfile.TemporaryDirectory() as temporary:
        follow_formulation(root, copy_of(root, temporary, "formulation"), prefix, compiler)
        follow_contributing(root, copy_of(root, temporary, "contributing"), prefix, compiler)


if __name__ == "__main__":
    main()
