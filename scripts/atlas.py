#!/usr/bin/python3
"""Writes an atlas: static pages with the limits, growth and damping of every scheme, to be sorted and searched.

atlas.py [-o atlas] [--only WORD...] [--dim 1,2,3] [--jobs N] [--estimate]

Open atlas/index.html in a browser; it needs no network. For each formulation, transfer, basis, gradient and dimension it
has the largest stable Courant number inside a body, at its edge and of a lone particle; growth of moving particles over
their velocity; damping of waves over their length; a map over velocity and Courant number; and the command of each
number. --only chooses schemes: each WORD is a name, or several with commas of which one must fit, as in '--only musl,usl
linear'. The script says first how long it takes, for all about 40 minutes on two cores; --estimate says it and ends. Each
answer is kept in the folder atlas/answers: give the same command again to go on after an interruption. The environment
variable MPMSTAB names the program (by default build/mpmstab).
"""
# This import comes first, so that Ctrl-C during those below is one line too.
from program import PROGRAM, Parser, end_in_one_line, processor, refuse, require_program
import datetime
import os
import subprocess
import sys
import threading
import time

import atlas_answers
import atlas_rows
import atlas_site
from report_html import escaped

EVERY = 10  # seconds between lines of progress in a log; a terminal has one line, which changes
# Seconds of one core for a question, by dimension, and for affine transfers, which have larger matrices.
COST = {"limits": ((0.24, 0.5, 1), (0.11, 1.1, 3.5)), "lone": ((0.1, 0.4, 0.7), (0.1, 0.15, 0.3)),
        "damping": ((0.09, 0.1, 0.13), (0.1, 0.11, 0.6)), "moving": ((0.12, 0.6, 0.18), (0.13, 0.85, 0.55)),
        "map": ((0.8, 0.85, 0), (0.75, 1.9, 0))}
AFFINE = ("apic", "tpic", "aflip")


def numbers(text):
    found = sorted({int(word) for word in text.split(",")})
    if not found or found[0] < 1 or found[-1] > 3:
        raise ValueError
    return found


def parse():
    parser = Parser(__doc__)
    parser.add_argument("-o", "--output", default="atlas", metavar="FOLDER", help="where the pages are written (atlas)")
    parser.add_argument("--only", nargs="+", default=[], metavar="WORD", help="names that a scheme must have")
    parser.add_argument("--dim", type=numbers, default=[1, 2, 3], help="dimensions (1,2,3)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(),
                        help="commands at a time (as many as there are cores)")
    parser.add_argument("--estimate", action="store_true", help="say how long it takes, and end")
    arguments = parser.parse_args()
    if arguments.jobs < 1:
        refuse(f"--jobs {arguments.jobs}: allowed: 1 or more")
    return arguments


def cost_of(row, name, momentum):
    """Returns about how many seconds of one core a question takes. Affine transfers are of momentum schemes alone."""
    affine = row.words["transfer"] in AFFINE
    return 0 if affine and row.words["formulation"] not in momentum else COST[name.split()[0]][affine][row.dim - 1]


def minutes(seconds):
    return f"{seconds:.0f} s" if seconds < 100 else f"{seconds / 60:.0f} min"


class Progress:
    """Says how many questions are answered, and how long the others will take at the pace so far."""

    def __init__(self, answers, rows, jobs):
        asked = [(row, name, words) for row in rows for name, words in row.questions().items()]
        momentum = atlas_rows.words_of("formulation", "momentum,")
        self.cost = {(row.name, name): cost_of(row, name, momentum) for row, name, words in asked
                     if answers.kept(words) is None}
        self.all, self.count, self.jobs = len(asked), len(asked) - len(self.cost), jobs
        self.left = self.whole = sum(self.cost.values())
        self.begin = self.said = time.monotonic()
        self.lock, self.terminal = threading.Lock(), sys.stderr.isatty()

    def estimate(self):
        kept = f", {self.count} of them answered" if self.count else ""
        return f"{self.all} questions{kept}; about {minutes(self.left / self.jobs)} with {self.jobs} at a time"

    def told(self, row, name, refused):
        """Counts an answer. What had been kept has no cost, and had been counted. What is refused says nothing of the pace."""
        with self.lock:
            cost = self.cost.pop((row.name, name), None)
            if cost is None:
                return
            self.count += 1
            self.left -= cost
            self.whole -= cost if refused else 0
            now = time.monotonic()
            done = self.whole - self.left
            if done > 0 and now - self.said > (0.5 if self.terminal else EVERY):
                self.said = now
                pace = (now - self.begin) / done
                print(f"atlas: {self.count} of {self.all} questions, about {minutes(self.left * pace)} left",
                      end="  \r" if self.terminal else "\n", file=sys.stderr, flush=True)


def facts(arguments, rows):
    version = subprocess.run([PROGRAM, "--version"], capture_output=True, text=True, check=False).stdout.strip()
    found = (("program", version), ("combinations asked", len(rows)),
             ("processor", f"{processor()}, {arguments.jobs} commands at a time"),
             ("date", datetime.datetime.now().astimezone().isoformat(" ", "seconds")))
    return [[escaped(name), escaped(value)] for name, value in found]


def main():
    arguments = parse()
    require_program()
    rows = atlas_rows.rows_of(arguments.dim, arguments.only)
    if not rows:
        refuse(f"--only {' '.join(arguments.only)}: no scheme has these names; allowed: names that 'mpmstab list' prints, "
               "basis or mls")
    kept = os.path.join(arguments.output, "answers")
    answers = atlas_answers.Answers(kept)
    if not arguments.estimate:
        for folder in (kept, os.path.join(arguments.output, "schemes")):
            os.makedirs(folder, exist_ok=True)
    progress = Progress(answers, rows, arguments.jobs)
    print(f"atlas: {len(rows)} combinations, {progress.estimate()}", file=sys.stderr, flush=True)
    if arguments.estimate:
        return
    found = atlas_answers.ask_all(answers, rows, arguments.jobs, progress.told)
    count = atlas_site.write_site(arguments.output, rows, found, facts(arguments, rows))
    print(f"written: {os.path.join(arguments.output, 'index.html')}, {count} schemes")


if __name__ == "__main__":
    end_in_one_line(main)
