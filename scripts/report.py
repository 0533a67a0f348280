#!/usr/bin/python3
"""One HTML page that answers for each scene: is it stable, for which time step, how accurate for what cost, and why?

report.py [SCENE.yaml...] [-o report.html] [-n RANKS] [--work FOLDER] [--no-work-precision] [--trust-scenes]

The script runs the tasks spectrum, symbol, critical, run and map of mpmstab on each scene (by default the examples)
and measures error against run time on three grids. Where a task does not support a scene, the page quotes its refusal.
A scene may name a program or a plugin, which --trust-scenes starts: the page then says which time steps the code takes,
and how well that is known.
The page holds its pictures and needs no network. The pictures are also saved in the folder report-pictures beside it.
The files of the runs stay in FOLDER (by default report-files beside
the page). The environment variable MPMSTAB names the program (by default build/mpmstab).
"""
# This import comes first, so that Ctrl-C during those below is one line too.
from program import (PROGRAM, ROOT, Parser, end_in_one_line, processor, refuse, require_input, require_outputs,
                     require_program, write_whole)
import datetime
import glob
import itertools
import os
import platform
import re
import shlex
import subprocess
import sys
import tempfile

import picture_files
import picture_scenes
import report_code
import report_html
import report_page
import report_runs


def parse():
    parser = Parser(__doc__)
    parser.add_argument("scenes", nargs="*", metavar="SCENE.yaml")
    parser.add_argument("-o", "--output", default="report.html", metavar="PAGE",
                        help="the page that is written (report.html)")
    parser.add_argument("-n", "--ranks", type=int, default=1, help="ranks of each run (1)")
    parser.add_argument("--work", metavar="FOLDER", help="where the files of the runs stay")
    parser.add_argument("--no-work-precision", action="store_true",
                        help="leave out error against run time, which takes longest")
    parser.add_argument("--trust-scenes", action="store_true",
                        help="start the programs and plugins that scenes name: for scenes whose writers you trust")
    arguments = parser.parse_args()
    if arguments.ranks < 1:
        refuse(f"-n {arguments.ranks}: allowed: 1 or more ranks")
    arguments.scenes = arguments.scenes or sorted(glob.glob(os.path.join(ROOT, "examples", "*", "scene.yaml")))
    arguments.work = os.path.abspath(arguments.work or os.path.splitext(arguments.output)[0] + "-files")
    return arguments


def names_of(scenes):
    """Returns a short name for each scene: its folder for a scene.yaml, else its file. No two are the same."""
    names = []
    for scene in scenes:
        folder, file = os.path.split(os.path.abspath(scene))
        name = os.path.basename(folder) if file == "scene.yaml" else os.path.splitext(file)[0]
        name = "".join(letter if letter.isalnum() or letter in "-_" else "-" for letter in name)
        same = sum(other == name or other.startswith(f"{name}_") for other in names)
        names.append(f"{name}_{same + 1}" if same else name)
    return names


def read_scene(path):
    require_input(path, "a scene in YAML")
    with open(path, encoding="utf-8", errors="replace") as file:
        return file.read()


def attributes_of(asker, answers):
    """Returns the parameters of the scene, as the program wrote them into its HDF5 files."""
    for name, path in (("output", "output.h5"), ("spectrum", "spectrum.h5"), ("symbol", "symbol.h5")):
        if name in answers and answers[name].done:
            with picture_files.open_hdf5(asker.path(path)) as file:
                return picture_scenes.attributes(file)
    return {}


def examine(path, name, text, arguments, known):
    """Runs the tasks on a scene and returns all that the page says of it."""
    asker, answers = report_runs.ask_all(path, os.path.join(arguments.work, name), arguments.ranks, known)
    run = answers["run"]
    exact = run.done and "error" in run.result["run"] and run.result["verdict"] == "stable"
    if exact and not arguments.no_work_precision:
        answers["error against run time"] = report_runs.work_precision(path, asker, run.result)
    return {"name": name, "file": os.path.abspath(path), "text": text, "asker": asker, "answers": answers,
            "scene": attributes_of(asker, answers)}


def first_line(*command):
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    except OSError:
        return ""
    return (done.stdout.splitlines() or [""])[0] if done.returncode == 0 else ""


def revision():
    """Returns the git revision of this project, unless the project lies inside a repository of another one."""
    if os.path.realpath(first_line("git", "rev-parse", "--show-toplevel") or os.sep) != os.path.realpath(ROOT):
        return "not known"
    changed = ", with changes that are not committed" if first_line("git", "status", "--porcelain", "-uno") else ""
    return first_line("git", "rev-parse", "--short=12", "HEAD") + changed


def facts(arguments):
    """Returns the versions, machine, revision and command with which the numbers were made, as pairs of words."""
    done = subprocess.run([PROGRAM, "list", "versions"], capture_output=True, text=True, check=False)
    versions = [tuple(line.split(None, 1)) for line in done.stdout.splitlines()[1:]]
    command = shlex.join(["scripts/report.py", *map(report_runs.shown, sys.argv[1:])])
    return [*versions, ("Python", f"{platform.python_version()} on {platform.system()} {platform.machine()}"),
            ("processor", f"{processor()}, {os.cpu_count()} of them"), ("ranks", arguments.ranks),
            ("git revision", revision()),
            ("date", datetime.datetime.now().astimezone().isoformat(" ", "seconds")), ("command", command)]


def require_folder(folder):
    try:
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        refuse(f"{folder}: {error.strerror}; allowed: a folder that can be written")


def require_places(arguments, names, album):
    """Refuses places that cannot be written, and to write over a scene. This comes before the runs, which take long."""
    require_outputs([arguments.output], [*arguments.scenes, PROGRAM])
    folders = [os.path.join(arguments.work, name) for name in names]
    for scene, folder in itertools.product(arguments.scenes, folders):
        real, ending = os.path.realpath(scene), os.path.splitext(scene)[1]
        if os.path.dirname(real) == os.path.realpath(folder) and ending in report_runs.ENDINGS:
            refuse(f"{scene}: lies among the files of the runs, which are written anew; allowed: another --work FOLDER")
    require_folder(os.path.dirname(os.path.abspath(arguments.output)))
    for folder in (arguments.work, album.folder, *folders):
        os.makedirs(folder, exist_ok=True)
        require_folder(folder)


def main():
    arguments = parse()
    require_program()
    texts = [read_scene(scene) for scene in arguments.scenes]
    for scene, text in zip(arguments.scenes, texts):
        other = re.search(r"^(matrix|matrix_blocks)\s*:", text, re.M)
        if other:
            refuse(f"{scene}: {other[1]} takes the place of a scene, and a report is of a scheme that is run; allowed: scenes")
    names, album = names_of(arguments.scenes), report_html.Album(arguments.output)
    require_places(arguments, names, album)
    known = report_runs.options_known()
    entries, codes = [], []
    for scene, name, text in zip(arguments.scenes, names, texts):
        if re.search(r"^(program|plugin)\s*:", text, re.M):
            found = report_code.ask_all(scene, os.path.join(arguments.work, name), arguments.ranks,
                                        arguments.trust_scenes)
            codes.append({"name": name, "file": os.path.abspath(scene), "text": text, **found})
        else:
            entries.append(examine(scene, name, text, arguments, known))
    report_runs.progress("the page")
    body = report_page.body(entries, codes, facts(arguments), album)
    write_whole(arguments.output, report_html.page(f"mpmstab: {len(arguments.scenes)} scenes", body))
    print(f"written: {arguments.output}; pictures: {report_runs.shown(album.folder)}; "
          f"files of the runs: {report_runs.shown(arguments.work)}")


if __name__ == "__main__":
    end_in_one_line(main)
