#!/usr/bin/python3
"""A disk that is full: one line, status 2, nothing printed or left, and no rank that waits for another.

check_disk.py MPIEXEC MPMSTAB. Disks are small file systems in memory; where they cannot be mounted, which root alone
may do, the status is 77. Else silent when all is well.
"""
import contextlib
import os
import subprocess
import sys
import tempfile

from checks import check, on_ranks

MPMSTAB = sys.argv[-1]
SKIPPED = 77
TASKS = {"run": "run -cells 64 -steps 100 -output small/o.h5 -output_every 10", "map": "map -output small/o.h5",
         "symbol": "symbol -cells 4000 -output small/o.h5", "csv": "symbol -cells 8000 -csv small/o.csv",
         "checkpoint": "run -cells 4000 -steps 5 -checkpoint small/c.h5"}


def run(words, ranks=1):
    return on_ranks(ranks, MPMSTAB, *words, timeout=60)


def check_refused(done, what):
    said = done.stderr.splitlines()
    check(done.returncode == 2 and len(said) == 1 and said[0].startswith("mpmstab: ") and not done.stdout,
          f"{what}: status {done.returncode}: {done.stderr} {done.stdout}")


@contextlib.contextmanager
def small_disk(size):
    os.makedirs("small", exist_ok=True)
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "none", "small"], capture_output=True,
                             text=True, check=False)
    if mounted.returncode:
        print(f"skipped: a small disk cannot be mounted here: {mounted.stderr.strip()}")
        sys.exit(SKIPPED)
    try:
        yield
    finally:
        subprocess.run(["umount", "small"], check=True)


def check_disk():
    for size in (16, 56, 64, 80):
        with small_disk(size):
            for ranks in (1, 2):
                for name, task in TASKS.items():
                    done = run(task.split(), ranks)
                    check_refused(done, f"{name} on {ranks} ranks with {size} kB")
                    check("No space left on device" in done.stderr, done.stderr)
                    check(not os.listdir("small"), f"{name} leaves {os.listdir('small')}")


def check_two_files():
    """A disk that is full while two files are open: the second is not complained of at the end."""
    for size in (72, 80, 88, 96, 104):
        with small_disk(size):
            done = run("run -cells 200 -steps 50 -output small/o.h5 -checkpoint small/c.h5 -checkpoint_every 5 "
                       "-csv small/o.csv -json small/o.json".split())
            if done.returncode:
                check_refused(done, f"four files with {size} kB")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    check_disk()
    check_two_files()
    os.chdir("/")
