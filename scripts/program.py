"""Runs mpmstab for the scripts, and what they share of files. MPMSTAB names the program (build/mpmstab)."""
import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
PROGRAM = os.environ.get("MPMSTAB", os.path.join(ROOT, "build", "mpmstab"))


def refuse(message):
    """Ends the script as the program ends for bad input."""
    print(f"{os.path.basename(sys.argv[0])}: {message}", file=sys.stderr)
    sys.exit(2)


def require_program():
    if not os.path.exists(PROGRAM):
        refuse(f"there is no {PROGRAM}; ./scripts/setup.sh builds it, MPMSTAB names another")


def launch(task, scene=None, options=(), ranks=1):
    """Status, JSON ({}: none) and what was said on standard error. Options: a list, or a dictionary of values."""
    if isinstance(options, dict):
        options = [word for name, value in options.items() for word in (f"-{name}", str(value))]
    command = ["mpirun", "-q", "-n", str(ranks), PROGRAM] if ranks > 1 else [PROGRAM]
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out.json")
        done = subprocess.run([*command, task, *([scene] if scene else []), *options, "-json", out],
                              capture_output=True, text=True, check=False)
        found = {}
        if os.path.exists(out):
            with open(out, encoding="utf-8") as file:
                found = json.load(file)
    return done.returncode, found, done.stderr.strip()


def write_whole(path, text):
    """The file appears whole or not at all."""
    with open(path + ".part", "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(path + ".part", path)
