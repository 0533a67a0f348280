#!/usr/bin/python3
"""Runs the commands of the golden set again and compares what they give with what is recorded.

golden.py MPMSTAB [--record] [--only PATTERN] [--every-day | --nightly] [--jobs N] [--ranks N] [--mpiexec MPIEXEC]
          [--slowest N]

cases/GROUP.txt has the commands, answers/GROUP.json what they gave. README.md says how both are written.
"""
import argparse
import concurrent.futures
import difflib
import fnmatch
import glob
import json
import math
import os
import re
import shlex
import subprocess
import sys
import tempfile
import time

import digest

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
sys.path.append(os.path.join(ROOT, "tests", "support"))
import forks  # short commands, without loading the libraries of mpmstab for each
TASKS = ("run", "spectrum", "symbol", "critical", "map", "ensemble")
TOOLS = ("python3", "cc", "sh")
TOLERANCE = 1e-12
SPACE = re.compile("# +")  # a number with fewer digits is followed by more blanks
NUMBER = re.compile(r"(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?(?![\w.]*[a-zA-Z_])")
# The same for all machines and all who start the test; PETSC_OPTIONS is taken away.
ENVIRONMENT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "OMPI_MCA_pml": "ob1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1", "OMP_NUM_THREADS": "1",
               "OMPI_MCA_odls_base_sigkill_timeout": "0", "PYTHONDONTWRITEBYTECODE": "1", "COLUMNS": "80"}
RANKS = re.compile(r"\b\d+ ranks?\b")
PROGRESS = re.compile(r"(?m)^.*\d+ of \d+, \d+%, \d+ s left(?: \(.*\))?\n")  # a line a minute, on a machine that is busy


class Case:
    """A command, and where its numbers are compared more loosely than others."""

    def __init__(self, group, name, words, command):
        self.group, self.name, self.command, self.rules = group, name, command.strip(), []
        given = dict(word.split("=") for word in words.split())
        self.ranks, self.status, self.nightly = (int(given.pop(key, at)) for key, at in (("ranks", 1), ("status", 0), ("nightly", 0)))
        if given:
            sys.exit(f"golden: {name}: unknown {' '.join(given)}; allowed: ranks, status and nightly")


class Rule:
    """Where numbers may differ by more: the words PATTERN TOLERANCE REASON."""

    def __init__(self, words, where):
        pattern, tolerance, reason = (words.split(None, 2) + ["", "", ""])[:3]
        if not reason:
            sys.exit(f"golden: {where}: '{words.strip()}' is not PATTERN TOLERANCE REASON")
        self.pattern = re.compile(pattern)
        self.kind = next((k for k in ("1+", "+", "any") if tolerance.startswith(k)), "")
        self.tolerance = 0 if self.kind == "any" else float(tolerance[len(self.kind):])

    def allows(self, one, other):
        if self.kind == "any":
            return True
        if self.kind == "1+":
            return abs(one - 1) <= self.tolerance and abs(other - 1) <= self.tolerance
        return abs(one - other) <= self.tolerance * (1 if self.kind else max(abs(one), abs(other)))


def cases_of(path):
    """Reads a list of cases, 'NAME [ranks=N] [status=N] [nightly=1]: COMMAND', with its rules in lines that begin with ~ below it."""
    group, cases = os.path.basename(path)[:-len(".txt")], []
    with open(path, encoding="utf-8") as file:
        for number, line in enumerate(file, 1):
            line, where = line.strip(), f"{path}:{number}"
            if line.startswith("~"):
                cases[-1].rules.append(Rule(line[1:], where))
            elif line and not line.startswith("#"):
                match = re.match(r"(\S+?)((?: \w+=\d+)*):(.*)", line)
                if not match:
                    sys.exit(f"golden: {where}: not 'NAME [ranks=N] [status=N] [nightly=1]: COMMAND'")
                cases.append(Case(group, *match.groups()))
    return cases


def run(case, arguments):
    """Runs the commands of a case in a folder of its own. Returns what they give, as a dictionary without levels."""
    found, seconds = {"out": [], "err": []}, 0
    with tempfile.TemporaryDirectory() as folder:
        for name in ("examples", "tests", "include"):
            os.symlink(os.path.join(ROOT, name), os.path.join(folder, name))
        for number, command in enumerate(case.command.split(" && "), 1):
            words = shlex.split(command)
            ranks = arguments.ranks or case.ranks
            launch = [arguments.mpiexec, "-q", "-n", str(ranks)] if ranks > 1 else []
            task = words[0] if words else ""
            if task in TOOLS:
                words[0] = os.environ.get("CC", task) if task == "cc" else task
            elif task in TASKS and case.status != 2 and not {"-json", "-survey"} & set(words):
                words = [*launch, arguments.mpmstab, *words, "-json", f"{number}.json"]
            else:
                words = [*launch, arguments.mpmstab, *words]
            began = time.monotonic()
            try:
                done = forks.run(words, cwd=folder, capture_output=True, text=True, errors="replace", check=False, timeout=300,
                                 stdin=subprocess.DEVNULL)
            except subprocess.TimeoutExpired:
                found[f"status {number}"] = "no end after 300 s"
                break
            seconds += getattr(done, "seconds", time.monotonic() - began)  # of processor, where forks.py knows
            found[f"status {number}"] = done.returncode
            for name, text in (("out", done.stdout), ("err", PROGRESS.sub("", done.stderr))):
                found[name] += digest.lines(text.replace(folder + "/", "").replace(ROOT + "/", ""))
        found.update(digest.files(folder))
    return found, seconds


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def unit(text):
    """One in the last digit that is printed; infinite of a whole number."""
    digits, _, power = text.partition("e")
    if "." not in digits and not power:
        return math.inf
    return 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))


def same_line(path, old, new, rules):
    """Whether two lines have the same words and numbers; one in the last digit and what rules allow are the same."""
    rules = [rule for rule in rules if rule.pattern.search(f"{path}: {old}")]
    if old == new or any(rule.kind == "any" for rule in rules):
        return True
    if SPACE.sub("# ", NUMBER.sub("#", old)) != SPACE.sub("# ", NUMBER.sub("#", new)):
        return False
    for one, other in zip(NUMBER.findall(old), NUMBER.findall(new)):
        a, b, last = float(one), float(other), min(unit(one), unit(other))
        if not (one == other or (last < math.inf and abs(a - b) <= 1.001 * last) or max(abs(a), abs(b)) < digest.NOTHING
                or any(rule.allows(a, b) for rule in rules)):
            return False
    return True


def differences(path, old, new, rules):
    """Yields a line for each difference between two values of one name."""
    numbers = [v for v in (old, new) if is_number(v) or (isinstance(v, list) and v and all(map(is_number, v)))]
    if path in ("out", "err") or path.endswith(":text"):
        if len(old) == len(new) and all(same_line(path, a, b, rules) for a, b in zip(old, new)):
            return
        if len(old) == len(new):
            for a, b in zip(old, new):
                if not same_line(path, a, b, rules):
                    yield f"{path}: {a}\n{'':{len(path)}}->  {b}"
        else:
            yield from (f"{path}: {line}" for line in difflib.ndiff(old, new) if line[0] in "+-")
    elif len(numbers) == 2 and isinstance(old, list) == isinstance(new, list):
        olds, news = (old, new) if isinstance(old, list) else ([old], [new])
        rules = [rule for rule in rules if rule.pattern.search(path)]
        scale = max([abs(v) for v in (*olds, *news) if math.isfinite(v)], default=0)
        if len(olds) != len(news):
            yield f"{path}: {len(olds)} -> {len(news)} numbers"
        for k, (a, b) in enumerate(zip(olds, news)):
            same = a == b or (a != a and b != b) or abs(a - b) <= TOLERANCE * scale
            if not same and not any(rule.allows(a, b) for rule in rules):
                yield f"{path}{f'[{k}]' if isinstance(old, list) else ''}: {a!r} -> {b!r}, by {abs(a - b) / (scale or 1):.1e}"
    elif old != new and not any(rule.kind == "any" and rule.pattern.search(path) for rule in rules):
        yield f"{path}: {old!r} -> {new!r}"


def compare(old, new, rules):
    """Returns the lines that say how two answers differ, and the new answer with the old values where they agree."""
    told, kept = [], {}
    for path in [*old, *(path for path in new if path not in old)]:
        if path not in new:
            told.append(f"{path}: {old[path]!r} -> missing")
            continue
        lines = [f"{path}: new, {new[path]!r}"]
        if path in old:
            lines = list(differences(path, old[path], new[path], rules))
        told += lines
        kept[path] = new[path] if lines else old[path]
    return told, kept


def of_any_ranks(answer):
    """An answer whose lines do not say how many ranks there were."""
    return {key: [RANKS.sub("ranks", line) for line in value] if key in ("out", "err") else value for key, value in answer.items()}


def write(path, answers):
    """Writes the answers of a group: a line for each value, so that a change is a line of a diff."""
    text = ["{"]
    for name, answer in sorted(answers.items()):
        text.append(f" {json.dumps(name)}: {{")
        for key, value in sorted(answer.items()):
            words = json.dumps(value)
            if key in ("out", "err") or key.endswith(":text"):
                words = "[" + ",".join(f"\n   {json.dumps(line)}" for line in value) + "]"
            text.append(f"  {json.dumps(key)}: {words},")
        text[-1] = text[-1].rstrip(",")
        text.append(" },")
    text[-1] = text[-1].rstrip(",")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join([*text, "}", ""]))


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("mpmstab", type=os.path.abspath)
    parser.add_argument("--record", action="store_true")
    parser.add_argument("--only", default="*")
    parser.add_argument("--every-day", action="store_true")
    parser.add_argument("--nightly", action="store_true")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--ranks", type=int, help="of all cases, in place of their own")
    parser.add_argument("--mpiexec", default="mpirun")
    parser.add_argument("--slowest", type=int, default=0)
    arguments = parser.parse_args()
    with open(os.path.join(HERE, "rules.txt"), encoding="utf-8") as file:
        common = [Rule(line, "rules.txt") for line in file if line.strip() and line[0] != "#"]
    cases = [case for path in sorted(glob.glob(os.path.join(HERE, "cases", "*.txt"))) for case in cases_of(path)]
    names = [case.name for case in cases]
    if len(names) > len(set(names)):
        sys.exit(f"golden: two cases have the name {next(n for n in names if names.count(n) > 1)}; allowed: one")
    groups = {case.group: {} for case in cases}
    for group, answers in groups.items():
        path = os.path.join(HERE, "answers", f"{group}.json")
        if os.path.exists(path):
            with open(path, encoding="utf-8") as file:
                answers.update(json.load(file))
    wanted = [case for case in cases if fnmatch.fnmatch(case.name, arguments.only) or case.group == arguments.only]
    wanted = [case for case in wanted if not (arguments.every_day and case.nightly or arguments.nightly and not case.nightly)]
    if arguments.ranks:
        if arguments.record:
            sys.exit("golden: --ranks with --record would record what the cases do not ask for; allowed: one of them")
        wanted = [case for case in wanted if "-ranks" not in case.command]  # it says how many there must be
    wanted.sort(key=lambda case: -case.ranks)  # those of several ranks take longest
    tools = tempfile.TemporaryDirectory()  # programs of cases run with the Python that runs this
    os.symlink(sys.executable, os.path.join(tools.name, "python3"))
    os.environ.update(ENVIRONMENT, PATH=tools.name + ":" + os.environ["PATH"])
    os.environ.pop("PETSC_OPTIONS", None)
    began, differ, seconds = time.monotonic(), [], {}
    with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for case, (found, took) in zip(wanted, pool.map(lambda case: run(case, arguments), wanted)):
            seconds[case.name] = took
            known = groups[case.group].get(case.name, {})
            if arguments.ranks:
                known, found = of_any_ranks(known), of_any_ranks(found)
            told, groups[case.group][case.name] = compare(known, found, case.rules + common)
            last = max((key for key in found if key.startswith("status")), key=lambda key: int(key.split()[1]))
            if found[last] != case.status:
                told.append(f"status {found[last]}, and its line in cases/{case.group}.txt says {case.status}")
            if told:
                differ.append(case.name)
                shown = told if len(told) <= 12 else [*told[:12], f"and {len(told) - 12} more"]
                if not arguments.record:
                    print(f"{case.name}: {case.command}", *shown, sep="\n    ", flush=True)
    for group, answers in groups.items():
        for name in [name for name in answers if name not in names]:
            differ.append(name)
            del answers[name]
            print(f"{name}: recorded in answers/{group}.json, and no case")
        if arguments.record:
            os.makedirs(os.path.join(HERE, "answers"), exist_ok=True)
            write(os.path.join(HERE, "answers", f"{group}.json"), answers)
    for name in sorted(seconds, key=seconds.get, reverse=True)[:arguments.slowest]:
        print(f"{seconds[name]:6.2f} s  {name}")
    print(f"golden: {len(wanted)} cases, {len(differ)} {'recorded anew' if arguments.record else 'differ'}, "
          f"{time.monotonic() - began:.0f} s")
    sys.exit(bool(differ) and not arguments.record)


if __name__ == "__main__":
    main()
