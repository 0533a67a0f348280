#!/usr/bin/python3
"""What a shell may keep from the program: memory, standard output, a file of options that can be read.

check_shell_limits.py MPIEXEC MPMSTAB. Silent when all is well.
"""
import os
import resource
import subprocess
import sys
import tempfile

from checks import check

MPMSTAB = sys.argv[-1]


def run(words, ranks=1, **how):
    """By no fork of another program: what a shell hands over is what is tried here."""
    launch = [sys.argv[-2], "-q", "-n", str(ranks)] if ranks > 1 else []
    return subprocess.run([*launch, MPMSTAB, *words], capture_output=True, text=True, check=False, timeout=60, **how)


def check_memory():
    """The least address space that a task starts with is not known; below it there is an answer too."""
    for megabytes in (600, 500, 450, 400, 370, 340):
        size = megabytes << 20
        done = run("symbol -cells 64".split(),
                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)))
        check(done.returncode in (0, 2) and "PETSC ERROR" not in done.stderr,
              f"{megabytes} MB: status {done.returncode}: {done.stderr}")
    for megabytes in range(500, 560, 10):  # the particles' arrays do not fit, or not when PETSc enlarges them
        size = megabytes << 20
        done = run("run -cells 3000000 -steps 1".split(),
                   preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)))
        check(done.returncode in (0, 2) and done.stderr.count("\n") == (done.returncode == 2),
              f"{megabytes} MB for particles: status {done.returncode}: {done.stderr}")
    size = 600 << 20
    done = run("spectrum -cells 1000 -measure false".split(),
               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)))
    check(done.returncode in (0, 2) and "PETSC ERROR" not in done.stderr,
          f"memory that ends within a task: status {done.returncode}: {done.stderr}")


def check_start():
    """Less than MPI or LAPACK starts with is refused in our own words, on one rank of those that a launcher starts too."""
    for megabytes in (165, 180, 220, 260, 300, 330):
        size = megabytes * 1000 << 10
        for words in ("list", "symbol -cells 64", "critical gas2"):
            done = run(words.split(), preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)))
            if done.returncode == 127:  # the system cannot load the program
                continue
            check(done.returncode == 2 and not done.stdout and done.stderr.count("\n") == 1 and done.stderr.startswith(
                "mpmstab: memory: the shell grants too little to start with (ulimit -v); allowed: 0."),
                f"{words} with {megabytes} MB: status {done.returncode}: {done.stderr}")
    size = 300 << 20
    done = run(["list"], 2, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (size, size)))
    check(done.returncode == 2 and done.stderr.count("mpmstab: memory: ") == 1, f"two ranks: {done.stderr}")


def check_own_output():
    """The pipe or terminal that takes the report is no scene; standard input is one."""
    for ranks in (1, 2):
        for name in ("/dev/stdout", "/dev/stderr"):
            done = run(["run", name], ranks)
            check(done.returncode == 2 and done.stderr.count(f"mpmstab: scene {name}: Resource deadlock avoided") == 1,
                  f"the scene {name} on {ranks} ranks: status {done.returncode}: {done.stderr}")
    done = run(["run", "/dev/stdin", "-steps", "2"], input="cells: 4\n")
    check(done.returncode == 0 and "4 cells" in done.stdout, f"a scene from standard input: {done.stderr}")


def check_option_files():
    os.mkfifo(".petscrc")
    for ranks in (1, 2):
        done = run(["list"], ranks)
        check(done.returncode == 2 and done.stderr.count(
            "mpmstab: .petscrc: PETSc looks for options there, and it is not a regular file") == 1, done.stderr)
    check(run(["list"], env={**os.environ, "HOME": os.getcwd()}).returncode == 2, "~/.petscrc")
    os.rename(".petscrc", "pipe")
    with open("large", "wb") as file:
        file.truncate(2**21)
    for name, says in (("pipe", "not a regular file"), ("/dev/zero", "not a regular file"), ("large", "larger than 1 MiB")):
        for ranks in (1, 2):
            done = run(["run", "-options_file", name], ranks)
            check(done.returncode == 2 and done.stderr.count(
                f"mpmstab: {name}: PETSc looks for options there, and it is {says}; allowed: a text file") == 1, done.stderr)


def check_closed_output():
    done = subprocess.run(f"exec {MPMSTAB} list >&-", shell=True, stderr=subprocess.PIPE, text=True, check=False)
    check(done.returncode == 1 and done.stderr == "mpmstab: standard output cannot be written: the report is lost\n",
          f"without standard output: {done.returncode} {done.stderr}")
    done = subprocess.run(f"exec {MPMSTAB} run -steps 2 -json o.json <&- 2>&-", shell=True, stdout=subprocess.PIPE,
                          text=True, check=False)
    check(done.returncode == 0 and "verdict" in done.stdout, f"without standard input and error: {done.returncode}")


with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    for part in (check_memory, check_start, check_own_output, check_option_files, check_closed_output):
        part()
    os.chdir("/")
