"""The checks of this folder share this module: how a check fails, how it runs a script, and what it reads.

A check imports this module before the modules of scripts/, which are found by their names from then on.
"""
import json
import os
import subprocess
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
SCRIPTS = os.path.join(ROOT, "scripts")
sys.path[1:1] = [os.path.join(ROOT, "tests", "support"), SCRIPTS, os.path.join(SCRIPTS, "report"),
                 os.path.join(SCRIPTS, "bench")]
import forks  # short commands, without loading the libraries of mpmstab for each


def check(condition, message):
    """Ends the check with the message when the condition does not hold."""
    if not condition:
        sys.exit(f"{os.path.splitext(os.path.basename(sys.argv[0]))[0]}: {message}")


def run_script(name, *arguments, **how):
    """Runs a script, whose name is its path within scripts/, with this Python, and waits for its end."""
    return subprocess.run([sys.executable, os.path.join(SCRIPTS, name), *arguments], capture_output=True, text=True,
                          check=False, **how)


def on_ranks(ranks, *command, **how):
    """Runs a command on so many ranks, and waits for its end. The last two arguments of a check are mpiexec and mpmstab."""
    launch = [sys.argv[-2], "-q", "-n", str(ranks)] if ranks > 1 else []
    return forks.run([*launch, *command], capture_output=True, text=True, check=False, **how)


def check_one_line(done, what, says, status=2):
    """The script must have ended with this status and with one line on standard error, which has the words of says."""
    check(done.returncode == status and len(done.stderr.splitlines()) == 1 and says in done.stderr,
          f"{what}: status {done.returncode}, standard error: {done.stderr}")


def text_of(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def loaded(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def particles(path):
    """The fields of the last step of an output."""
    import h5py  # few checks need it
    with h5py.File(path) as file:
        step = max(key for key in file if key.startswith("step_"))
        return {name: item[...] for name, item in file[step + "/particles"].items()}


def check_same_runs(run, what, *scene):
    """A run that resumes is one that does not end; three ranks and the plain march have the same particles, which it returns.

    run(ranks, *words) runs mpmstab and ends the check when it fails.
    """
    run(1, *scene, "-steps", "20", "-output", "whole.h5")
    run(1, *scene, "-steps", "11", "-checkpoint", "part.h5")
    run(1, *scene, "-steps", "20", "-restart", "part.h5", "-output", "resumed.h5")
    run(3, *scene, "-steps", "20", "-output", "three.h5")
    run(1, *scene, "-steps", "20", "-march", "plain", "-output", "plain.h5")
    whole = particles("whole.h5")
    for other in ("resumed", "three", "plain"):
        for field, values in particles(other + ".h5").items():
            apart = abs(values - whole[field])
            if field == "coordinates":  # in a periodic box of length 1
                apart = apart * (apart < 0.5) + abs(apart - 1) * (apart >= 0.5)
            check(apart.max() <= (0 if other == "resumed" else 1e-11), f"{what}: {field} of {other} is off by {apart.max():.2e}")
    return whole
