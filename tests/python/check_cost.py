#!/usr/bin/python3
"""Counts the instructions of small marches with callgrind and compares them with recorded ones.

check_cost.py PROGRAM RECORDED COMPILER [--record]

It counts what runs inside MpmMarchStep, per particle and step. A march is a formulation, a basis, the drift, and the
dimension and 'jittered' where it is not the uniform one of one dimension. A formulation as text costs as much as the same one of
the program, with any compiler. Another compiler makes other code, with which nothing is compared (status 77). --record
writes new numbers; say in the commit what changed them.
"""
import argparse
import json
import os
import re
import subprocess
import sys
import tempfile

from checks import check, loaded
import program

WITHIN = 0.1
SAME = 1e-2  # where arrays lie in memory decides how many of their first numbers are not in vectors
TEXT = "musl linear 0"
PPC, STEPS = 2, 20
CELLS = {1: 2000, 2: 24, 3: 6}  # along each direction, by dimension
MARCHES = ("gas2 linear 0", "usl quadratic 0.3", "musl linear 0",
           "usl quadratic 0.01 2", "usl quadratic 0 3 jittered")


def written(mpmstab, formulation, folder):
    """A formulation of the program as text: the words that name it."""
    path = os.path.join(folder, "scheme.yaml")
    done = subprocess.run([mpmstab, "list", "formulation", formulation], capture_output=True, text=True, check=False)
    check(done.returncode == 0, f"list formulation {formulation}: status {done.returncode}: {done.stderr}")
    with open(path, "w", encoding="utf-8") as file:
        file.write(done.stdout)
    return ["-scheme", path]


def instructions(mpmstab, march, as_text=False):
    formulation, basis, drift, *more = march.split()
    dim = int(more[0]) if more else 1
    box = ["-dim", str(dim), "-poisson", "0.3", "-jitter", "0.4" if more[1:] else "0"] if more else []
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "callgrind")
        scheme = written(mpmstab, formulation, folder) if as_text else ["-formulation", formulation]
        done = subprocess.run(["valgrind", "--tool=callgrind", "--toggle-collect=MpmMarchStep",
                               f"--callgrind-out-file={out}", mpmstab, "run", *scheme, "-basis", basis, "-drift",
                               drift, "-cells", str(CELLS[dim]), "-ppc", str(PPC), "-steps", str(STEPS), "-courant", "0.1",
                               *box],
                              capture_output=True, text=True, check=False)
        check(done.returncode == 0, f"{march}: status {done.returncode}: {done.stderr}")
        with open(out, encoding="utf-8") as file:
            counted = int(re.search(r"^(?:summary|totals): (\d+)", file.read(), re.M).group(1))
    check(counted, f"{march}: no instruction was counted in MpmMarchStep")
    return counted / ((CELLS[dim] * PPC) ** dim * STEPS)


def check_text(mpmstab, march, built_in):
    """A formulation as text makes the same passes as the one of the program, so it costs the same."""
    as_text = instructions(mpmstab, march, as_text=True)
    print(f"{march:26} {as_text:8.2f} as text")
    check(abs(as_text / built_in - 1) < SAME, f"{march}: {as_text:.2f} instructions as text, {built_in:.2f} built in")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program")
    parser.add_argument("recorded")
    parser.add_argument("compiler")
    parser.add_argument("--record", action="store_true")
    args = parser.parse_args()
    found = {march: round(instructions(args.program, march), 3) for march in MARCHES}
    if args.record:
        recorded = {"compiler": args.compiler, "instructions": found}
        program.write_whole(args.recorded, json.dumps(recorded, indent=2) + "\n")
        return
    check_text(args.program, TEXT, found[TEXT])
    recorded = loaded(args.recorded)
    off = []
    for march, now in found.items():
        before = recorded["instructions"][march]
        print(f"{march:26} {now:8.2f} instructions per particle and step, recorded {before:8.2f} "
              f"({now / before - 1:+.1%})")
        if abs(now / before - 1) > WITHIN:
            off.append(march)
    if recorded["compiler"] != args.compiler:
        print(f"recorded with {recorded['compiler']}, this is {args.compiler}: not compared")
        sys.exit(77)
    check(not off, f"off by more than {WITHIN:.0%}: {', '.join(off)}; if it is meant to be, record it:\n  "
                   f"{' '.join(sys.argv[:3])} '{args.compiler}' --record")


if __name__ == "__main__":
    main()
