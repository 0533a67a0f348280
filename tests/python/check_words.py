#!/usr/bin/python3
"""The command line as people type it: other ways to write options and names, help, and what is installed beside the
program: the schema of scenes, completions for bash, the man page.

MPMSTAB names the program. Silent when all is well.
"""
import glob
import json
import os
import re
import subprocess

import jsonschema
import yaml

from checks import ROOT, check, forks, text_of

MPMSTAB = os.environ["MPMSTAB"]


def told(words, status=0):
    done = forks.run([MPMSTAB, *words.split()], capture_output=True, text=True, check=False, timeout=60)
    check(done.returncode == status, f"{words}: status {done.returncode}: {done.stderr}")
    return done.stderr if status else done.stdout


def without_times(text):
    return re.sub(r"(?m)^time: .*$", "", text)


def check_filled():
    """The heading of a scene whose particles do not fill the grid."""
    for words, filled in (("-cells 8 -fill 2,3.5", "from cell 2 to 3.5: 3 particles"),
                          ("usl -dim 3 -cells 6 -fill 3,5,2,4,0,6",
                           "from cell 3 to 5 along x, from cell 2 to 4 along y, from cell 0 to 6 along z: 192 particles"),
                          ("usl -dim 2 -cells 6 -ppc 1 -fill 3,4,3,4",
                           "from cell 3 to 4 along x, from cell 3 to 4 along y: 1 particle"),
                          ("usl -dim 2 -cells 20 -kinematics finite -shape discs", "in the shape discs: 416 particles")):
        check(f"\nfilled {filled}\n" in told(f"run {words} -steps 1"), words)


def check_scripts():
    """A script that a page calls by its name must be executable. install.sh is sourced."""
    pages = [page for where in ("*", "docs/*", "docs/dev/*", "examples/*/*") for page in glob.glob(f"{ROOT}/{where}.md")]
    called = {name for page in pages for name in re.findall(r"(?m)(?:^ *|`)(?:\./)?scripts/([\w-]+\.(?:py|sh))\b", text_of(page))}
    check({"report.py", "their_code.py", "setup.sh"} <= called, f"{called}")
    for name in called - {"install.sh"}:
        check(os.access(os.path.join(ROOT, "scripts", name), os.X_OK), f"scripts/{name} cannot be run by its name")


def check_ways_to_write():
    wanted = without_times(told("critical -formulation musl -basis quadratic -ppc 3"))
    for words in ("critical musl -basis quadratic -ppc 3", "critical MUSL --basis Quadratic --ppc=3",
                  "Critical -FORMULATION Musl -Basis QUADRATIC --ppc 3"):
        check(without_times(told(words)) == wanted, f"{words}: another answer")
    check(told("--version") == told("version") == told("-version"), "versions differ")
    check(re.fullmatch(r"mpmstab \d+\.\d+\.\d+\n", told("version")), "version prints more than that")
    check(told("list formulations") == told("list formulation"), "list formulations")
    check(told("list bases") == told("list basis"), "list bases")


def check_help():
    text = told("help critical")
    for words in ("critical --help", "critical -formulation usl -h", "help CRITICAL"):
        check(told(words) == text, f"{words}: another text")
    check("-neighbourhood" in text and "-map_axes" not in text, "help critical has not its own options")
    for task in ("run", "spectrum", "symbol", "critical", "map", "ensemble", "list"):
        example = re.search(r"for example: mpmstab (.*)", told(f"help {task}")).group(1)
        told(example)
    check("did you mean critical?" in told("help critcal", 2), "no suggestion")


def check_refusals():
    for words, answer in {
            "run -cfl 0.3": "unknown option -cfl; it is called -courant here",
            "run -E 3": "it is called -young here",
            "run -nu 0.3": "it is called -poisson here",
            "run -o x.h5": "it is called -output here",
            "run -basis bspline": "here it is quadratic or cubic",
            "run -formulation mls-mpm": "here it is -formulation usl -transfer apic -gradient mls -basis quadratic",
            "run -dim 4": "allowed: a whole number from 1 to 3",
            "critical": "critical: of which scheme? allowed: with a formulation"}.items():
        check(answer in told(words, 2), f"{words}: {told(words, 2)}")


def check_schema():
    with open(f"{ROOT}/examples/scene.schema.json", encoding="utf-8") as file:
        text = file.read()
    check(text == told("list schema"), "examples/scene.schema.json is not what 'mpmstab list schema' prints")
    schema = jsonschema.Draft7Validator(json.loads(text))
    schema.check_schema(schema.schema)
    for path in glob.glob(f"{ROOT}/examples/*/*.yaml"):
        with open(path, encoding="utf-8") as file:
            errors = [error.message for error in schema.iter_errors(yaml.safe_load(file))]
        check(not errors, f"{path}: {errors[:1]}")
    for bad in ({"coruant": 1}, {"courant": "fast"}, {"cells": 0}, {"basis": "bspline"}, {"expect": {"verdikt": "stable"}}):
        check(not schema.is_valid(bad), f"the schema takes {bad}")


def completed(*words):
    """The words that bash offers for the last of these."""
    script = (f"source /dev/stdin; COMP_WORDS=(mpmstab {' '.join(words)}); COMP_CWORD={len(words)}; _mpmstab; "
              'echo "${COMPREPLY[@]}"')
    done = subprocess.run(["bash", "-c", script], input=told("list completion-bash"), capture_output=True, text=True,
                          check=True, timeout=60)
    return done.stdout.split()


def check_completion():
    check(completed("cr") == ["critical"], f"cr: {completed('cr')}")
    check(completed("critical", "-formulation", "mu") == ["musl"], "the words of an option")
    check(completed("critical", "-neigh") == ["-neighbourhood"], "the options of a task")
    check(completed("run", "-neigh") == [], "an option of another task")
    check("'-courant[" in told("list completion-zsh"), "zsh has no options")


def check_manual():
    text = told("list man")
    options = re.findall(r"(?m)^\.TP\n\\fB\\-([a-z_]+)\\fR", text)
    listed = [line.split()[0] for line in told("list options").splitlines()[1:]]
    check(options == listed, "the man page has other options than the list")
    known = {"TH", "SH", "TP"}
    check(set(re.findall(r"(?m)^\.([A-Za-z]+)", text)) == known, "requests that are not meant")


check_filled()
check_scripts()
check_ways_to_write()
check_help()
check_refusals()
check_schema()
check_completion()
check_manual()
