#!/usr/bin/python3
"""Kills runs at random moments and resumes them from their checkpoints; then offers files that are no checkpoints.

check_checkpoint.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import glob
import json
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time

import h5py
import numpy as np

from checks import check

TRIAL, CHECKPOINTS, KILLS = 20000, 100, 4
SCENE = {"-formulation": "gas2", "-cells": "500", "-courant": "0.2", "-drift": "0.3", "-jitter": "0.5",
         "-steps": str(TRIAL)}
MPIEXEC, MPMSTAB = sys.argv[1:]
# After a refusal mpirun would give the ranks a second to end. After a signal they need it.
AT_ONCE = {**os.environ, "OMPI_MCA_odls_base_sigkill_timeout": "0"}


def command(ranks, *more):
    launch = [MPIEXEC, "-q", "-n", str(ranks)] if ranks > 1 else []
    options = {**SCENE, **dict(zip(more[::2], more[1::2]))}
    return [*launch, MPMSTAB, "run", *(word for option in options.items() for word in option)]


def finish(process):
    said = process.communicate(timeout=120)
    return process.returncode, said[0].decode(), said[1].decode()


def start(ranks, *more, **how):
    return subprocess.Popen(command(ranks, *more), stdout=subprocess.PIPE, stderr=subprocess.PIPE, **how)


def remove(*names):
    for name in names:
        if os.path.exists(name):
            os.remove(name)


def ranks_of(process):
    """Returns the processes of the program: the children of mpirun, or the process itself."""
    with open(f"/proc/{process.pid}/task/{process.pid}/children", encoding="ascii") as children:
        return [int(pid) for pid in children.read().split()] or [process.pid]


def stamp(path):
    return os.stat(path).st_mtime_ns if os.path.exists(path) else 0


def wait_for_another(path, process):
    """Waits until there is a newer checkpoint, or the run is over."""
    before = stamp(path)
    while stamp(path) == before and process.poll() is None:
        time.sleep(0.001)


def result(name):
    """Returns what a run has found, without its times."""
    with open(name + ".json", encoding="ascii") as file:
        found = json.load(file)
    # A resumed run counts changes of mass from where it resumed.
    run = {key: value for key, value in found["run"].items() if not key.endswith(("_s", "_step", "_change"))}
    with open(name + ".csv", encoding="ascii") as file:
        return run, found["verdict"], file.read()


def files(name):
    return ["-json", name + ".json", "-csv", name + ".csv"]


def kill(ranks, how, seconds):
    """Ends a run of about so many seconds by a signal, again and again. At last it must find what a whole run finds.

    Returns how often the run was ended.
    """
    SCENE["-steps"] = str(TRIAL)
    for trial in (True, False): # the first shows how many steps take so many seconds
        status, said, errors = finish(start(ranks, *files("whole")))
        check(status == 0, f"the uninterrupted run: {said}{errors}")
        with open("whole.json", encoding="ascii") as file:
            found = json.load(file)["run"]
        if trial:
            SCENE["-steps"] = str(int(TRIAL * seconds / found["loop_s"]))
    every = str(int(SCENE["-steps"]) // CHECKPOINTS)
    remove("c.h5", "parts.json", "parts.csv")
    kills = 0
    while kills < KILLS:
        restart = ["-restart", "c.h5"] if os.path.exists("c.h5") else []
        process = start(ranks, "-checkpoint", "c.h5", "-checkpoint_every", every, *restart, *files("parts"))
        wait_for_another("c.h5", process)
        time.sleep(random.uniform(0, 0.05))
        victims = ranks_of(process) if process.poll() is None else []
        if how == signal.SIGTERM:
            victims = [process.pid]
        if victims:
            try:
                os.kill(random.choice(victims), how)
            except ProcessLookupError:
                pass
        status, said, errors = finish(process)
        check("PETSC ERROR" not in errors, f"a stack trace: {errors}")
        if os.path.exists("parts.json"): # it was killed when all was done
            break
        if how == signal.SIGTERM and ranks == 1 and status != -how: # before the march it ends without a word
            check(status == 143 and "to go on: the same command with -restart c.h5" in said,
                  f"SIGTERM: {status} {said}")
        kills += 1
    if not os.path.exists("parts.json"):
        check(os.path.exists("c.h5"), f"no checkpoint after {kills} runs")
        status, said, errors = finish(start(ranks, "-checkpoint", "c.h5", "-restart", "c.h5", *files("parts")))
        check(status == 0, f"going on after {kills} kills: {said}{errors}")
    check(result("whole") == result("parts"), f"on {ranks} ranks, after {kills} kills, the result is another")
    return kills


def check_killed(ranks, how):
    """Tries longer runs when one is over before it is killed, as on a machine whose speed changes."""
    check(any(kill(ranks, how, seconds) for seconds in (2, 4, 8)), f"no run on {ranks} ranks could be killed")


def check_refused(path, message, *more):
    for ranks in (1, 2):
        status, _, errors = finish(start(ranks, "-restart", path, *more, env=AT_ONCE))
        times = errors.count(f"mpmstab: {message}")
        check(status == 2 and times == 1 and "PETSC" not in errors, f"-restart {path}: status {status}: {errors!r}, "
              f"expected 2 and once: {message}")


def check_refusals():
    status, said, errors = finish(start(1, "-checkpoint", "good.h5", "-steps", "50"))
    check(status == 0, said + errors)
    good = open("good.h5", "rb").read()

    def bad(name, content):
        with open(name, "wb") as file:
            file.write(content)

    bad("short.h5", good[:-100])
    bad("cut.h5", good[:300])
    bad("empty.h5", b"")
    bad("text.h5", b"formulation: gas2\n" * 100)
    bad("newer.h5", good.replace(b"format 1\n", b"format 9\n", 1))
    bad("flipped.h5", good[:5000] + bytes([good[5000] ^ 1]) + good[5001:])
    with h5py.File("foreign.h5", "w") as file:
        file["pid"] = [1.0, 2.0]
    check_refused("short.h5", "checkpoint short.h5: damaged: it has ")
    check_refused("cut.h5", "checkpoint cut.h5: damaged: it has 300 bytes of ")
    check_refused("empty.h5", "checkpoint empty.h5: not a checkpoint; allowed: one that 'mpmstab run -checkpoint'")
    check_refused("text.h5", "checkpoint text.h5: not a checkpoint")
    check_refused("foreign.h5", "checkpoint foreign.h5: not a checkpoint")
    check_refused("newer.h5", "checkpoint newer.h5: of format 9, where this program reads format 1")
    check_refused("flipped.h5", "checkpoint flipped.h5: damaged: its bytes do not have the checksum that it was written with")
    check_refused("missing.h5", "checkpoint missing.h5: cannot be read: No such file or directory")
    check_refused(".", "checkpoint .: cannot be read: Is a directory")
    if not os.path.exists("pipe.h5"):
        os.mkfifo("pipe.h5")
    check_refused("pipe.h5", "checkpoint pipe.h5: cannot be read: not a regular file")
    check_refused("good.h5", "checkpoint good.h5: its jitter is 0.5, the scene's is 0.25; allowed: the scene that it "
                  "is of", "-jitter", "0.25")
    check_refused("good.h5", "checkpoint good.h5: its drift is 3/10, the scene's is 1/3", "-drift", "1/3")
    check_refused("good.h5", "checkpoint good.h5: is at step 50 of 49; allowed: as many steps or more", "-steps", "49")
    status, said, errors = finish(start(1, "-checkpoint", "series.h5", "-csv", "series.csv", "-steps", "50"))
    check(status == 0, said + errors)
    check_refused("series.h5", "restart series.h5: its CSV has other columns; allowed: weights, source_term, ringing "
                  "and tangent as before", "-steps", "60", "-csv", "other.csv", "-source_term", "true")


def sum_up(path):
    """Writes the right checksum into a changed file (src/io/checkpoint_check.c)."""
    with open(path, "rb") as file:
        content = file.read()
    word = np.frombuffer(content[512:] + bytes(-len(content) % 8), dtype="<u8")
    z = word + np.arange(1, len(word) + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z ^= z >> np.uint64(31)
    text = f"mpmstab checkpoint\nformat 1\nbytes {len(content)}\nsum {int(z.sum()):x}\n".encode()
    with open(path, "wb") as file:
        file.write(text.ljust(512, b"\0") + content[512:])


def check_made():
    """Offers whole files that no run has written, to one rank and to two; tests/fuzz has more of them."""
    shutil.copy("good.h5", "other.h5")
    sum_up("other.h5")
    with open("good.h5", "rb") as good, open("other.h5", "rb") as other:
        check(good.read() == other.read(), "the checksum made here is not the program's")
    for message, name, index, value in (
            ("its particles are at another step", "where", 1, 2**63 - 1),
            ("its exponent is none that so many steps lead to", "where", 3, 2**32),
            ("its series has a number that is no logarithm of a norm", "series_grid", 3, float("nan")),
            ("its ranks' particles do not add up to the scene's", "rank_particles", 0, -1),
            ("its particles are not those of the scene", "DMSwarm_pid", 7, 2**63 - 1),
            ("its particles are where none can be", "cell", 0, -2**63),
            ("its state has numbers out of range", "u", 9, 1e200)):
        shutil.copy("good.h5", "other.h5")
        with h5py.File("other.h5", "r+") as file:
            file[name][index] = value
        sum_up("other.h5")
        check_refused("other.h5", f"checkpoint other.h5: {message}; allowed: one that 'mpmstab run' has written")


def check_full_disk():
    """Checks that the earlier checkpoint stays when the disk is full. A limit on the size of files acts like one.

    It runs on one rank, and the limit is no smaller, since MPI needs such files to start.
    """
    shutil.copy("good.h5", "kept.h5")

    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (8 << 20, 8 << 20))

    status, _, errors = finish(start(1, "-checkpoint", "kept.h5", "-cells", "400000", "-steps", "2", preexec_fn=limit))
    check(status == 2 and errors.count("mpmstab: checkpoint kept.h5 of step 2: cannot be written: File too large") == 1 and
          "PETSC" not in errors, f"no room on the disk: status {status}: {errors!r}")
    check(not glob.glob("kept.h5.*"), "half a checkpoint is left")
    with open("good.h5", "rb") as good, open("kept.h5", "rb") as kept:
        check(good.read() == kept.read(), "the checkpoint that was there is another")


for r in (1, 2):
    check_killed(r, signal.SIGKILL)
    check_killed(r, signal.SIGTERM)
check_refusals()
check_made()
check_full_disk()
