#!/usr/bin/python3
"""Runs commands of tests/cases.csv and checks how they end.

cases.py MPMSTAB [--suite LABEL] [--part I/N] [--mpiexec MPIEXEC] [NAME...], or cases.py --check

A row of the table (lines that begin with # are comments):
  name     of the case, once in the table. A command has this name with _ and its number of ranks
  label    of the suite that runs the case: core, cli, parallel or docs
  ranks    numbers of ranks, with a space between them; 1 runs without mpirun
  nightly  more of them, or all, which only the suite 'nightly' runs
  status   the exit status that the command must have
  says     a regular expression that its output must match, once if the status is not 0; or nothing
  never    one that its output must not match, or nothing
  command  what follows 'mpmstab'; @ stands for the folder of the project

NAME... chooses commands by their names, in which * stands for anything. --part I/N takes part I of N parts, so that
several processes share the commands. Each command runs in an empty folder, which is removed. Prints only what failed.
--check looks at the table alone: each linear scene of the examples must be in it.
"""
import argparse
import csv
import fnmatch
import glob
import os
import re
import shlex
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.append(os.path.join(ROOT, "tests", "support"))
import forks  # short commands, without loading the libraries of mpmstab for each
COLUMNS = ["name", "label", "ranks", "nightly", "status", "says", "never", "command"]
LABELS = ("core", "cli", "parallel", "docs")
TIME_LIMIT = 300  # seconds for one command


def table():
    with open(os.path.join(ROOT, "tests", "cases.csv"), encoding="utf-8", newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def faults_of_table(rows):
    """What is wrong with the table, and which examples it lacks."""
    names = [row["name"] for row in rows]
    for row in rows:
        ranks = f"{row['ranks']} {row['nightly']}".split()
        if list(row) != COLUMNS or None in row.values():
            yield f"{row['name']}: not the {len(COLUMNS)} columns {' '.join(COLUMNS)}"
        elif row["label"] not in LABELS:
            yield f"{row['name']}: label {row['label']}; allowed: {', '.join(LABELS)}"
        elif not ranks or len(ranks) > len(set(ranks)) or not all(one.isdigit() and one != "0" for one in ranks):
            yield f"{row['name']}: ranks {row['ranks']}, nightly {row['nightly']}; allowed: each number of ranks once"
        elif names.count(row["name"]) > 1:
            yield f"{row['name']}: {names.count(row['name'])} times; allowed: once"
    commands = [row["command"] for row in rows]
    for scene in sorted(glob.glob(os.path.join(ROOT, "examples", "*", "scene.yaml"))):
        with open(scene, encoding="utf-8") as file:
            finite = re.search("^kinematics: finite", file.read(), re.MULTILINE)  # see check_large_strain.py
        for task in () if finite else ("run", "spectrum"):
            if f"{task} {scene.replace(ROOT, '@')}" not in commands:
                yield f"no case is: {task} {scene.replace(ROOT, '@')}"


def commands(rows):
    """Each command of the table: its name, its suite, its row and its number of ranks."""
    for row in rows:
        for suite, column in ((row["label"], "ranks"), ("nightly", "nightly")):
            for ranks in row[column].split():
                yield f"{row['name']}_{ranks}", suite, row, int(ranks)


def fault(launch, row):
    """Runs a command; returns what is wrong with how it ends, or None."""
    words = [*launch, *shlex.split(row["command"].replace("@", ROOT))]
    with tempfile.TemporaryDirectory() as folder:
        try:
            done = forks.run(words, cwd=folder, capture_output=True, text=True, timeout=TIME_LIMIT, errors="replace",
                             check=False)
        except subprocess.TimeoutExpired:
            return f"{shlex.join(words)}\nhas not ended within {TIME_LIMIT} s"
    said = done.stdout + done.stderr
    times = len(re.findall(row["says"], said, re.DOTALL))
    if done.returncode != int(row["status"]):
        wrong = f"status {done.returncode}, expected {row['status']}"
    elif row["says"] and (times == 0 or (times > 1 and done.returncode)):
        wrong = f"says {times} times: {row['says']}"
    elif row["never"] and re.search(row["never"], said, re.DOTALL):
        wrong = f"says: {row['never']}"
    else:
        return None
    return f"{shlex.join(words)}\n{said}{wrong}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mpmstab", nargs="?", type=os.path.abspath)
    parser.add_argument("names", nargs="*", metavar="NAME", default=[])
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--suite", choices=[*LABELS, "nightly"])
    parser.add_argument("--part", default="1/1")
    parser.add_argument("--mpiexec", default="mpirun")
    given = parser.parse_args()
    rows = table()
    if given.check or not given.mpmstab:
        sys.exit("\n".join(faults_of_table(rows)) or 0)
    number, parts = (int(text) for text in given.part.split("/"))
    wanted = [one for one in commands(rows) if given.suite in (None, one[1])
              and (not given.names or any(fnmatch.fnmatch(one[0], name) for name in given.names))]
    if not wanted:
        sys.exit("no command is chosen; allowed: names and suites of tests/cases.csv")
    faults = 0
    for name, _, row, ranks in wanted[number - 1::parts]:
        wrong = fault([given.mpiexec, "-n", str(ranks), given.mpmstab] if ranks > 1 else [given.mpmstab], row)
        if wrong:
            faults += 1
            print(f"---- {name}\n{wrong}\n", flush=True)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
