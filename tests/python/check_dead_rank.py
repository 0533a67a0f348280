#!/usr/bin/python3
"""Checks that a dead rank ends the job soon and with a message, and SIGTERM the program without a stack trace.

check_dead_rank.py MPIEXEC MPMSTAB. Silent when all is well.
"""
import glob
import os
import signal
import subprocess
import sys
import tempfile
import time

from checks import check

OPTIONS = "run -cells 3000 -steps 1000000000000 -output out.h5 -csv out.csv -json out.json".split()
WITHIN = 20  # seconds; it usually takes one or two, on a busy machine more


def parent_of(pid):
    """Returns the parent of a process, or None when the process does not exist or has ended."""
    try:
        with open(f"/proc/{pid}/stat") as file:
            state, parent = file.read().rpartition(")")[2].split()[:2]
    except OSError:
        return None
    return None if state == "Z" else int(parent)


def children(parent):
    return [int(pid) for pid in os.listdir("/proc") if pid.isdigit() and parent_of(pid) == parent]


def wait_for(condition, message):
    end = time.monotonic() + WITHIN
    while not condition():
        check(time.monotonic() < end, message)
        time.sleep(0.05)


def end_one(command, ranks, number, folder):
    """Sends a signal to the last of the processes that march; returns the status and the standard error."""
    with open(os.path.join(folder, "said"), "w+") as said:
        job = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=said)
        started = []
        try:
            part = os.path.join(folder, "out.csv.*.part")  # opened just before the first step
            wait_for(lambda: glob.glob(part) or job.poll() is not None, "the run does not start")
            check(job.poll() is None, f"{command} ended by itself")
            started = children(job.pid) if ranks > 1 else [job.pid]
            check(len(started) == ranks, f"{len(started)} processes, not {ranks}")
            os.kill(started[-1], number)
            wait_for(lambda: job.poll() is not None, f"the job goes on after signal {number} to one of {ranks} ranks")
            wait_for(lambda: all(parent_of(pid) is None for pid in started), "processes are left behind")
        finally:
            if job.poll() is None:
                job.kill()
            for pid in started:
                if parent_of(pid) is not None:
                    os.kill(pid, signal.SIGKILL)
        said.seek(0)
        left = sorted(os.listdir(folder))
        final = [name for name in ("out.h5", "out.xmf", "out.csv", "out.json") if name in left]
        check(not final, f"files that are not whole have their names: {final}")
        if ranks == 1 and number != signal.SIGKILL:
            check(left == ["said"], f"left behind by signal {number}: {left}")
        return job.returncode, said.read()


def main(mpiexec, mpmstab):
    for ranks, number in ((3, signal.SIGKILL), (2, signal.SIGTERM), (1, signal.SIGTERM), (1, signal.SIGHUP),
                          (1, signal.SIGINT), (1, signal.SIGXCPU), (1, signal.SIGQUIT), (2, signal.SIGQUIT)):
        launcher = [mpiexec, "-n", str(ranks)] if ranks > 1 else []
        with tempfile.TemporaryDirectory() as folder:
            status, said = end_one([*launcher, mpmstab, *OPTIONS], ranks, number, folder)
        case = f"signal {number.value} to one of {ranks} ranks: status {status}, stderr {said!r}"
        check(status % 256 == 128 + number or (ranks == 1 and status == -number), case)
        check(f"exited on signal {number.value}" in said if ranks > 1 else not said, case)
        check("PETSC" not in said and "MPI_ABORT" not in said, case)


if __name__ == "__main__":
    main(*sys.argv[1:3])
