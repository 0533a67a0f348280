#!/usr/bin/python3
"""Checks that no output takes the place of a file that is read or written already, and that a scene that is merely read
does not act.

check_input_files.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import os
import shutil
import sys
import tempfile

from checks import check, check_one_line, on_ranks

MPMSTAB = sys.argv[-1]
SCENE = "formulation: usl\ncourant: 0.5\ncells: 8\nsteps: 10\n"
GIVEN = "-formulation usl -courant 0.5 -cells 8".split()
STEPS = [*GIVEN, "-steps", "10"]
MATRIX = "%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 0.5\n"


def start(words, ranks=1, **how):
    return on_ranks(ranks, MPMSTAB, *words, timeout=60, **how)


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def files():
    """Returns the files of this folder and those below, with what is in them."""
    paths = [os.path.join(folder, name) for folder, _, names in os.walk(".") for name in names]
    return {path: open(path, "rb").read() for path in paths if os.path.isfile(path)}


def refuse(says, *words, ranks=1, **how):
    """Refused with one line, and no file has changed, come or gone."""
    before = files()
    check_one_line(start(words, ranks, **how), words, says)
    check(files() == before, f"{words}: {sorted(set(files()) ^ set(before)) or 'a file'} has changed")


def check_kept():
    write("s.yaml", SCENE)
    write("a.mtx", MATRIX)
    write("options", "-courant 0.4\n")
    write("mine.py", "")
    write("scheme.yaml", start(["list", "formulation", "usl"]).stdout)
    for name in ("blocks.npz", "mine.so"):
        write(name, "")
    done = start(["run", *STEPS, "-checkpoint", "c.h5"])
    check(done.returncode == 0, done.stderr)
    done = start(["spectrum", *GIVEN, "-output", "modes.h5"])
    check(done.returncode == 0, done.stderr)
    os.link("s.yaml", "hard.json")
    os.symlink("s.yaml", "soft.json")
    os.mkdir("d")
    os.symlink("d", "e")
    here = os.getcwd()
    refuse("that is the scene", "run", "s.yaml", "-csv", "hard.json", ranks=2)
    refuse("-log_view: PETSc would write over a file", "run", "s.yaml", "-log_view", ":s.yaml", ranks=2)
    refuse("json and csv would both write", "run", *STEPS, "-json", "d/new", "-csv", "e/new", ranks=2)
    scheme = ["-scheme", "scheme.yaml", *GIVEN[2:], "-steps", "10"]
    for option in ("-json", "-csv"):
        for other in ("s.yaml", "./s.yaml", f"{here}/s.yaml", "e/../s.yaml", "hard.json", "soft.json"):
            refuse(f"{option} {other}: that is the scene; allowed", "run", "s.yaml", option, other)
    for says, *words in [
            ("that is the scheme", "run", *scheme, "-json", "scheme.yaml"),
            ("that is the scheme", "critical", *scheme[:2], "-csv", "./scheme.yaml"),
            ("that is the file of options", "run", *STEPS[2:], "-options_file", "options", "-json", "options"),
            ("that is the matrix", "spectrum", "-matrix", "a.mtx", "-json", "a.mtx"),
            ("that is the matrix", "spectrum", "-matrix", "a.mtx", "-write_matrix", "./a.mtx"),
            ("that is the matrix_blocks", "symbol", "-matrix_blocks", "blocks.npz", "-write_blocks", "blocks.npz"),
            ("that is the mode_file", "run", *STEPS, "-initial", "eigenmode", "-mode_file", "modes.h5", "-output", "modes.h5"),
            ("that is the restart", "run", *STEPS, "-restart", "c.h5", "-json", "c.h5"),
            ("that is the program", "spectrum", "-program", f"{sys.executable} mine.py", "-json", "mine.py"),
            ("that is the plugin", "spectrum", "-plugin", "./mine.so", "-csv", "mine.so"),
            ("json and csv would both write", "run", *STEPS, "-json", "d/new", "-csv", "e/new"),
            ("output and json would both write", "run", *STEPS, "-output", "e/new.h5", "-json", f"{here}/d/new.xmf"),
            ("output and checkpoint would both write", "run", *STEPS, "-output", "d/../c2", "-checkpoint", "c2"),
            ("-log_view: PETSc would write over a file", "run", "s.yaml", "-log_view", ":s.yaml"),
            ("-log_view: PETSc would write over a file", "run", *STEPS, "-json", "d/new", "-log_view", "ascii:e/new:ascii_xml"),
            ("-history: PETSc would write over a file", "run", "s.yaml", "-history", "hard.json"),
            ("-mat_view: PETSc would write over a file", "spectrum", "-matrix", "a.mtx", "-mat_view", "binary:a.mtx")]:
        refuse(says, *words)
    write("body.csv", "x\n0.2\n0.4\n")
    bodies = ["run", *STEPS, "-kinematics", "finite", "-bodies", "[{shape: file, path: ./body.csv}]"]
    for option in ("-csv", "-json"):
        refuse(f"{option} body.csv: that is the path of a body; allowed", *bodies, option, "body.csv")
    os.rename("options", ".petscrc")
    refuse("that is the file of options", "run", *STEPS[2:], "-json", ".petscrc")
    os.remove(".petscrc")
    write("both.yaml", SCENE + "json: d/new.json\n")
    refuse("would both write", "run", "both.yaml", "-csv", "e/new.json")
    done = start(["run", *GIVEN, "-steps", "20", "-restart", "c.h5", "-checkpoint", "./c.h5"])
    check(done.returncode == 0, f"a checkpoint in the place of the one before: {done.stderr}")
    done = start(["run", "s.yaml", "-json", "d/r.json", "-csv", "e/r.csv", "-log_view", ":d/log"])
    check(done.returncode == 0 and sorted(os.listdir("d")) == ["log", "r.csv", "r.json"], done.stderr)


def check_trust():
    """A scene starts nothing, and writes its own kinds of files to the current folder and below it."""
    outside = tempfile.mkdtemp(dir="..")
    above = "../" + os.path.basename(outside)
    os.symlink(above, "link")
    for key, runs in (("program", "touch acted"), ("plugin", "./acted.so")):
        write("acts.yaml", f"{key}: {runs}\n")
        for task in ("spectrum", "symbol", "critical", "map", "run"):
            refuse(f"acts.yaml:1: {key}: {runs}: a scene that is read runs nothing; allowed: on the command line, or with "
                   "-trust_scene", task, "acts.yaml")
        refuse("a scene that is read runs nothing", "symbol", "acts.yaml", "-trust_scene", "false")
        write("trusts.yaml", f"{key}: {runs}\ntrust_scene: true\n")
        for trust in ([], ["-trust_scene", "false"]):
            refuse("allowed: on the command line only" if not trust else "a scene that is read runs nothing", "symbol",
                   "trusts.yaml", *trust)
        refuse("from PETSC_OPTIONS: allowed: on the command line only", "symbol", "acts.yaml",
               env={**os.environ, "PETSC_OPTIONS": "-trust_scene"})
        refuse("a scene that is read runs nothing", "symbol", "acts.yaml", ranks=2)
    write("acts.yaml", "program: touch acted\n")
    write("act", "#!/bin/sh\ntouch acted\n")
    os.chmod("act", 0o755)
    write("mine", "-program ./act\n")
    for words in (["acts.yaml", "-trust_scene"], ["-program", "touch acted"], ["-options_file", "mine"]):
        start(["symbol", *words])
        check(os.path.exists("acted"), f"{words}: nothing was started")
        os.remove("acted")
    for key, right, others in (("json", "r.json", ("r.txt", "Makefile")), ("csv", "r.csv", ("r.json", ".csv")),
                               ("output", "o.h5", ("o", "Makefile")), ("checkpoint", "c.hdf5", ("c", "c.so"))):
        ending = os.path.splitext(right)[1]
        hidden = (f".x{ending}", f"d/.x{ending}", f".git/x{ending}")
        for name in (".git", "d"):
            os.makedirs(name, exist_ok=True)
        for path in (*others, *hidden, f"../x{ending}", f"{outside}/x{ending}", f"link/x{ending}", f"d/../../x{ending}"):
            write("w.yaml", f"{SCENE}{key}: {path}\n")
            refuse(f"w.yaml:5: {key}: {path}: a scene may write to the current folder and below it; allowed: a name there "
                   f"that ends in {ending if key in ('json', 'csv') else '.h5 or .hdf5'}", "run", "w.yaml")
        for path in (right, f"./d/{right}", f"{os.getcwd()}/{right}"):
            write("w.yaml", f"{SCENE}{key}: {path}\n")
            done = start(["run", "w.yaml"])
            check(done.returncode == 0 and os.path.exists(path), f"{key}: {path}: {done.stderr}")
            os.remove(path)
        write("w.yaml", f"{SCENE}{key}: {outside}/{right}\n")
        refuse("a scene may write to the current folder and below it", "run", "w.yaml", ranks=2)
        for words in (["-trust_scene"], [f"-{key}", f"{above}/{right}"]):
            done = start(["run", "w.yaml", *words])
            check(done.returncode == 0 and os.path.exists(f"{outside}/{right}"), f"{words}: {done.stderr}")
            os.remove(f"{outside}/{right}")
    for key in ("log_view", "mat_view", "options_monitor", "on_error_attach_debugger", "start_in_debugger", "info",
                "history", "dll_prepend", "options_file", "malloc_view", "fp_trap", "eps_view", "-log_view"):
        write("library.yaml", f'{SCENE}{key}: ":acted"\n')
        refuse(f"library.yaml:5: unknown key '{key}'", "run", "library.yaml")
    check("trust_scene" not in start(["list", "schema"]).stdout, "the schema of scenes has trust_scene")
    shutil.rmtree(outside)


with tempfile.TemporaryDirectory() as folder:
    for part in (check_kept, check_trust):
        os.makedirs(os.path.join(folder, part.__name__))
        os.chdir(os.path.join(folder, part.__name__))
        part()
    os.chdir("/")
