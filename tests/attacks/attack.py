#!/usr/bin/python3
"""Random attacks on the program, in a folder of their own each. README.md beside it says what they are.

  attack.py MPIEXEC MPMSTAB [--seed N] [--minutes M] [--kinds KIND...]    attacks for so long
  attack.py MPIEXEC MPMSTAB --again KIND NUMBER [--seed N]                one attack, in the folder 'again', which stays
  attack.py MPIEXEC MPMSTAB --killed N [--seed N]                         runs killed three times each on two ranks

It prints what it finds as it comes, at last counts by kind, and ends with status 1 when it has found anything.
"""
import argparse
import os
import random
import sys
import tempfile
import time

sys.path.insert(1, os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "python"))

import files
import kills
import limits
import scenes
from oracle import Finding, Program

KINDS = {**scenes.ATTACKS, **files.ATTACKS, **kills.ATTACKS, **limits.ATTACKS}
# Of the time, in parts. Scripts take long, and tests of their own damage what they read.
SHARES = {"options": 6, "yaml": 3, "answers": 4, "checkpoint": 2, "mode": 1, "names": 2, "scripts": 1, "kills": 4, "ends": 1,
          "memory": 2, "sizes": 1, "disk": 1}


def attack(kind, number, seed, program, folder):
    """Tries one attack. Returns 'held', 'found' or why it was skipped."""
    dice = random.Random(f"{seed} {kind} {number}")
    os.chdir(folder)
    try:
        KINDS[kind](dice, program)
    except Finding as finding:
        print(f"FOUND by {kind} {number} (--seed {seed} --again {kind} {number}): {finding}", flush=True)
        return "found"
    except limits.Skip as skip:
        return str(skip)
    finally:
        os.chdir("/")
    return "held"


def attack_for(minutes, chosen, seed, program):
    """The kind that has had the least of its share of the time comes next."""
    end = time.monotonic() + 60 * minutes
    spent = dict.fromkeys(chosen, 0.0)
    counts = {kind: {"held": 0, "found": 0} for kind in chosen}
    skipped = {}
    while time.monotonic() < end and spent:
        kind = min(spent, key=lambda name: spent[name] / SHARES[name])
        begin = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            came = attack(kind, sum(counts[kind].values()), seed, program, folder)
        if came in counts[kind]:
            counts[kind][came] += 1
            spent[kind] += time.monotonic() - begin
        else:
            skipped[kind] = came
            del spent[kind]
    print(f"seed {seed}, {minutes:g} minutes\nattack        held  found")
    for kind, count in counts.items():
        print(f"{kind:12} {count['held']:5} {count['found']:6}   {skipped.get(kind, '')}".rstrip())
    print(f"{'all':12} {sum(c['held'] for c in counts.values()):5} {sum(c['found'] for c in counts.values()):6}")
    print("statuses: " + ", ".join(f"{status} {times} times" for status, times in sorted(program.ended.items(), key=str)))
    return sum(count["found"] for count in counts.values())


def kill_many(runs, seed, program):
    """Runs on two ranks, each killed three times and resumed to the last bit; longer ones where they were done too soon."""
    found = ended = 0
    for number in range(runs):
        for seconds in (1, 3, 6):
            with tempfile.TemporaryDirectory() as folder:
                os.chdir(folder)
                try:
                    times = kills.kill_often(random.Random(f"{seed} killed {number}"), program, 2, 3, seconds,
                                             ("SIGKILL", "SIGTERM"))
                except Finding as finding:
                    print(f"FOUND by run {number} of seed {seed}: {finding}", flush=True)
                    found += 1
                    times = 0
                os.chdir("/")
            if times in (0, 3):
                break
        ended += times
        if (number + 1) % 10 == 0:
            print(f"{number + 1} runs, killed {ended} times", flush=True)
    print(f"seed {seed}: {runs} runs on two ranks, killed {ended} times in all, {runs - found} resumed to the last bit")
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mpiexec")
    parser.add_argument("mpmstab", type=os.path.abspath)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=2)
    parser.add_argument("--kinds", nargs="+", choices=sorted(KINDS), default=list(KINDS))
    parser.add_argument("--again", nargs=2, metavar=("KIND", "NUMBER"))
    parser.add_argument("--killed", type=int)
    args = parser.parse_args()
    program = Program(args.mpiexec, args.mpmstab)
    if args.killed:
        return kill_many(args.killed, args.seed, program)
    if args.again:
        os.mkdir("again")
        return attack(args.again[0], int(args.again[1]), args.seed, program, "again") != "held"
    return attack_for(args.minutes, args.kinds, args.seed, program)


if __name__ == "__main__":
    sys.exit(1 if main() else 0)
