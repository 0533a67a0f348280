#!/usr/bin/python3
"""Runs the scenes of examples/extreme and prints a table: case, predicted, measured, verdict, time.

extremes.py [--large] [--ranks N] [--check FILE] [PATTERN...]

PATTERN chooses scenes by name, such as 'drift-*'. The environment variable MPMSTAB names the program (by default
build/mpmstab).

A scene begins with comments that say what is expected and why. '# task: ' names the task. Where the program does not
predict the scene itself, '# predicted: ' gives a number and its formula, or a task and options that turn the scene into
one that the program predicts. The measured column has the growth of a march from random data (tasks run and spectrum),
the Courant number at which growth leaves the tolerance (critical), or the share of unstable layouts (ensemble).
"""
import fnmatch
import os
import re
import sys
import time

from program import ROOT, Parser, end_in_one_line, launch, refuse, require_input, require_program, say

FOLDER = os.path.join(ROOT, "examples", "extreme")


def header(path):
    """Returns the task and the prediction that the comments of a scene state."""
    with open(path, encoding="ascii") as file:
        lines = [line[2:].rstrip() for line in file if line.startswith("# ")]
    return dict(line.split(": ", 1) for line in lines if re.match("(task|predicted): ", line))


def number(value):
    if value is None:
        return "-"
    return f"{value:.7g}" if 1e-4 <= abs(value) < 1e5 else f"{value:.4e}"


def growth_predicted(found):
    predicted = found.get("predicted", {})
    for name in ("corrected", "symbol"):
        if predicted.get(name) is not None:
            return number(predicted[name])
    if "spectrum" in found:
        return number(found["spectrum"]["growth"])
    return number(None if "run" in found else found.get("growth"))


def columns(task, found, predicted, told):
    """Returns the columns predicted and measured; told is the number that the scene predicts, or None."""
    if task == "critical":
        critical = found["critical"]
        limit = critical.get("critical_courant")
        return ("k " + number(critical.get("closed_form") or told),
                "no limit up to k = 64" if limit is None else "k " + number(limit))
    if task == "ensemble":
        ensemble = found["ensemble"]
        low, high = ensemble["interval"]
        return "-", f"{ensemble['unstable']} of {ensemble['layouts']} [{low:.3f}, {high:.3f}]"
    run = found.get("run", {})
    measured = number(run.get("growth_measured"))
    if run.get("growth_kind") == "exponential" and task == "run":
        measured += f" +- {run['growth_error']:.0e}"
    elif "growth_above" in run:
        measured = f"> {run['growth_above']:.0e}"
    elif run.get("growth_kind") == "linear":
        measured += ", grows like t"
    return growth_predicted(predicted or found), measured


NUMBER = re.compile(r"\d+\.?\d*(?:e[+-]?\d+)?")


def same(cells, known):
    """Says whether a text has this row: the same words, numbers to 1e-4, any time."""
    for line in known.splitlines():
        others = [cell.strip() for cell in line.split("  ") if cell.strip()]
        if not others or others[0] != cells[0]:
            continue
        mine, theirs = (" ".join(c[1:5]) for c in (cells, others))
        near = all(abs(float(a) - float(b)) <= 1e-4 * abs(float(b)) for a, b in
                   zip(NUMBER.findall(mine.split(" +- ")[0]), NUMBER.findall(theirs.split(" +- ")[0])))
        return near and NUMBER.sub("", mine) == NUMBER.sub("", theirs)
    return False


def row(arguments, path):
    name = os.path.basename(path)[:-len(".yaml")]
    keys = header(path)
    begin = time.monotonic()
    status, found, said = launch(keys["task"], path, ranks=arguments.ranks)
    predicted, told = None, None
    if re.match("[0-9.]", keys.get("predicted", "")):
        told = float(keys["predicted"].split()[0])
    elif "predicted" in keys:
        task, *options = keys["predicted"].split()
        _, predicted, more = launch(task, path, options, arguments.ranks)
        said += more
    seconds = time.monotonic() - begin
    if status or not found:
        return [name, keys["task"], "-", "-", f"FAILED, status {status}: {said}", f"{seconds:.1f} s"], False
    predicted_and_measured = columns(keys["task"], found, predicted, told)
    return [name, keys["task"], *predicted_and_measured, found["verdict"], f"{seconds:.1f} s"], True


def main():
    parser = Parser(__doc__)
    parser.add_argument("--large", action="store_true", help="also run the scenes that need gigabytes")
    parser.add_argument("--ranks", type=int, default=1, help="ranks of each run (1)")
    parser.add_argument("--check", metavar="FILE", help="fail unless FILE has the same rows, but for times")
    parser.add_argument("pattern", nargs="*", default=["*"])
    arguments = parser.parse_args()
    if arguments.ranks < 1:
        refuse(f"--ranks {arguments.ranks}: allowed: 1 or more")
    require_program()
    known = ""
    if arguments.check:
        require_input(arguments.check, "a file with the table that this script prints")
        with open(arguments.check, encoding="utf-8", errors="replace") as file:
            known = file.read()
    good = True
    line = "{:<24} {:<9} {:<16} {:<26} {:<10} {:>7}"
    print(line.format("case", "task", "predicted", "measured", "verdict", "time"))
    count = 0
    for name in sorted(os.listdir(FOLDER)):
        wanted = any(fnmatch.fnmatch(name, p + ("" if p.endswith(".yaml") else ".yaml")) for p in arguments.pattern)
        if not name.endswith(".yaml") or not wanted or (name.startswith("large") and not arguments.large):
            continue
        count += 1
        cells, done = row(arguments, os.path.join(FOLDER, name))
        good = good and done
        print(line.format(*cells), flush=True)
        if arguments.check and not same(cells, known):
            say(f"{arguments.check} has another row for {cells[0]}")
            good = False
    if not count:
        refuse(f"no scene of {FOLDER} has the name {' or '.join(arguments.pattern)}; allowed: names in that folder, "
               "with * for any letters")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    end_in_one_line(main)
