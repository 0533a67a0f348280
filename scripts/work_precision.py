#!/usr/bin/python3
"""Runs a scene in all combinations of some of its parameters and says which is cheapest for an error.

work_precision.py SCENE.yaml [--cells 32,64,128] [--courant 0.25,0.5] [--ppc 1,2] [--formulation gas1,gas2]
                  [--transfer flip,pic] [--basis linear,quadratic] [--ranks 1,2] [--repeats 6] [--most 30]
                  [--error 1e-2,1e-3] [--time T] [-o NAME]
work_precision.py --page [SCENES] [-o FOLDER]    all that docs/work-precision.md shows, or some of its scenes
work_precision.py --check [SCENES]               compares that page: its errors, and its times of scenes (all: of each)
work_precision.py --costs ROUNDS                 measures what a step of each scheme costs, for these times

Without --courant each scheme runs at five Courant numbers up to 0.95 of its limit for particles at rest, since schemes
have different limits. Particles that move keep their velocity: the drift is in proportion to the Courant number.

All combinations run to the same time, which is that of --time, or the end of the scene as it stands. The error is the
largest l2 error over the fields at the end, against the exact solution and relative to its amplitude. In two and three
dimensions --cells are those along x, and the other directions follow in the scene's proportion; --ppc are the particles
of a cell in each direction. The time is that of the loop, without start-up. Each of the --repeats rounds runs all
combinations once, in an order of its own, so that a slow machine slows all of them alike. Rounds of the first three
schemes go on, up to --most, until their order is certain at each --error: until one is slower in so many rounds that it
would be chance in one case of 40. NAME.runs.jsonl keeps each
run as soon as it is done: give the same command again to resume after an interruption, or a wider range to add to it.
NAME.csv has a row for each combination, NAME.png and NAME.svg have the picture. The environment variable MPMSTAB names
the program (by default build/mpmstab).
"""
# This import comes first, so that Ctrl-C during those below is one line too.
from program import (PROGRAM, Parser, end_in_one_line, launch, processor, refuse, require_input, require_outputs,
                     require_program, say, write_whole)
from fractions import Fraction
import fcntl
import hashlib
import itertools
import json
import math
import os
import platform
import random
import sys
import tempfile
import time

import precision_costs
import precision_page
import precision_picture
from picture_style import save
from precision_study import SCHEMES, TRANSFERS
from precision_table import (PARAMETERS, SCHEME, answer, csv_text, key, make_rows, outstanding, remarks, table,
                             uncertain_rows)

MOST_PHASES = {1: None, 2: 64, 3: 12}  # of the symbol in each direction, by dimension; None: as many as cells
SHARES = (0.95, 0.8, 0.6, 0.4, 0.2)  # of a scheme's limit, the Courant numbers that are searched,
PARTS = 8                            # in steps of this part of the scene's own
KINDS = {"cells": int, "courant": float, "ppc": int, "ranks": int, "formulation": str, "transfer": str, "basis": str}


def ranged(kind):
    """Returns a reader of values that commas separate; it keeps each value once."""
    def read(text):
        return list(dict.fromkeys(kind(word) for word in text.split(",")))
    read.__name__ = f"list of {kind.__name__}"  # argparse shows this name when it refuses
    return read


def parse():
    parser = Parser(__doc__)
    parser.add_argument("scene", metavar="SCENE.yaml", nargs="?")
    parser.add_argument("--page", nargs="?", const=",".join(precision_page.SCENES_SHOWN), type=ranged(str))
    parser.add_argument("--check", nargs="?", const="none", type=ranged(str))
    parser.add_argument("--costs", type=int)
    for name, kind in KINDS.items():
        parser.add_argument(f"--{name}", type=ranged(kind))
    parser.add_argument("--repeats", type=int, default=6)
    parser.add_argument("--most", type=int, default=30)
    parser.add_argument("--error", type=ranged(float), default=[1e-3])
    parser.add_argument("--time", type=float)
    parser.add_argument("-o", "--output", metavar="NAME", default="work-precision")
    arguments = parser.parse_args()
    arguments.check = {"none": [], "all": precision_page.SCENES_SHOWN}.get(",".join(arguments.check or []), arguments.check)
    for name in [*(arguments.page or []), *(arguments.check or [])]:
        if name not in precision_page.SCENES:
            refuse(f"{name} is no scene of the page; allowed: {', '.join(precision_page.SCENES)}")
    if not (arguments.scene or arguments.page or arguments.costs or arguments.check is not None):
        refuse("no scene; allowed: SCENE.yaml, --page, --check or --costs")
    for name in ("cells", "courant", "ppc", "ranks", "error"):
        if any(not 0 < value < float("inf") for value in getattr(arguments, name) or []):
            refuse(f"--{name} {','.join(map(str, getattr(arguments, name)))}: allowed: numbers above 0")
    if arguments.repeats < 1 or arguments.most < 1 or (arguments.time is not None and not 0 < arguments.time < float("inf")):
        refuse("--repeats, --most, --time: allowed: numbers above 0")
    return arguments


def digest(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def look_at(arguments):
    """Runs the scene as it stands. Returns its result, its end time, and what the file of runs must be made from."""
    status, base, said = launch("run", arguments.scene)
    if status not in (0, 3) or not base:  # 3: an expectation is missed, which does not matter here
        refuse(f"{arguments.scene} does not run: {said or f'status {status}'}")
    if "error" not in base["run"]:
        refuse(f"{arguments.scene}: these data have no exact solution; allowed: initial mode, pulse or step")
    end = base["run"]["time"] if arguments.time is None else arguments.time
    made_from = {"scene": digest(arguments.scene), "program": digest(PROGRAM), "version": base["version"], "time": end,
                 "machine": f"{platform.node()}, {processor()}"}
    return base, end, made_from


def as_option(base, cells):
    """Returns the option -cells for so many cells along x, in the proportion of the scene's grid."""
    own = base["cells"] if isinstance(base["cells"], list) else [base["cells"]]
    part = own[0] // math.gcd(*own)
    if cells % part:
        refuse(f"--cells {cells}: no grid in the proportion of {' x '.join(map(str, own))} cells; "
               f"allowed: multiples of {part}")
    return ",".join(str(cells * count // own[0]) for count in own)


def plain(value):
    """Returns what a scene has for each direction as one value: it, when all are the same, else a text."""
    if not isinstance(value, list):
        return value
    return value[0] if len(set(value)) == 1 else ",".join(f"{one:g}" for one in value)


def lock(path):
    """Returns the file of runs, open and locked. When another script has locked it, this one is refused."""
    file = open(path, "a", encoding="utf-8")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        refuse(f"{path} is being written by another work_precision.py; allowed: one at a time (-o names another file)")
    return file


def add_line(path, record):
    """Adds a line to the file at once; an error names the file."""
    try:
        with open(path, "a", encoding="utf-8") as file:
            file.write(json.dumps(record) + "\n")
    except OSError as error:
        error.filename = path
        raise


def read_runs(path, made_from):
    """Returns the runs that are in the file, but for those that failed, which are run again."""
    with open(path, "rb") as file:
        text = file.read()
    whole = text[: text.rfind(b"\n") + 1]  # a line that was cut off is run again
    if not whole and json.dumps(made_from).encode().startswith(text):
        os.truncate(path, 0)
        add_line(path, made_from)
        return []
    try:
        first, *records = [json.loads(line) for line in whole.decode().splitlines()]
        differs = [name for name in made_from if first[name] != made_from[name]]
    except (ValueError, KeyError, TypeError):
        refuse(f"{path} is not a file of runs; allowed: one that this script has written, or none (-o names another)")
    if differs:
        refuse(f"{path} holds runs of another {' and '.join(differs)}, which do not compare with these; allowed: the "
               "same (-o names another file, or delete it)")
    os.truncate(path, len(whole))
    return [record for record in records if record["status"] != "failed"]


def courants_of(arguments, combination, base):
    """Returns the Courant numbers at which a scheme is run: those given, or the scene's own, or parts of its limit."""
    if arguments.courant:
        return arguments.courant
    given = {name: combination[name] for name in ("formulation", "transfer", "basis", "ppc") if getattr(arguments, name)}
    still = {"drift": 0} if moves(base) else {}
    _, found, _ = launch("critical", arguments.scene, {**given, **still})
    limit, own = found.get("critical", {}).get("critical_courant"), base["courant"]
    if not isinstance(limit, (int, float)) or not 0 < limit < math.inf:
        return [own]  # what has no limit, or is refused
    steps = [math.floor(PARTS * share * limit / own) for share in SHARES]
    return [own * count / PARTS for count in dict.fromkeys(steps) if count > 0] or [own]


def moves(base):
    return any(base["drift"] if isinstance(base["drift"], list) else [base["drift"]])


def combine(arguments, base):
    """Returns all combinations, those of each scheme at its own Courant numbers."""
    own = {name: plain(base[name]) for name in PARAMETERS}
    own["cells"] = base["cells"][0] if base["dim"] > 1 else base["cells"]
    schemes = itertools.product(*(getattr(arguments, name) or [own[name]] for name in SCHEME))
    combinations = []
    for values in schemes:
        scheme = dict(zip(SCHEME, values))
        for courant, cells in itertools.product(courants_of(arguments, scheme, base), arguments.cells or [own["cells"]]):
            combinations.append({**scheme, "courant": courant, "cells": cells})
    return combinations


def options_of(arguments, combination, base):
    """Returns the options of a combination: those that the arguments vary, and the Courant number with its drift."""
    given = {name: combination[name] for name in KINDS if name != "ranks" and getattr(arguments, name)}
    if combination["courant"] != base["courant"]:
        given["courant"] = combination["courant"]
        if not arguments.courant and moves(base):
            given["drift"] = drift_at(base, combination["courant"])
    return {**given, "cells": as_option(base, given["cells"])} if "cells" in given else given


def drift_at(base, courant):
    """Returns the drift of the scene's velocity at another Courant number, as fractions."""
    part = Fraction(round(PARTS * courant / base["courant"]), PARTS)
    own = base["drift"] if isinstance(base["drift"], list) else [base["drift"]]
    return ",".join(str(Fraction(one).limit_denominator(10000) * part) for one in own)


def measure(arguments, combination, base, end, first):
    """Returns one run as a record. The first run of a combination also asks the symbol how all waves grow."""
    given = options_of(arguments, combination, base)
    status, found, said = launch("run", arguments.scene, {**given, "time": end}, combination["ranks"])
    if status not in (0, 3) or not found:
        return {**combination, "status": "refused" if status == 2 else "failed",
                "note": said.removeprefix("mpmstab: ") or f"status {status}"}
    run = found["run"]
    record = dict(combination, dim=found["dim"], drift=plain(found["drift"]), particles=found["particles"],
                  steps=run["steps"], time=run["time"], verdict=found["verdict"], growth=found.get("growth"),
                  error=run["error"], loop_s=run["loop_s"], note=None)
    unstable = found["verdict"] == "unstable"
    if first:
        most = MOST_PHASES[found["dim"]]
        phases = {"phases": ",".join(str(min(most, count)) for count in found["cells"])} if most else {}
        _, symbol, _ = launch("symbol", arguments.scene, {**given, **phases})  # {} where the symbol does not cover it
        record["growth_all_waves"] = symbol.get("growth")
        unstable = unstable or symbol.get("verdict") == "unstable"
    record["status"] = "unstable" if unstable else "ok"
    return record


def progress(done, total, begin, already):
    if sys.stderr.isatty():
        left = (time.monotonic() - begin) / max(1, done - already) * (total - done)
        end = "" if done < total else "\n"
        print(f"\rrun {done} of {total}, {left:.0f} s left   ", end=end, file=sys.stderr, flush=True)


def run_rounds(arguments, combinations, base, end, records, path, rounds):
    """Runs what is missing in these rounds, and adds it to the records and to the file."""
    have = {(key(record), record["round"]) for record in records}
    over = {key(record) for record in records if record["status"] == "refused"}
    total, begin, already = len(rounds) * len(combinations), time.monotonic(), 0
    done = 0
    for number in rounds:
        order = list(combinations)
        random.Random(number).shuffle(order)
        for combination in order:
            name = key(combination)
            if (name, number) in have or name in over:
                already += 1
            else:
                record = {**measure(arguments, combination, base, end, number == 1), "round": number}
                add_line(path, record)
                records.append(record)
                if record["status"] in ("refused", "failed"):
                    over.add(name)
            done += 1
            progress(done, total, begin, already)


def run_all(arguments, combinations, base, end, records, path):
    """Runs the rounds that were asked for, and then those of the first schemes until their order is certain."""
    run_rounds(arguments, combinations, base, end, records, path, range(1, arguments.repeats + 1))
    for number in range(arguments.repeats + 1, arguments.most + 1):
        rows = make_rows(records, combinations)
        names = {key(row) for wanted in arguments.error for row in uncertain_rows(rows, wanted)}
        if not names:
            return
        again = [combination for combination in combinations if key(combination) in names]
        run_rounds(arguments, again, base, end, records, path, [number])


def title(arguments, rows, end):
    scene = os.path.relpath(arguments.scene)
    names = [name for name in ("formulation", "basis", "transfer", "ppc", "courant", "drift")
             if len({row[name] for row in rows}) == 1 and rows[0][name] is not None]
    values = [f"{rows[0][name]:g}" if isinstance(rows[0][name], float) else rows[0][name] for name in names]
    same = [f"{'k' if name == 'courant' else name} {value}" for name, value in zip(names, values)]
    if not arguments.courant:
        same.append("Courant numbers up to 0.95 of each limit")
    return f"{scene} to time {end:g}\n{', '.join(same)}; best of {max(row['repeats'] for row in rows)}"


def report(arguments, rows, base, end):
    """Prints the table and its conclusions; writes the CSV and the picture."""
    write_whole(f"{arguments.output}.csv", csv_text(rows))
    shown = rows if arguments.courant else outstanding(rows)
    save(precision_picture.draw(shown, title(arguments, rows, end), not arguments.courant), arguments.output)
    print(f"error against run time: {arguments.scene} to time {end:g}"
          + ("" if arguments.time else f" (where the scene's {base['run']['steps']} steps end)"))
    print("error: the largest l2 error of all fields at the end, over the exact amplitude (apic's affine part does not count)\n"
          "best, median: times of the time loop alone; growth: per step of this run; all waves: growth by the symbol")
    if base["dim"] > 1:
        print(f"{base['dim']} dimensions: cells are counted along x, and the other directions are in proportion to "
              f"{' x '.join(map(str, base['cells']))}; ppc is that of each direction;\n"
              f"the symbol has at most {MOST_PHASES[base['dim']]} phases in each direction")
    print()
    print(table(shown))
    if len(shown) < len(rows):
        print(f"and {len(rows) - len(shown)} rows that another Courant number of the same scheme makes needless: "
              f"{arguments.output}.csv has all")
    print()
    for wanted in arguments.error:
        print(answer(rows, wanted))
    for line in remarks(rows):
        print(f"note: {line}")
    print(f"\nwritten: {arguments.output}.csv, .png, .svg; each run: {arguments.output}.runs.jsonl")


def main():
    arguments = parse()
    require_program()
    if arguments.check is not None:
        with tempfile.TemporaryDirectory() as folder:
            precision_page.check(folder, arguments.check)
        return
    if arguments.costs:
        precision_costs.measure(SCHEMES, TRANSFERS, arguments.costs)
        return
    if arguments.page:
        precision_page.make(arguments.output, arguments.page)
        return
    require_input(arguments.scene, "a scene in YAML")
    require_outputs([f"{arguments.output}.{ending}" for ending in ("csv", "png", "svg", "runs.jsonl")],
                    [arguments.scene, PROGRAM])
    base, end, made_from = look_at(arguments)
    for cells in arguments.cells or []:
        as_option(base, cells)
    combinations = combine(arguments, base)
    path = f"{arguments.output}.runs.jsonl"
    interrupted = False
    with lock(path):
        records = read_runs(path, made_from)
        try:
            run_all(arguments, combinations, base, end, records, path)
        except KeyboardInterrupt:
            interrupted = True
        rows = make_rows(records, combinations)
        if any(row["status"] not in ("refused", "failed") for row in rows):
            report(arguments, rows, base, end)
        elif not interrupted:
            refuse(f"no combination runs: {rows[0]['note']}")
    if interrupted:
        say("interrupted; the same command goes on")
        sys.exit(130)


if __name__ == "__main__":
    end_in_one_line(main)
