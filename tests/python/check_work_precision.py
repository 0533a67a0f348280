#!/usr/bin/python3
"""Checks work_precision.py: orders, errors, frontier, refusals, unstable runs, words, resuming when killed, its page.

check_work_precision.py, in a folder that may be filled, MPMSTAB set. Silent when all is well.
"""
import csv
import fcntl
import glob
import itertools
import json
import math
import os
import re
import resource
import signal
import subprocess
import sys
import time

from checks import SCRIPTS, check, check_one_line, run_script
from precision_picture import draw
import precision_costs
import precision_study
from precision_table import answer, cheapest_of, make_rows, remarks, uncertain_rows
from program import PROGRAM, launch

SCRIPT = os.path.join(SCRIPTS, "work_precision.py")
SCENE = "formulation: gas2\nstagger: true\ncourant: 0.5\ntime: 1\n"
RANGES = ("--cells 16,32,64 --formulation gas1,gas2,usl --transfer flip,apic --courant 0.5 --repeats 2 --most 2 "
          "--error 1e-2,1e-9").split()
ONCE = ("--courant", "0.5", "--most", "1")  # one Courant number, and no round more than was asked for


def start(*arguments, **how):
    return run_script("work_precision.py", *arguments, **how)


def lines_of(path):
    with open(path, encoding="utf-8") as file:
        return file.read().splitlines()


def rows_of(path):
    with open(path, encoding="utf-8") as file:
        return list(csv.DictReader(file))


def check_content():
    done = start("scene.yaml", *RANGES, "-o", "wp")
    check(done.returncode == 0 and done.stderr == "", f"status {done.returncode}: {done.stderr}")
    rows = {(row["formulation"], row["transfer"], int(row["cells"])): row for row in rows_of("wp.csv")}
    check(len(rows) == 18, f"{len(rows)} rows, not 18")
    for name, cells in itertools.product((("gas2", "flip"), ("usl", "flip")), (32, 64)):
        order = float(rows[(*name, cells)]["order"])
        check(abs(order - 2) < 0.3, f"{name}, {cells} cells: order {order}, not 2")
    for (formulation, transfer, cells), options in {
            ("gas2", "flip", 32): {}, ("usl", "apic", 64): {"formulation": "usl", "transfer": "apic"},
            ("gas1", "flip", 16): {"formulation": "gas1", "stagger": "false"}}.items():
        _, found, said = launch("run", "scene.yaml", {"cells": cells, **options})
        error = found["run"]["error"]
        row = rows[formulation, transfer, cells]
        largest = max((value["l2"], field) for field, value in error.items() if field != "c")
        check((float(row["error_l2"]), row["field"]) == largest, f"{row}: the program says {error} {said}")
        check(int(row["steps"]) == found["run"]["steps"] and int(row["particles"]) == 2 * cells, f"{row}")
        check(int(row["repeats"]) == 2 and 0 < float(row["best_s"]) <= float(row["median_s"]), f"{row}")
    for cells in (16, 32, 64):
        gas1, refused = rows["gas1", "flip", cells], rows["gas1", "apic", cells]
        check(gas1["status"] == "unstable" and abs(float(gas1["growth_all_waves"]) - math.sqrt(1.25)) < 1e-9, f"{gas1}")
        check(gas1["frontier"] == "0", f"{gas1}")
        check(refused["status"] == "refused" and "no momentum" in refused["note"], f"{refused}")
        check(refused["best_s"] == "", f"{refused}")
    check_frontier(rows.values())
    check_picture("wp.svg")
    check(os.path.getsize("wp.png") > 10000, "wp.png is small")
    for words in ("for error 0.01 the cheapest here is usl apic", "error 1e-09: nothing that is stable reaches it here",
                  "note: gas2 apic: -transfer apic", "shorter than 1 ms"):
        check(words in done.stdout, f"no '{words}' in {done.stdout}")


def check_frontier(rows):
    """Checks the frontier by brute force. Errors within 1% count as equal."""
    points = [(float(row["best_s"]), float(row["error_l2"]), row) for row in rows if row["status"] == "ok"]
    best = [(seconds, error) for seconds, error, row in points if row["frontier"] == "1"]
    for seconds, error, row in points:
        beaten = any(s <= seconds and e <= 1.01 * error and (s, e) != (seconds, error) for s, e in best)
        check(beaten == (row["frontier"] == "0"), f"frontier: {row}")


def check_picture(path):
    with open(path, encoding="utf-8") as file:
        text = " ".join(re.findall(r"<text[^>]*>([^<]*)</text>", file.read()))
    for words in ("unstable: gas1 flip", "gas2 flip, order 2.0", "usl apic, order", "frontier", "scene.yaml to time 1",
                  "basis linear, ppc 2, k 0.5", "1 rank"):
        check(words in text, f"{path}: no '{words}' in {text}")


def runs_of(path):
    records = [json.loads(line) for line in lines_of(path)[1:]]
    return [(record["cells"], record["formulation"], record["round"]) for record in records]


def stop_after(count, how, command, path):
    """Starts the script and ends it after so many more runs."""
    before = len(lines_of(path)) if os.path.exists(path) else 1
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([sys.executable, SCRIPT, *command], **quiet) as process:
        while process.poll() is None and (not os.path.exists(path) or len(lines_of(path)) < before + count):
            time.sleep(0.02)
        process.send_signal(how)
    return process.returncode


def check_resume():
    command = "scene.yaml --cells 8,16 --formulation gas2,usl --courant 0.5 --repeats 4 --most 4 -o again".split()
    path = "again.runs.jsonl"
    check(stop_after(3, signal.SIGINT, command, path) == 130, "SIGINT: not 130")
    check(os.path.exists("again.csv"), "SIGINT: what there is is not written")
    first = lines_of(path)
    check(stop_after(3, signal.SIGKILL, command, path) == -signal.SIGKILL, "SIGKILL: another status")
    check(len(lines_of(path)) < 17, "all runs were done before the script was killed: this tests nothing")
    with open(path, "a", encoding="utf-8") as file:
        file.write('{"formulation": "ga')  # cut off
    done = start(*command)
    check(done.returncode == 0, f"resumed: {done.stderr}")
    check(lines_of(path)[: len(first)] == first, "runs that were done are not as they were")
    runs = runs_of(path)
    check(len(runs) == 16 and len(set(runs)) == 16, f"not each of 16 runs once: {sorted(runs)}")
    check(all(row["repeats"] == "4" for row in rows_of("again.csv")), "not all repeats are there")
    orders = [[run[:2] for run in runs if run[2] == number] for number in range(1, 5)]
    check(len(set(map(tuple, orders))) > 2, f"every round has the same order: {orders}")
    check([run[2] for run in runs] == sorted(run[2] for run in runs), "rounds are not one after another")
    whole = lines_of(path)
    start(*command)
    check(lines_of(path) == whole, "a second start of what is done has run something")


def one_line(done, status, words):
    """The script must have ended in one line and left nothing half written."""
    check_one_line(done, words, words, status)
    check(not glob.glob("*.part"), "a .part is left")


def disturbed(name, text):
    """Makes a program that runs the shell commands of text and then mpmstab. Returns an environment that names it."""
    with open(name, "w", encoding="ascii") as file:
        file.write(f'#!/bin/sh\n{text}\nexec {PROGRAM} "$@"\n')
    os.chmod(name, 0o755)
    return {**os.environ, "MPMSTAB": os.path.abspath(name)}


def check_failed():
    """The same command must repeat runs that were killed, but not runs that the program refused."""
    environment = disturbed("killed.sh", 'case "$*" in *"-time "*) if [ -e kill ]; then kill -9 $$; fi;; esac')
    command = ["scene.yaml", "--cells", "8", "--transfer", "flip,apic", *ONCE, "--repeats", "2", "-o", "failed"]
    open("kill", "w", encoding="ascii").close()
    for left in glob.glob("failed.*"):
        os.remove(left)
    done = start(*command, env=environment)
    check(done.returncode == 2 and "no combination runs" in done.stderr, f"all are killed: {done.stdout} {done.stderr}")
    check(not glob.glob("failed.csv") and not glob.glob("failed.png"), "a table and a picture of no run are written")
    os.remove("kill")
    done = start(*command, env=environment)
    check(done.returncode == 0, f"not killed any more: {done.stdout} {done.stderr}")
    check([(row["status"], row["repeats"]) for row in rows_of("failed.csv")] == [("ok", "2"), ("refused", "0")],
          f"{rows_of('failed.csv')}")
    whole = lines_of("failed.runs.jsonl")
    start(*command, env=environment)
    check(lines_of("failed.runs.jsonl") == whole, "what is refused is run again")


def check_disturbances():
    """Checks Ctrl-C while the scene is read, a full disk, and two scripts at once."""
    environment = disturbed("slow.sh", "touch begun; exec sleep 60")
    with subprocess.Popen([sys.executable, SCRIPT, "scene.yaml", "-o", "slow"], env=environment, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        while not os.path.exists("begun"):
            time.sleep(0.02)
        process.send_signal(signal.SIGINT)
        said = process.communicate()
    os.remove("begun")
    one_line(subprocess.CompletedProcess([], process.returncode, *said), 130, "work_precision.py: interrupted")

    environment = disturbed("free.sh", "ulimit -S -f unlimited")
    command = ["scene.yaml", "--cells", "8,16", *ONCE, "--repeats", "2", "-o", "disk"]
    for size, name in ((700, "disk.runs.jsonl"), (20000, "disk.png")):
        done = start(*command, env=environment,
                     preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY)))
        one_line(done, 2, f"{name}: File too large")
        check(not os.path.exists("disk.png"), "half a picture")
    check(start(*command, env=environment).returncode == 0, "there is space again")
    with open("disk.runs.jsonl", "a", encoding="ascii") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        one_line(start(*command), 2, "disk.runs.jsonl is being written by another")


def check_refusals():
    with open("other.yaml", "w", encoding="ascii") as file:
        file.write(SCENE + "ppc: 3\n")
    with open("random.yaml", "w", encoding="ascii") as file:
        file.write("initial: random\n")
    for arguments, words in ((["other.yaml", "-o", "again"], "runs of another scene"),
                             (["scene.yaml", "-o", "again", "--time", "2"], "runs of another time"),
                             (["random.yaml", "-o", "no"], "no exact solution"),
                             (["none.yaml", "-o", "no"], "no such file"),
                             (["scene.yaml", "--cells", "12,x"], "--cells"),
                             (["scene.yaml", "--courant", "-1"], "--courant"),
                             (["scene.yaml", "--formulation", "gas3", "-o", "typo"], "gas3")):
        done = start(*arguments)
        said = done.stderr + done.stdout
        check(done.returncode == 2 and words in said, f"{arguments}: {done.returncode} {said}")
        check(len(done.stderr.splitlines()) == 1, f"{arguments}: {said}")


def synthetic(formulation, cells, error, loops, **more):
    base = {"formulation": formulation, "basis": "linear", "transfer": "flip", "ppc": 2, "courant": 0.5, "cells": cells,
            "ranks": 1, "drift": 0, "steps": 1, "time": 1.0, "particles": 2 * cells, "verdict": "stable", "growth": 1.0,
            "status": "ok", "note": None, "error": {"u": {"l1": error, "l2": error, "linf": error}}}
    return [{**base, "loop_s": loop, "round": number + 1, **more} for number, loop in enumerate(loops)]


def check_words():
    """Times are 1e-5 n^2 and errors n^-2, so an error of 1e-3 takes 1e-2 s. Close competitors must be named as such."""
    records = []
    for cells in (16, 64):
        records += synthetic("a", cells, cells**-2.0, [1e-5 * cells**2, 1.2e-5 * cells**2, 1.3e-5 * cells**2])
        records += synthetic("b", cells, cells**-2.0, [1.1e-5 * cells**2, 1.3e-5 * cells**2, 1.3e-5 * cells**2])
        records += synthetic("c", cells, cells**-1.0, [1e-6 * cells**2] * 3)
        records += synthetic("d", cells, cells**-8.0, [1e-7 * cells**2] * 3, status="unstable")
    rows = make_rows(records, [record for record in records if record["round"] == 1])
    point = cheapest_of([row for row in rows if row["formulation"] == "a"], 1e-3)
    check(abs(point["best_s"] - 1e-2) < 1e-12 and abs(point["median_s"] - 1.2e-2) < 1e-12, f"{point}")
    between = "(interpolated between 16 and 64 cells)"
    for wanted, words in ((1e-3, f"for error 0.001 the cheapest here is a: 10 ms {between}\n"
                                 f"  next b: 11 ms {between}, 1.1 times as long; no difference to the one before beyond the "
                                 "scatter of 3 rounds"),
                          (0.05, f"for error 0.05 the cheapest here is c: 400 us {between}"),
                          (0.05, "next a with 16 cells: 2.56 ms (its coarsest grid, so perhaps less), 6.4 times"),
                          (1e-4, "error 0.0001: nothing that is stable reaches it here; the smallest is 0.000244, "
                                 "by a with 64 cells in 41 ms")):
        check(words in answer(rows, wanted), f"no '{words}' in\n{answer(rows, wanted)}")
    orders = {(row["formulation"], row["cells"]): row["order"] for row in rows}
    check(abs(orders["b", 64] - 2) < 1e-12 and abs(orders["c", 64] - 1) < 1e-12, f"{orders}")
    check(orders["d", 64] is None, "an unstable family has an order")


def check_gaps():
    """Checks errors and times that are not monotonic: nothing is interpolated across unstable rows."""
    def said(wanted, *families):
        records = [record for name, points in families for cells, error, loop, status in points
                   for record in synthetic(name, cells, error, [loop], status=status)]
        return answer(make_rows(records, records), wanted)

    slower = ("a", [(16, 0.5, 2e-3, "ok"), (32, 0.009, 1e-2, "ok"), (64, 0.005, 4e-3, "ok")])
    check("cheapest here is a linear flip with 64 cells: 4 ms" in said(1e-2, slower), said(1e-2, slower))
    gap = ("a", [(16, 0.5, 2e-3, "ok"), (32, 0.09, 4e-3, "unstable"), (64, 0.005, 8e-3, "ok")])
    check("cheapest here is a linear flip with 64 cells: 8 ms" in said(1e-2, gap), said(1e-2, gap))
    first = ("a", [(16, 0.5, 2e-3, "unstable"), (64, 0.005, 8e-3, "ok")])
    check("coarsest" not in said(1e-2, first) and "a linear flip with 64 cells: 8 ms" in said(1e-2, first), said(1e-2, first))
    near = ("a", [(16, 0.02, 1e-3, "ok"), (32, 0.0199, 2e-3, "ok")])
    check("the smallest is 0.0199, by a linear flip with 32 cells" in said(1e-2, near), said(1e-2, near))


def check_certainty():
    """Six rounds of six make an order certain, five of six do not, and of twelve it takes ten."""
    def rows_with(*loops):
        records = [record for name, times in zip("abc", loops) for record in synthetic(name, 16, 1e-3, times)]
        return make_rows(records, [record for record in records if record["round"] == 1])

    slow = [2e-2 + 1e-3 * (number % 3) for number in range(12)]
    for count, wins, certain in ((6, 6, True), (6, 5, False), (12, 10, True), (12, 9, False), (5, 5, False)):
        fast = [1e-2] * wins + [1e-1] * (count - wins)
        rows = rows_with(fast, slow[:count])
        left = {row["formulation"] for row in uncertain_rows(rows, 1e-3)}
        check(left == (set() if certain else {"a", "b"}), f"{wins} of {count} rounds: {left} are uncertain")
        check(("beyond the scatter" in answer(rows, 1e-3)) is not certain, answer(rows, 1e-3))
    left = {row["formulation"] for row in uncertain_rows(rows_with([1e-2] * 6, slow[:6], slow[:6]), 1e-3)}
    check(left == {"b", "c"}, f"only b and c are equal, but {left} are uncertain")
    done = start("scene.yaml", "--cells", "8,16", "--formulation", "gas1,gas2,usf", "--courant", "0.5", "--repeats", "1",
                 "--most", "3", "--error", "1", "-o", "most")
    check(done.returncode == 0, f"{done.stdout} {done.stderr}")
    repeats = {(row["formulation"], row["cells"]): row["repeats"] for row in rows_of("most.csv")}
    check(repeats["gas1", "8"] == "1" and "3" in (repeats["gas2", "8"], repeats["usf", "8"]), f"{repeats}")


def check_search():
    """Without --courant a scheme runs up to 0.95 of its limit, and particles keep their velocity."""
    with open("move.yaml", "w", encoding="ascii") as file:
        file.write("formulation: usl\nbasis: quadratic\ncells: 16\ncourant: 0.5\ndrift: 1/8\ntime: 0.5\n")
    done = start("move.yaml", "--formulation", "usl,musl", "--repeats", "1", "--most", "1", "--error", "1", "-o", "move")
    check(done.returncode == 0, f"{done.stdout} {done.stderr}")
    rows = rows_of("move.csv")
    for formulation, limit in (("usl", 1.35), ("musl", 2.39525)):
        courants = sorted(float(row["courant"]) for row in rows if row["formulation"] == formulation)
        check(len(courants) == 5 and 0.85 * limit < courants[-1] <= 0.95 * limit, f"{formulation}: {courants}")
    for row in rows:
        check(float(row["drift"]) == float(row["courant"]) / 4, f"another velocity: {row}")
    check(len([line for line in done.stdout.splitlines() if line.startswith("usl ")]) < 5 and
          "makes needless" in done.stdout, f"all rows are printed:\n{done.stdout}")


def check_remarks():
    """Remarks must name errors that fall with an order below 0.5, and medians over 1.25 times the best, no others."""
    records = []
    for cells in (16, 32):
        records += synthetic("slow", cells, cells**-0.45, [1e-2, 1.3e-2, 1.3e-2])
        records += synthetic("falls", cells, cells**-0.55, [1e-2, 1.2e-2, 1.2e-2])
    said = "\n".join(remarks(make_rows(records, [record for record in records if record["round"] == 1])))
    check("slow: the error falls slowly" in said and "(order 0.45 at 32 cells)" in said and "falls:" not in said, said)
    check("above the best in 2 of 4 rows, so the machine was not quiet" in said, said)


def check_crosses():
    """An unstable run must be drawn at its error, or at the top when it is far beyond the others."""
    records = synthetic("a", 16, 1e-2, [1e-2]) + synthetic("b", 16, 1e-3, [1e-2], status="unstable")
    records += synthetic("c", 16, 5.0, [2e-2], status="unstable") + synthetic("a", 32, 1e-3, [2e-2])
    crosses, = [line for line in draw(make_rows(records, records), "made up").axes[0].lines if line.get_marker() == "X"]
    check(list(crosses.get_ydata()) == [1e-3, 2e-2], f"crosses at {crosses.get_ydata()}")


def check_all_waves():
    """A smooth run of musl that drifts shows no growth, but its symbol does."""
    with open("drift.yaml", "w", encoding="ascii") as file:
        file.write("formulation: musl\ncells: 16\ndrift: 1/8\ntime: 1\n")
    start("drift.yaml", *ONCE, "--repeats", "1", "-o", "drift")
    row, = rows_of("drift.csv")
    check(row["verdict"] != "unstable" and row["status"] == "unstable" and row["frontier"] == "0", f"{row}")
    check(abs(float(row["growth_all_waves"]) - 1.027) < 1e-3, f"{row}")


def check_plane():
    """In the plane both directions are refined together. A plane wave along x has the errors of one dimension."""
    with open("plane.yaml", "w", encoding="ascii") as file:
        file.write("dim: 2\nformulation: usl\nbasis: quadratic\nstagger: true\ncells: 8,4\nlength: 2,1\ndrift: 1/8,0\n"
                   "mode: 1,0\ncourant: 0.5\ntime: 0.5\n")
    done = start("plane.yaml", "--cells", "8,16,32", "--transfer", "flip,apic", *ONCE, "--repeats", "1",
                 "-o", "plane")
    check(done.returncode == 0 and done.stderr == "", f"status {done.returncode}: {done.stderr}")
    rows = {(row["transfer"], int(row["cells"])): row for row in rows_of("plane.csv")}
    for (transfer, cells), row in rows.items():
        same = {"transfer": transfer, "time": 0.5}
        _, found, said = launch("run", "plane.yaml", {"cells": f"{cells},{cells // 2}", **same})
        errors = [error["l2"] for field, error in found["run"]["error"].items() if not field.startswith("c_")]
        check(float(row["error_l2"]) == max(errors), f"{row}: the program says {found['run']['error']} {said}")
        check((int(row["particles"]), row["dim"], row["drift"]) == (2 * cells * cells, "2", "0.125,0"), f"{row}")
        _, line, said = launch("run", options=dict(formulation="usl", basis="quadratic", stagger="true", cells=cells,
                                                   length=2, drift="1/8", courant=0.5, **same))
        along = max(error["l2"] for field, error in line["run"]["error"].items() if field != "c")
        check(abs(along - max(errors)) < 1e-9, f"{transfer}, {cells} cells: {max(errors)}, in a line {along} {said}")
    check(float(rows["apic", 32]["order"]) > 1, f"order {rows['apic', 32]['order']}")
    _, symbol, _ = launch("symbol", "plane.yaml", {"cells": "32,16"})
    check(float(rows["flip", 32]["growth_all_waves"]) == symbol["growth"], f"{rows['flip', 32]}, not {symbol}")
    for words in ("cells are counted along x, and the other directions are in proportion to 8 x 4", "cells along x"):
        check(words in done.stdout, f"no '{words}' in {done.stdout}")
    one_line(start("plane.yaml", "--cells", "8,9", "-o", "odd"), 2,
             "--cells 9: no grid in the proportion of 8 x 4 cells; allowed: multiples of 2")


def check_page():
    """Times of the study are interpolated, or never reached; they count steps, particles and iterations."""
    one_line(start("--page", "nothing"), 2, "nothing is no scene of the page; allowed: line-rest")
    one_line(start(), 2, "no scene; allowed: SCENE.yaml, --page, --check or --costs")
    row = {"scheme": "implicit", "transfer": "flip", "cells": 16, "steps": 10, "iterations": 0}
    one, ten = (precision_costs.seconds_of({**row, "iterations": many}, {"ppc": "2"}) for many in (1, 10))
    none = precision_costs.seconds_of(row, {"ppc": "2"})
    check(0 < none < one and abs(ten - none - 10 * (one - none)) < 1e-15, f"times {none}, {one}, {ten}")
    rows = [{"cells": cells, "seconds": 1e-5 * cells**2, "errors": [cells**-2.0, 2 * cells**-2.0]} for cells in (16, 64)]
    check(abs(precision_study.seconds_for(rows, 1e-3, min) - 1e-2) < 1e-12, "not interpolated")
    check(abs(precision_study.seconds_for(rows, 1e-3, max) - 2e-2) < 1e-12, "not that of the largest error")
    check(precision_study.seconds_for(rows, 1e-4, min) == math.inf, "extrapolated")


def main():
    for path in {*glob.glob("*.jsonl"), *glob.glob("disk.*"), *glob.glob("begun"), *glob.glob("kill")}:
        os.remove(path)
    with open("scene.yaml", "w", encoding="ascii") as file:
        file.write(SCENE)
    for one in (check_words, check_gaps, check_certainty, check_search, check_remarks, check_crosses, check_content, check_all_waves, check_plane,
                check_resume, check_failed, check_disturbances, check_refusals, check_page):
        one()


if __name__ == "__main__":
    main()
