#!/usr/bin/python3
"""Files under names aside: programs that write the same file, files of the user with such names, and what a kill leaves.

check_unfinished.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import glob
import json
import os
import signal
import subprocess
import sys
import tempfile
import time

from checks import check

MPIEXEC, MPMSTAB = sys.argv[1:]
LONG = "run -cells 3000 -steps 1000000000000 -output out.h5 -csv out.csv -json out.json".split()
SHORT = "run -cells 300 -steps 200 -output out.h5 -csv out.csv -json out.json -checkpoint c.h5 -checkpoint_every 10".split()
WITHIN = 30  # seconds, of which a busy machine may need many


def start(words, ranks=1):
    launch = [MPIEXEC, "-q", "-n", str(ranks)] if ranks > 1 else []
    return subprocess.Popen([*launch, MPMSTAB, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def finish(process):
    said = process.communicate(timeout=120)
    return process.returncode, "".join(said)


def wait_for_parts(process, count):
    end = time.monotonic() + WITHIN
    while len(glob.glob("*.part")) < count:
        check(process.poll() is None and time.monotonic() < end, f"no {count} files aside: {os.listdir('.')}")
        time.sleep(0.02)


def check_whole(names):
    import h5py
    for name in names:
        check(os.path.exists(name), f"{name} is not there")
        if name.endswith(".h5") and name != "c.h5":
            with h5py.File(name, "r") as file:
                check("step_0000000200" in file, f"{name} ends early")
    with open("out.json", encoding="ascii") as file:
        check(json.load(file)["run"]["steps"] == 200, "out.json is another run's")
    with open("out.csv", encoding="ascii") as file:
        check(file.read().splitlines()[-1].startswith("200,"), "out.csv ends early")
    status, said = finish(start(["run", "-cells", "300", "-steps", "210", "-restart", "c.h5"]))
    check(status == 0, f"the checkpoint of two writers: {said}")


def check_users_own():
    """Files that end in .part are the user's own."""
    with open("out.json.part", "w", encoding="ascii") as file:
        file.write("mine")
    status, said = finish(start(SHORT))
    check(status == 0, said)
    with open("out.json.part", encoding="ascii") as file:
        check(file.read() == "mine", "a file of the user was overwritten")


def check_two_writers():
    """Both end well and what they leave is whole; so does one beside a program that is refused."""
    for ranks in (1, 2):
        for _ in range(3):
            both = [start(SHORT, ranks), start(SHORT, ranks)]
            for process in both:
                status, said = finish(process)
                check(status == 0, f"one of two programs that write the same files: {status} {said}")
            check_whole(["out.h5", "out.xmf", "c.h5"])
    process = start(LONG)
    wait_for_parts(process, 3)
    parts = sorted(glob.glob("*.part"))
    status, said = finish(start(["run", "-cells", "300", "-output", "out.h5", "-csv", "out.csv", "-courant", "-1"]))
    check(status == 2, said)
    check(sorted(glob.glob("*.part")) == parts, f"a refused program removed one of {parts}: {glob.glob('*.part')}")
    process.terminate()
    finish(process)
    check(not glob.glob("*.part"), f"SIGTERM leaves {glob.glob('*.part')}")


def check_left():
    """A killed program's files are removed by the next one with the same names; others stay."""
    process = start(LONG)
    wait_for_parts(process, 3)
    process.send_signal(signal.SIGKILL)
    finish(process)
    parts = glob.glob("*.part")
    check(len(parts) >= 3, "a killed program has removed its files")
    alive = parts[0].replace(f"-{process.pid}-", f"-{os.getpid()}-")
    elsewhere = parts[0].replace(f"-{process.pid}-", f"x-{process.pid}-")
    for name in (alive, elsewhere):
        with open(name, "w", encoding="ascii"):
            pass
    status, said = finish(start(SHORT))
    check(status == 0, said)
    check(sorted(glob.glob("*.part")) == sorted([alive, elsewhere]), f"left: {glob.glob('*.part')}, not what others write")


for part in (check_users_own, check_two_writers, check_left):
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        part()
        os.chdir("/")
