#!/usr/bin/python3
"""Compares the numbers that pages claim with what the program finds.

check_claims.py CLAIMS.csv [--nightly | --all | --pages]. MPMSTAB names the program. Silent when all is well.

A row of the file is a claim: its name, the page, the number as the page prints it, the command, where the result has the
number, the tolerance, and when it is checked. On the page the number is followed by the comment <!-- claim NAME -->.

  kind    command is                       found is
  quick   a task of mpmstab with options   keys of its JSON such as critical.critical_courant, also less 1 or as a part:
                                           'growth - 1', 'map.unstable / 792'
  nightly the same, only with --nightly    the same
  slow    the same, only with --all        the same
  table   the script that prints a table   the test in tests/CMakeLists.txt that compares it with the page

The tolerance is a part of the number. --pages looks at the pages alone: each comment has its row, and each row its
comment.
"""
import concurrent.futures
import csv
import glob
import json
import os
import re
import shlex
import subprocess
import sys
import tempfile

import numpy

from checks import ROOT, check, forks, text_of

MPMSTAB = os.environ.get("MPMSTAB", os.path.join(ROOT, "build", "mpmstab"))
MARK = re.compile(r"([^\s|(]+)<!-- claim ([\w-]+) -->")
COLUMNS = ["claim", "page", "printed", "kind", "command", "found", "tolerance"]


def claims_of(path):
    with open(path, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    check(rows and list(rows[0]) == COLUMNS, f"{path}: columns {list(rows[0])}, not {COLUMNS}")
    names = [row["claim"] for row in rows]
    check(len(names) == len(set(names)), f"{path}: {[name for name in names if names.count(name) > 1]} twice")
    for row in rows:
        check(None not in row.values() and None not in row, f"{path}: {row['claim']}: not {len(COLUMNS)} columns")
        check(row["kind"] in ("quick", "nightly", "slow", "table"), f"{path}: {row['claim']}: kind {row['kind']}")
    return rows


def pages():
    listed = subprocess.run(["find", ".", "-name", "*.md", "-not", "-path", "./build*"], cwd=ROOT, capture_output=True,
                            text=True, check=True)
    return sorted(os.path.relpath(name, ".") for name in listed.stdout.splitlines())


def check_words():
    """A page that uses a word of ours says where it is explained."""
    for page in pages():
        text = re.sub(r"```.*?```", "", text_of(os.path.join(ROOT, page)), flags=re.DOTALL)
        if not page.startswith("tests") and page not in ("CHANGELOG.md", "docs/glossary.md"):
            word = re.search(r"\b(?:growth|drifts?|ring(?:s|ing)|null space)\b", text, re.IGNORECASE)
            check(not word or "glossary.md" in text, f"{page} uses '{word and word.group()}' and has no link to docs/glossary.md")
    for term in ("growth", "drift", "ringing", "null space of P2G"):
        check(re.search(rf"^\| [^|]*{term}", text_of(os.path.join(ROOT, "docs/glossary.md")), re.IGNORECASE | re.MULTILINE),
              f"docs/glossary.md does not explain '{term}'")


def check_links():
    """Each link to a file of the project has its file."""
    for page in pages():
        text = re.sub(r"```.*?```|`[^`]*`", "", text_of(os.path.join(ROOT, page)), flags=re.DOTALL)
        for link in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text):
            check(os.path.exists(os.path.join(ROOT, os.path.dirname(page), link)), f"{page}: there is no {link}")


def check_pages(rows):
    """Each number that is marked on a page is that of its row, and each row is marked on its page."""
    by_name = {row["claim"]: row for row in rows}
    marked = set()
    for page in pages():
        text = text_of(os.path.join(ROOT, page))
        found = MARK.findall(text)
        check(len(found) == text.count("<!-- claim "), f"{page}: a comment 'claim' without its number before it")
        for printed, name in found:
            row = by_name.get(name)
            check(row and row["page"] == page, f"{page}: no row of this page for the claim {name}")
            check(printed.strip("*`") == row["printed"], f"{page}: {name} is {printed}, not {row['printed']}")
            marked.add(name)
    tests = "".join(text_of(name) for name in glob.glob(os.path.join(ROOT, "tests", "**", "CMakeLists.txt"), recursive=True))
    for row in rows:
        if row["kind"] == "table":
            check(row["printed"] in text_of(os.path.join(ROOT, row["page"])).split("\n"),
                  f"{row['page']} has no line '{row['printed']}'")
            check(os.path.exists(os.path.join(ROOT, row["command"].split()[0])), f"no {row['command']}")
            check(re.search(rf"\b{row['found']}", tests), f"{row['claim']}: no test {row['found']}")
        else:
            check(row["claim"] in marked, f"{row['page']}: the claim {row['claim']} is not marked")


def value_of(found, result):
    """Returns the number that the words of a row name in the JSON of a task."""
    path, sign, number = (found.split() + ["-", "0"])[:3]
    *above, last = path.split(".")
    for name in above:
        result = result.get(name) if isinstance(result, dict) else result[int(name)]
        if result is None:
            return None
    if last == "critical_courant" and last not in result:
        return float("inf")  # there is no limit
    value = result.get(last) if isinstance(result, dict) else result[int(last)]
    if value is None:
        return None
    return float(value) / float(number) if sign == "/" else float(value) - float(number)


def number_of(printed):
    """Returns the number as printed; percent are hundredths, and 'none' is infinite."""
    if printed == "none":
        return float("inf")
    return float(printed.rstrip("%")) / (100 if printed.endswith("%") else 1)


def run(command):
    """Returns the JSON of a task."""
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out.json")
        done = forks.run([MPMSTAB, *shlex.split(command), "-json", out], cwd=ROOT, capture_output=True, text=True,
                         check=False)
        check(done.returncode in (0, 3) and os.path.exists(out), f"{command}: status {done.returncode}: {done.stderr}")
        with open(out, encoding="utf-8") as file:
            return json.load(file)


def check_numbers(rows):
    commands = list(dict.fromkeys(row["command"] for row in rows))
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        results = dict(zip(commands, pool.map(run, commands)))
    for row in rows:
        value, claimed = value_of(row["found"], results[row["command"]]), number_of(row["printed"])
        check(value is not None, f"{row['claim']}: {row['command']} has no {row['found']}")
        check(value == claimed or abs(value - claimed) <= float(row["tolerance"]) * max(abs(claimed), 1e-300),
              f"{row['claim']} on {row['page']}: {row['printed']}, but {row['command']} finds {value:.9g}")


def check_all_powers():
    """docs/spectra.md: the largest norm(A^n) over all n up to 1000, from the blocks of the waves, which are orthogonal."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "blocks.npz")
        forks.run([MPMSTAB, "symbol", "-formulation", "musl", "-courant", "1.73", "-write_blocks", path], check=True,
                  stdout=subprocess.DEVNULL)
        blocks = numpy.load(path)
        cells, blocks_at = blocks["d"].ravel(), blocks["A"]
    phases = 2 * numpy.pi * numpy.arange(33) / 64  # beta and -beta have conjugate blocks
    step = numpy.einsum("pb,bij->pij", numpy.exp(-1j * numpy.outer(phases, cells)), blocks_at)
    power, norms = step, []
    for _ in range(1000):
        norms.append(numpy.linalg.norm(power, 2, axis=(1, 2)).max())
        power = step @ power
    words = f"Over all n up to 1000 it is {max(norms):.4f}, at n = {1 + int(numpy.argmax(norms))}"
    check(words in text_of(os.path.join(ROOT, "docs/spectra.md")), f"docs/spectra.md: not '{words}'")


def main():
    rows = claims_of(sys.argv[1])
    check_pages(rows)
    check_words()
    check_links()
    if "--pages" in sys.argv:
        return
    check_all_powers()
    kinds = {"--nightly": ("nightly",), "--all": ("quick", "nightly", "slow")}.get(sys.argv[-1], ("quick",))
    check_numbers([row for row in rows if row["kind"] in kinds])


if __name__ == "__main__":
    main()
