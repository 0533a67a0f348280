#!/usr/bin/python3
"""Prints the tables of docs/verification.md: by kind of evidence, what was compared with what, and how many cases.

verification.py [--write | --check]. --write puts the tables into the page. --check compares the page: numbers of cases are said as
'at least', and the check fails where there are fewer, or a tenth more. Each test that a row names must exist.
"""
import csv
import glob
import json
import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PAGE = os.path.join(ROOT, "docs", "verification.md")
BEGIN, END = "<!-- tables by scripts/verification.py -->\n", "<!-- end of tables -->\n"
HEAD = "| compared | with | cases | largest difference allowed | what differed | command |\n|---|---|---|---|---|---|\n"


def text(path):
    with open(os.path.join(ROOT, path), encoding="utf-8") as file:
        return file.read()


def rows_of(name):
    """The rows of a file of tests/data."""
    return sum(bool(line) and not line.startswith("#") for line in text(f"tests/data/{name}").split("\n")) - 1


def golden():
    """The cases of the golden set."""
    return sum(bool(re.match(r"[^#~\s]\S*?(?: \w+=\d+)*:", line)) for path in glob.glob(os.path.join(ROOT, "tests/golden/cases/*.txt"))
               for line in text(path).split("\n"))


def refused():
    return sum(" status=2" in line.split(":")[0] for path in glob.glob(os.path.join(ROOT, "tests/golden/cases/*.txt"))
               for line in text(path).split("\n"))


def claims(kind):
    with open(os.path.join(ROOT, "tests/data/claims.csv"), encoding="utf-8", newline="") as file:
        return sum(row["kind"] in kind for row in csv.DictReader(file))


def cases():
    with open(os.path.join(ROOT, "tests/cases.csv"), encoding="utf-8", newline="") as file:
        return sum(row["name"][:1] not in ("#", "") and row["command"] is not None for row in csv.DictReader(file))


def linear_examples():
    return sum("\nkinematics: finite" not in "\n" + text(path) for path in glob.glob(os.path.join(ROOT, "examples/*/scene.yaml")))


def entries(path, opening):
    """The entries of a list in a script, one a line."""
    return len(re.findall(r"^    \(", text(path).split(opening)[1].split("\n]")[0], re.MULTILINE))


def codes():
    return len(json.loads(text("src/task/codes.json")))


ONE = r"range\((\d+)\)"
# heading, then rows: compared, with, number of cases, allowed, what differed, tests
KINDS = [
    ("Identities: three ways to one number", [
        ("march, matrix and waves of one scene", "one another", linear_examples, "a step: 1e-14; eigenvalues: 1e-6; growth of a run: 2 %",
         "nothing", "agreement"),
        ("results on 2 and 3 ranks", "those on one rank, by particle", linear_examples, "1e-12", "nothing", "ranks"),
        ("the plain march, an operation at a time", "the fast one, on every example", linear_examples, "rounding", "nothing", "plain"),
        ("the header mpmstab_dt.h", "the same bounds in numpy, on random layouts in one to three dimensions",
         lambda: int(re.findall(ONE, text("tests/python/check_dt.py"))[0]), "1e-12", "nothing", "dt"),
    ]),
    ("Closed forms and theorems", [
        ("limits of lattices by search, each formulation, transfer and basis", "closed forms, where there is one", None, "1e-5",
         "published forms of the slides: [slides](slides.md)", "critical_"),
        ("energy of random moving layouts, each step", "the theorem of steps that do not ring, with steps that do as a counter-check",
         None, "1e-13 a step; implicit 1e-11", "nothing", "quiet_energy"),
        ("certificates with a chance of 1e-2 to be wrong", "the exact eigenvalue of random layouts", lambda: int(re.search(
            r"step_bound_all 1 \S+ (\d+)", text("tests/CMakeLists.txt")).group(1)), "at most one in a hundred is wrong", "nothing", "step_bound"),
        ("liquids between sticky walls: Newton's and its start, Bingham's, Herschel's and Bulkley's", "exact velocities", lambda: 4, "order 2: "
         "errors on 16 cells of 0.5 to 1.7 %", "nothing", "viscous_runs"),
        ("shocks with the viscosity of von Neumann and Richtmyer", "Noh's problem: speed, density, velocity, jumps of mass and momentum",
         lambda: 2, "1 %", "nothing", "viscous_runs"),
    ]),
    ("Programs written apart from this one", [
        ("growth in one dimension", "a program of its own in numpy (growth.csv)", lambda: rows_of("growth.csv"), "2 % of the rate of a run", "nothing", "oracle"),
        ("growth in two and three dimensions", "the same (growth-nd.csv)", lambda: rows_of("growth-nd.csv"), "1e-8 in the symbol", "nothing", "symbol_nd"),
        ("growth about stretched states", "tangents of a nonlinear step by complex steps (growth-nonlinear.csv)",
         lambda: rows_of("growth-nonlinear.csv"), "1e-8; where it is 1, 1e-7", "nothing", "prestress"),
        ("growth of rk, verlet and implicit", "a program of its own (growth-quiet.csv)", lambda: rows_of("growth-quiet.csv"),
         "1e-9", "nothing", "quiet_steps"),
        ("limits", "bisection and dense eigenvalues (critical.csv, critical-nd.csv)", lambda: rows_of("critical.csv") + rows_of("critical-nd.csv"),
         "1e-8; in one dimension 1e-4, where it was bisected 4e-3", "nothing", "critical"),
        ("limits and bounds of layouts from files", "dense linear algebra in the test", lambda: 2 * 2 * int(re.search(
            r"for number in " + ONE, text("tests/python/check_step_bounds.py")).group(1)), "limit 1e-5, bounds 1e-8", "nothing", "step_bounds"),
        ("bounds and limits of layouts", "mpmstab-audit, by products without a matrix", None, "bounds 1e-10, limit 2e-6", "nothing", "audit"),
    ]),
    ("Codes that we did not write", [
        ("predicted limits and growth", "Taichi's mpm88, mpm99 and mpm3d, mpmat, and mls-mpm88-explained, as they are",
         lambda: 5, "digits on their [pages](../examples/their-code)", "verdicts where certificates fail are undecided", "their_code"),
        ("names and rules of public codes", "their sources, by file and line at a revision", codes, "read by people, not run",
         "names: a code's USL may be musl ([limits](limits.md#what-public-codes-call-these-schemes))", "list_codes"),
    ]),
    ("That nothing changes unseen", [
        ("answers of commands, all numbers", "the recorded ones (golden set)", golden, "1e-12, or a rule with its reason", "nothing", "golden"),
        ("bad input that is refused", "the recorded message and status 2 (golden set)", refused, "each word", "nothing", "golden"),
        ("numbers on pages", "what their command finds", lambda: claims(("quick", "nightly", "slow")), "digits of the page", "nothing", "claims"),
        ("tables on pages", "the script that prints them", lambda: claims(("table",)), "each character", "nothing", "claims"),
        ("commands and how they end", "tests/cases.csv", cases, "words or numbers of the row", "nothing", "cases"),
        ("damaged scenes and checkpoints", "no crash, one message", lambda: sum(len(names) for *_, names in os.walk(
            os.path.join(ROOT, "tests/fuzz/corpus"))), "none", "nothing", "fuzz"),
        ("the source, broken in one place after another", "some test of every day must fail", lambda: entries(
            "tests/mutations.py", "MUTATIONS = ["), "all must be noticed", "see tests/mutations.py", None),
    ]),
]
COMMANDS = {None: "`tests/mutations.py`"}


def table(rows, said):
    """A table; said has the number of cases of a row."""
    def line(row):
        compared, other, count, allowed, differed, test = row
        number = "see the test" if count is None else f"at least {said(count())}"
        return f"| {compared} | {other} | {number} | {allowed} | {differed} | {COMMANDS.get(test, f'`ctest --test-dir build -R {test}`')} |\n"
    return HEAD + "".join(line(row) for row in rows)


def tables():
    """Numbers are rounded down, so that a case more does not change the page."""
    def said(count):
        unit = 10 ** max(0, len(str(count)) - 2)
        return count // unit * unit if count >= 20 else count
    return "\n".join(f"## {heading}\n\n{table(rows, said)}" for heading, rows in KINDS)


def faults(page):
    """What is wrong with the page."""
    shown = page.split(BEGIN)[1].split(END)[0].split("\n")
    made = tables().split("\n")
    tests = "".join(text(os.path.relpath(path, ROOT)) for path in glob.glob(os.path.join(ROOT, "tests/**/CMakeLists.txt"), recursive=True))
    for _, rows in KINDS:
        for *_, test in rows:
            if test and not re.search(rf"\b{test}", tests):
                yield f"no test {test}"
    if len(shown) != len(made):
        yield f"{len(shown)} lines, not {len(made)}; --write makes them"
        return
    for old, new in zip(shown, made):
        numbers = [int(found.group(1)) if (found := re.search(r"at least (\d+)", line)) else 0 for line in (old, new)]
        same = re.sub(r"at least \d+", "", old) == re.sub(r"at least \d+", "", new)
        if not same or not numbers[0] <= numbers[1] <= 1.1 * numbers[0] + 2:
            yield f"the page has\n  {old}\nnot\n  {new}"


def main():
    if "--write" in sys.argv or "--check" in sys.argv:
        page = text(PAGE)
        if "--check" in sys.argv:
            sys.exit("\n".join(f"verification: {fault}" for fault in faults(page)) or 0)
        with open(PAGE, "w", encoding="utf-8") as file:
            file.write(page.split(BEGIN)[0] + BEGIN + tables() + END + page.split(END)[1])
    else:
        print(tables())


if __name__ == "__main__":
    main()
