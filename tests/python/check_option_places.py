#!/usr/bin/python3
"""Options that stand neither on the command line nor in the scene: the report says where each comes from.

check_option_places.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import os
import sys

from checks import check, check_one_line, on_ranks

MPMSTAB = sys.argv[-1]


def run(words, ranks=1, options="", home="/nowhere"):
    return on_ranks(ranks, MPMSTAB, *words.split(), timeout=60, env={**os.environ, "PETSC_OPTIONS": f"-options_left no {options}", "HOME": home})


def write(name, text):
    with open(name, "w", encoding="ascii") as file:
        file.write(text)


def check_said(done, lines, scene):
    """These lines, then the report, of the scene that has these words."""
    said = done.stdout.splitlines()
    check(done.returncode == 0 and not done.stderr and said[:len(lines)] == lines, f"{done.stdout}{done.stderr}")
    check(said[len(lines)].startswith("mpmstab ") and all(word in said[len(lines) + 1] for word in scene), done.stdout)


def check_places(ranks):
    """Of several places the command line counts, then the variable, then files in this folder, then the one at home."""
    check_said(run("symbol -cells 8", ranks), [], ["8 cells"])
    check_said(run("symbol", ranks, "-cells 9 -courant 0.3"), ["from PETSC_OPTIONS: -cells 9 -courant 0.3"],
               ["9 cells", "Courant number 0.3,"])
    write(".petscrc", "-cells 10\n-ppc 3\n-steps 7\n")
    os.makedirs("home", exist_ok=True)
    write("home/.petscrc", "-cells 11\n-offset 0.25\n-ppc 4\n")
    home = os.path.abspath("home")
    check_said(run("symbol", ranks, "-cells 9", home),
               ["from PETSC_OPTIONS: -cells 9", f"from {home}/.petscrc: -offset 0.25",
                "from .petscrc: -ppc 3 -steps 7 (not read by this task)"], ["9 cells x 3 particles", "offset 0.25"])
    check_said(run("symbol -cells 8 -ppc 2", ranks), ["from .petscrc: -steps 7 (not read by this task)"], ["8 cells x 2"])
    check_said(run("symbol -skip_petscrc", ranks), [], ["64 cells x 2"])
    os.remove(".petscrc")
    write("file", "-cells 12\n")
    check_said(run("symbol -options_file file", ranks), ["from file: -cells 12"], ["12 cells"])


def check_rivals():
    """The command line overrules what stands elsewhere, also by another name; a scene does not."""
    check_said(run("symbol -courant 0.3 -counts 2", options="-dt 0.1 -ppc 3"), ["from PETSC_OPTIONS: -dt 0.1 -ppc 3"],
               ["x 2 particles", "Courant number 0.3,"])
    write("scene.yaml", "courant: 0.3\ncells: 8\n")
    check_said(run("symbol scene.yaml", options="-dt 0.05"), ["from PETSC_OPTIONS: -dt 0.05"], ["8 cells", "number 0.4,"])
    check_one_line(run("symbol", options="-dt 0.1 -courant 0.3"), "two names", "courant and dt are both given outside")


def check_refused():
    """A refusal says where its option stands, and comes before any work."""
    for words, says in (("-cells -9", "-cells -9, from PETSC_OPTIONS: allowed: a whole number"),
                        ("-coruant 9", "unknown option -coruant, from PETSC_OPTIONS; did you mean -courant?"),
                        ("-eps_nev 9", "-eps_nev, from PETSC_OPTIONS: task symbol does not read it; allowed: with task spectrum"),
                        ("-ksp_type cg", "unknown option -ksp_type, from PETSC_OPTIONS; 'mpmstab list options'")):
        done = run("symbol -json no.json", options=words)
        check_one_line(done, words, says)
        check(not os.path.exists("no.json"), f"{words} was refused after the work")
    check_said(run("spectrum -measure false -cells 8", options="-eps_nev 9"), ["from PETSC_OPTIONS: -eps_nev 9"], ["8 cells"])


for number in (1, 2):
    check_places(number)
check_rivals()
check_refused()
