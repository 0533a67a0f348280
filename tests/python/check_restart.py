#!/usr/bin/python3
"""A checkpoint is enough by itself: whatever a signal has left beside it, the run resumes, also at its last step.

check_restart.py MPIEXEC MPMSTAB. Silent when all is well.
"""
import glob
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

from checks import check

MPIEXEC, MPMSTAB = sys.argv[1:]
FILES = "-output out.h5 -csv out.csv -json out.json -checkpoint c.h5 -checkpoint_every 20".split()
SCENE = "run -cells 300 -courant 0.2 -drift 0.3".split()


def start(ranks, *words):
    launch = [MPIEXEC, "-q", "-n", str(ranks)] if ranks > 1 else []
    return subprocess.Popen([*launch, MPMSTAB, *SCENE, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                            text=True)


def run(ranks, *words):
    process = start(ranks, *words)
    said = process.communicate(timeout=120)
    return process.returncode, said[0], said[1]


def children(pid):
    with open(f"/proc/{pid}/task/{pid}/children", encoding="ascii") as file:
        return [int(child) for child in file.read().split()]


def is_alive(pid):
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii") as file:
            return file.read().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


def check_signals(ranks):
    """SIGTERM, SIGTERM, SIGKILL to what was started, each resumed from the checkpoint that is there."""
    for number in (signal.SIGTERM, signal.SIGTERM, signal.SIGKILL):
        restart = ["-restart", "c.h5"] if os.path.exists("c.h5") else []
        before = os.stat("c.h5").st_mtime_ns if restart else 0
        process = start(ranks, "-steps", "100000000", *FILES, *restart)
        end = time.monotonic() + 60
        while not os.path.exists("c.h5") or os.stat("c.h5").st_mtime_ns == before:
            check(process.poll() is None, f"the run on {ranks} ranks ends by itself")
            check(time.monotonic() < end, "no checkpoint")
            time.sleep(0.02)
        marching = children(process.pid)
        process.send_signal(number)
        errors = process.communicate(timeout=60)[1]
        check("PETSC ERROR" not in errors, f"a trace after signal {number}: {errors}")
    while any(is_alive(pid) for pid in marching):  # ranks whose mpirun was killed notice it after a while
        check(time.monotonic() < end + 60, "ranks march on without mpirun")
        time.sleep(0.05)
    status, said, errors = run(ranks, "-steps", "100000000", "-cells", "200", *FILES, "-restart", "c.h5")
    check(status == 2, "a checkpoint of other cells is taken")
    import h5py
    with h5py.File("c.h5", "r") as file:
        at = int(file["where"][0])
    status, said, errors = run(ranks, "-steps", str(at + 40), *FILES, "-restart", "c.h5")
    check(status == 0, f"{ranks} ranks do not resume at step {at}: {status} {said} {errors}")
    left = [name for name in os.listdir(".") if name.endswith((".part", ".lock"))]
    check(not left, f"left beside a finished run: {left}")


def check_last_step(ranks):
    """What a checkpoint of the last step says is done is there; what was lost since is made again."""
    status, said, errors = run(ranks, "-steps", "100", *FILES)
    check(status == 0, said + errors)
    with open("out.csv", encoding="ascii") as file:
        rows = file.read()
    size = os.path.getsize("out.h5")
    os.remove("out.csv")
    os.remove("out.json")
    again = ["-steps", "100", *FILES, "-restart", "c.h5"]
    status, said, errors = run(ranks, *again)
    check(status == 0, f"at the last step: {status} {said} {errors}")
    for text in ("the checkpoint c.h5 is of the last step, 100: nothing is left to march",
                 "out.h5 has step 100 already and is left as it is", "verdict: "):
        check(text in said, f"'{text}' is not said: {said}")
    check(not re.search(r"\b(nan|inf)\b", said), f"a number that was not computed: {said}")
    with open("out.csv", encoding="ascii") as file:
        check(file.read() == rows, "the CSV is another")
    check(os.path.exists("out.json") and os.path.getsize("out.h5") == size, "the JSON is missing or the output is another")
    os.remove("out.h5")
    status, said, errors = run(ranks, *again)
    check(status == 0 and os.path.exists("out.h5") and "is left as it is" not in said, f"no output: {said} {errors}")


def check_no_rows(ranks):
    """A checkpoint of a run without CSV serves one with it."""
    status, said, errors = run(ranks, "-steps", "100", "-checkpoint", "c.h5")
    check(status == 0, said + errors)
    status, said, errors = run(ranks, "-steps", "130", "-csv", "new.csv", "-restart", "c.h5")
    check(status == 0 and "new.csv begins after step 100: the checkpoint holds no earlier rows" in said,
          f"{status} {said} {errors}")
    with open("new.csv", encoding="ascii") as file:
        check(file.read().splitlines()[1].startswith("101,"), "rows do not begin after the checkpoint")


def check_order():
    """The outputs have their names before the last checkpoint has its own."""
    status, said, errors = run(1, "-steps", "100", *FILES)
    check(status == 0, said + errors)
    last = os.stat("c.h5").st_mtime_ns
    for name in ("out.h5", "out.xmf", "out.csv"):
        check(os.stat(name).st_mtime_ns <= last, f"{name} was written after the checkpoint of the last step")
    check(not glob.glob("*.part"), "files aside are left")


for part, number in ((check_signals, 1), (check_signals, 2), (check_last_step, 1), (check_last_step, 2),
                     (check_last_step, 3), (check_no_rows, 1), (check_no_rows, 2), (check_order, None)):
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        part(*([number] if number else []))
        os.chdir("/")
