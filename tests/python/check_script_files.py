#!/usr/bin/python3
"""Checks that scripts refuse, before any work, to read pipes and devices and to write over their inputs.

check_script_files.py, in a folder that may be filled. Silent when all is well.

MPMSTAB names a program that only leaves a file behind, which shows that a script has run it.
"""
import os
import shutil
import subprocess
import sys

from checks import ROOT, check, check_one_line, run_script, text_of
import program

SCENE = "formulation: gas2\n"
PROGRAM = '#!/bin/sh\ntouch ran\nexit 1\n'


def make():
    for name in ("foo.csv", "foo.yaml", "other.yaml"):
        with open(name, "w", encoding="ascii") as file:
            file.write(SCENE)
    with open("program", "w", encoding="ascii") as file:
        file.write(PROGRAM)
    os.chmod("program", 0o755)
    for name, target in (("link.html", "foo.yaml"), ("bar.png", "foo.yaml"), ("device", "/dev/full"),
                         ("program.html", "program"), ("baz.svg", "/dev/full"), ("study.csv", "/dev/full")):
        if not os.path.lexists(name):
            os.symlink(target, name)
    for name in ("pipe", "pipe.csv"):
        if not os.path.exists(name):
            os.mkfifo(name)
    if not os.path.exists("hard.html"):
        os.link("foo.yaml", "hard.html")
    os.makedirs("runs/map", exist_ok=True)
    shutil.copy("foo.yaml", "runs/map/map.csv")
    os.makedirs("runs/foo", exist_ok=True)
    shutil.copy("foo.yaml", "runs/foo/foo.csv")


def check_refused(arguments, says):
    """Runs a script, which must refuse in one line, run no program, and leave every file as it was."""
    before = {name: (os.lstat(name).st_ino, os.lstat(name).st_mtime_ns) for name in os.listdir(".")}
    done = run_script(*arguments, env={**os.environ, "MPMSTAB": os.path.abspath("program")}, timeout=60)
    check_one_line(done, arguments, says)
    check(" allowed: " in done.stderr, f"{arguments}: {done.stderr}")
    check(not os.path.exists("ran"), f"{arguments}: the program was run")
    after = {name: (os.lstat(name).st_ino, os.lstat(name).st_mtime_ns) for name in os.listdir(".")}
    check(after == before, f"{arguments}: files changed: {set(after.items()) ^ set(before.items())}")


def check_report():
    for arguments, says in ((("pipe",), "pipe: is not a regular file"), (("/dev/zero",), "/dev/zero: is not a regular"),
                            (("runs",), "runs: is a folder"),
                            (("foo.yaml", "-o", "foo.yaml"), "foo.yaml: would replace the input foo.yaml"),
                            (("other.yaml", "foo.yaml", "-o", "link.html"), "link.html: would replace the input foo.yaml"),
                            (("foo.yaml", "-o", "hard.html"), "hard.html: would replace the input foo.yaml"),
                            (("foo.yaml", "-o", "program.html"), "program.html: would replace the input"),
                            (("foo.yaml", "-o", "device"), "device: is not a regular file"),
                            (("foo.yaml", "-o", "pipe"), "pipe: is not a regular file"),
                            (("runs/foo/foo.csv", "--work", "runs"), "foo.csv: lies among the files of the runs")):
        check_refused(("report.py", *arguments), says)


def check_work_precision():
    for arguments, says in ((("foo.csv", "-o", "foo"), "foo.csv: would replace the input foo.csv"),
                            (("foo.yaml", "-o", "bar"), "bar.png: would replace the input foo.yaml"),
                            (("foo.yaml", "-o", "baz"), "baz.svg: is not a regular file"),
                            (("pipe", "-o", "no"), "pipe: is not a regular file"),
                            (("/dev/zero", "-o", "no"), "/dev/zero: is not a regular file")):
        check_refused(("work_precision.py", *arguments), says)


def check_others():
    studies = os.path.join(ROOT, "examples")
    os.makedirs("results", exist_ok=True)
    if not os.path.exists("results/bar-drifts.png"):
        os.mkfifo("results/bar-drifts.png")
    for arguments, says in ((("extremes.py", "--check", "nope"), "nope: no such file"),
                            (("extremes.py", "--check", "/dev/zero"), "/dev/zero: is not a regular file"),
                            (("extremes.py", "--check", "pipe"), "pipe: is not a regular file"),
                            (("extremes.py", "--ranks", "0"), "--ranks 0: allowed: 1 or more"),
                            (("extremes.py", "--ranks", "two"), "invalid int value"),
                            (("extremes.py", "nothing-*"), "no scene of"),
                            (("bench/bench_startup.py", "--history", "pipe"), "pipe: is not a regular file"),
                            ((f"{studies}/source-term/study.py", "-o", "device"), "device: is not a regular file"),
                            ((f"{studies}/formulation-matters/study.py", "-o", "results"),
                             "results/bar-drifts.png: is not a regular file")):
        check_refused(arguments, says)


def check_whole_files():
    """Several writers of one file must not disturb one another, nor any file beside it."""
    for name in ("whole.txt.part", f"{os.getpid()}.part"):
        with open(name, "w", encoding="ascii") as file:
            file.write("mine")
    writers = [subprocess.Popen([sys.executable, "-c", "import sys; sys.path.insert(0, sys.argv[1])\n"
                                 "from program import write_whole\nfor _ in range(200): write_whole('whole.txt', 'a' * 5000)",
                                 os.path.join(ROOT, "scripts")]) for _ in range(3)]
    check([writer.wait() for writer in writers] == [0, 0, 0], "writers of the same file disturb one another")
    check(text_of("whole.txt") == "a" * 5000, "the file is not whole")
    check(text_of("whole.txt.part") == "mine" == text_of(f"{os.getpid()}.part"), "a file of the user's was taken")
    os.remove("whole.txt.part")
    os.remove(f"{os.getpid()}.part")
    os.makedirs("folder.txt", exist_ok=True)
    try:
        program.write_whole("folder.txt", "a")
        check(False, "a folder was replaced")
    except OSError as error:
        check(error.filename == "folder.txt", f"the error names {error.filename}")
    check(not [name for name in os.listdir(".") if name.endswith(".part")], "a .part is left")


def main():
    make()
    for one in (check_report, check_work_precision, check_others, check_whole_files):
        one()


if __name__ == "__main__":
    main()
