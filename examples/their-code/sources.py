"""What the scripts of this folder share: sources of others, the program, and pages with their numbers."""
import json
import os
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
MPMSTAB = os.environ.get("MPMSTAB", str(ROOT / "build" / "mpmstab"))
SKIPPED = 77


def skip(why):
    print(f"{pathlib.Path(sys.argv[0]).name}: skipped, since {why}")
    sys.exit(SKIPPED)


def need(program):
    if not shutil.which(program):
        skip(f"{program} is not installed")


def folder_of(variable, url, has):
    """The folder that the environment variable names, or a clone in the working folder. Only a run by hand clones."""
    name = url.rsplit("/", 1)[1]
    folder = pathlib.Path(os.environ.get(variable, name)).resolve()
    if not folder.exists() and variable not in os.environ and "--check" not in sys.argv:
        subprocess.run(["git", "clone", "-q", "--depth", "1", url, name], check=False)
    if not (folder / has).exists():
        skip(f"{folder} has no {has}; get it with 'git clone {url}', and say with {variable} where it is")
    return folder


def ask(task, *words):
    """Runs a task and gives its JSON. A verdict that is not expected is for the caller to see."""
    done = subprocess.run([MPMSTAB, task, *map(str, words), "-json", "found.json"], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{task} {' '.join(map(str, words))}: status {done.returncode}: {done.stderr}")
    with open("found.json", encoding="utf-8") as file:
        return json.load(file)


def finish(page, rows):
    """Prints the rows. With --check it fails unless the page has each of them."""
    print("\n".join(rows))
    if "--check" not in sys.argv:
        return
    lines = (HERE / page).read_text(encoding="utf-8").splitlines()
    missing = [row for row in rows if row not in lines]
    if missing:
        sys.exit("\n".join(f"{page} does not have: {row}" for row in missing))
