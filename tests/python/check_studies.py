#!/usr/bin/python3
"""Runs a study of examples/ with --quick, checks what it finds, and that its page quotes what it prints.

check_studies.py formulation-matters|source-term|ringing. MPMSTAB names the program. Silent when all is well.
"""
import csv
import math
import os
import re
import subprocess
import sys
import tempfile

from checks import ROOT, check

EXAMPLES = os.path.join(ROOT, "examples")


def rows(text, *begin):
    """Returns the numbers of the lines that begin with these words."""
    found = []
    for line in text.splitlines():
        words = line.split()
        if words[:len(begin)] == list(begin):
            found.append([float(word) for word in words[len(begin):] if re.fullmatch(r"-?[0-9.]+(e[-+][0-9]+)?", word)])
    check(found, f"no line begins with {begin}")
    return found


def quoted(text, page):
    """Every line of a table must stand in the page, except run times and growth out of rounding errors."""
    text = re.split("^-{30}|^a smooth wave", text, maxsplit=1, flags=re.MULTILINE)[0]
    with open(page, encoding="utf-8") as file:
        lines = set(file.read().splitlines())
    table = [line for line in text.splitlines() if len(re.findall(r"(?<![\w.])\d+\.\d+(?![\w.])", line)) >= 2]
    check(len(table) > 5, f"{len(table)} lines of tables")
    for line in table:
        check(line in lines, f"{page} does not have the line\n{line}")


def check_formulations(text, folder):
    """gas1 grows at rest, gas2 and musl at drift 1/8, usl in slower flow, pic never. What grows is not the cheapest."""
    for begin, at_rest, drifting, at_any in ((("gas1", "flip"), math.sqrt(1.25), 1.186564, 1.279477),
                                             (("gas2", "flip"), 1, 1.155498, 1.291231),
                                             (("usl", "flip"), 1, 1, 1.001524), (("usl", "pic"), 1, 1, 1),
                                             (("musl", "flip"), 1, 1.026847, 1.036211), (("gas2", "pic"), 1, 1, 1)):
        _, rest, rest_measured, moves, moves_measured, _, largest, _ = rows(text, *begin)[0]
        check(abs(rest - at_rest) < 2e-6 and abs(moves - drifting) < 2e-6, f"{begin}: {rest}, {moves}")
        check(abs(largest - at_any) < 2e-6, f"{begin}: over drifts {largest}")
        check(abs(rest_measured - rest) < 1e-3 and abs(moves_measured - moves) < 1e-3, f"{begin}: measured differs")
    for name, grows in (("gas", {"gas1"}), ("gas-drifts", {"gas1", "gas2"}), ("bar", set()), ("bar-drifts", {"musl"})):
        with open(os.path.join(folder, name + ".csv"), encoding="utf-8") as file:
            table = list(csv.DictReader(file))
        found = {row["formulation"] for row in table if row["status"] == "unstable" and row["transfer"] == "flip"}
        check(found == grows, f"{name}: {found} grow, not {grows}")
        part = text[text.index(f"{'-' * 30} {name}\n"):]
        answer = re.search("^(?:for )?error 0.1.*$", part, re.MULTILINE).group()
        check(not any(f"{scheme} flip" in answer for scheme in grows), f"{name}: {answer}")


def check_source_term(text, _):
    """With the source term, numpy must give the growth of mpmstab.

    Without it hardly anything grows in slow flow at k = 0.1. At drift 1/3 gas2 grows in the slides' split, and hardly
    with weights and gradients at the same place.
    """
    check("differ by less than 1e-9" in text, "numpy and mpmstab differ")
    for begin in (("gas1", "0.1", "1/100", "2"), ("gas2", "0.1", "1/100", "2"), ("gas2", "0.1", "1/3", "2")):
        program, with_it, without, same_place, _ = rows(text, *begin)[0]
        check(program == with_it, f"{begin}: {program} and {with_it}")
        less = (without - 1) < 0.2 * (with_it - 1)
        check(less if begin[2] == "1/100" else without > 1.03 and 1.001 < same_place < 1.002, f"{begin}: {without}")
    _, with_it, without, same_place, _ = rows(text, "gas2", "0.5", "1/100", "2")[0]
    check(min(without, same_place) - 1 > 0.95 * (with_it - 1), f"slower still: {with_it}, {without}, {same_place}")
    for smooth, advection in (row[:2] for row in rows(text, "2", "1/8") + rows(text, "8", "1/3")):
        check(abs(smooth / advection - 1) < 1e-3, f"term {smooth}, advection {advection}")


def check_ringing(text, _):
    """The closed form must hold with e = C1 - C2, and the rate of gas1 at rest must be proportional to k.

    In slow flow both rates are 1/2 with two particles a cell. With one particle they are proportional to k and equal to
    those of the particle places alone.
    """
    check("closed form differ by less than 1e-7" in text, "the closed form does not hold")
    for formulation in ("gas1", "gas2"):
        scheme = rows(text, formulation, "2", "1/10")[0]
        check(all(abs(rate - 0.5) < 0.01 for rate in scheme[1:]), f"{formulation}: {scheme}")
        scheme, alone = rows(text, formulation, "1", "1/10")
        check(scheme == alone and scheme[3] < 0.55 * scheme[2], f"{formulation}, ppc 1: {scheme}, {alone}")
    check(rows(text, "gas1", "2", "0")[0] == [0.2361, 0.0499, 0.01, 0.005] and
          rows(text, "gas2", "2", "0")[0] == [0, 0, 0, 0], "growth at rest")
    for closed, *found, finest in rows(text, "1/20") + rows(text, "1/5") + rows(text, "33/100"):
        check(abs(finest - closed) < 2e-3 and abs(found[2] - found[3]) < 5e-4, f"closed {closed}, {found}, {finest}")
    check("gas2  linear     pic            792         0" in text, "pic grows somewhere")


STUDIES = {"formulation-matters": check_formulations, "source-term": check_source_term, "ringing": check_ringing}


def check_ends(command):
    """A full standard output and a bad option must each be one line; a closed pipe must end silently."""
    reading, closed = os.pipe()
    os.close(reading)
    with open("/dev/full", "w", encoding="utf-8") as full, os.fdopen(closed, "w") as pipe:
        for more, output, status, said in (([], full, 1, "study.py: standard output cannot be written: No space left"),
                                           ([], pipe, 1, ""), (["--no"], None, 2, "unrecognized arguments: --no")):
            done = subprocess.run([*command, *more], stdout=output, stderr=subprocess.PIPE, text=True, check=False)
            check(done.returncode == status and said in done.stderr and len(done.stderr.splitlines()) == bool(said),
                  f"{more}: {done.returncode} {done.stderr}")


def main(name):
    with tempfile.TemporaryDirectory() as folder:
        more = ["-o", folder] if name == "formulation-matters" else []
        command = [sys.executable, os.path.join(EXAMPLES, name, "study.py"), "--quick", *more]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        check(done.returncode == 0 and done.stderr == "", f"{name}: status {done.returncode}: {done.stderr}")
        STUDIES[name](done.stdout, folder)
        check_ends(command)
    quoted(done.stdout, os.path.join(EXAMPLES, name, "README.md"))


if __name__ == "__main__":
    main(sys.argv[1])
