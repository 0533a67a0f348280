#!/usr/bin/python3
"""What a shell may keep from the program: memory, standard output, a file of options that can be read.

check_shell_limits.py MPIEXEC MPMSTAB. Silent when all is well.
"""
import os
import resource
import subprocess
import sys
import tempfile

MPIEXEC, MPMSTAB = sys.argv[1:]


def check(condition, message):
    if not condition:
        sys.exit(f"check_shell_limits: {message}")


def run(words, ranks=1, **how):
    launch = [MPIEXEC, "-q", "-n", str(ranks)] if ranks > 1 else []
    return subprocess.run([*launch, MPMSTAB, *words], capture_output=True, text=True, check=False, timeout=60, **how)


def check_memory():
    """The least address space that a task starts with is not known; below it there is an answer too."""
    for megabytes in (600, 500, 450, 400, 370, 340):
        size = megabytes << 20
        done = run("symbol -cells 64".split(),
                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)))
        check(done.returncode in (0, 2) and "PETSC ERROR" not in done.stderr,
              f"{megabytes} MB: status {done.returncode}: {done.stderr}")
    size = 600 << 20
    done = run("spectrum -cells 1000 -measure false".split(),
               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)))
    check(done.returncode in (0, 2) and "PETSC ERROR" not in done.stderr,
          f"memory that ends within a task: status {done.returncode}: {done.stderr}")


def check_option_files():
    os.mkfifo(".petscrc")
    for ranks in (1, 2):
        done = run(["list"], ranks)
        check(done.returncode == 2 and done.stderr.count(
            "mpmstab: .petscrc: PETSc looks for options there, and it is not a regular file") == 1, done.stderr)
    check(run(["list"], env={**os.environ, "HOME": os.getcwd()}).returncode == 2, "~/.petscrc")
    os.remove(".petscrc")


def check_closed_output():
    done = subprocess.run(f"exec {MPMSTAB} list >&-", shell=True, stderr=subprocess.PIPE, text=True, check=False)
    check(done.returncode == 1 and done.stderr == "mpmstab: standard output cannot be written: the report is lost\n",
          f"without standard output: {done.returncode} {done.stderr}")
    done = subprocess.run(f"exec {MPMSTAB} run -steps 2 -json o.json <&- 2>&-", shell=True, stdout=subprocess.PIPE,
                          text=True, check=False)
    check(done.returncode == 0 and "verdict" in done.stdout, f"without standard input and error: {done.returncode}")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    for part in (check_memory, check_option_files, check_closed_output):
        part()
    os.chdir("/")
