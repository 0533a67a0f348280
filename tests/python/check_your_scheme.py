#!/usr/bin/python3
"""A scheme as text in files: its hash and parameters are in JSON, HDF5, checkpoints and pictures, and a checkpoint of
another scheme is refused. The map on the page of examples/your-scheme is what the program prints.

check_your_scheme.py MPIEXEC MPMSTAB. Silent when all is well.
"""
import json
import os
import pathlib
import re
import shlex
import sys
import tempfile

import h5py

from checks import check, on_ranks

import picture_maps
import picture_scenes

ROOT = pathlib.Path(__file__).resolve().parents[2]
MPMSTAB = sys.argv[-1]
FOLDER = ROOT / "examples" / "your-scheme"
AHEAD, MID = str(FOLDER / "musl-ahead.yaml"), str(FOLDER / "musl-mid.yaml")


def run(*words, ranks=1, status=0):
    done = on_ranks(ranks, MPMSTAB, *words, timeout=120)
    check(done.returncode == status, f"{words}: status {done.returncode} instead of {status}\n{done.stdout}{done.stderr}")
    return done.stdout if status == 0 else done.stderr


def check_page():
    page = (FOLDER / "README.md").read_text(encoding="utf-8")
    command = re.search(r"^    build/mpmstab (map (?:.*\\\n)?.*)$", page, re.M)[1].replace("\\\n", " ")
    words = [word.replace("examples/your-scheme", str(FOLDER)) for word in shlex.split(command)]
    printed = [line.rstrip() for line in run(*words).splitlines()]
    rows = [line[4:].rstrip() for line in page.splitlines() if re.match(r"^     *[-\d.]+  [-.+x#?]{65}$", line)]
    check(len(rows) == 10, f"the page has {len(rows)} rows of a map")
    for row in rows:
        check(row in printed, f"the map has no row '{row}':\n" + "\n".join(printed))


def check_records():
    run("map", "-scheme", AHEAD, "-map_axes", "mix,courant", "-map_mix", "-1,0", "-map_courant", "1/10,1",
        "-map_points", "3,4", "-output", "map.h5", "-json", "map.json", "-csv", "map.csv", ranks=2)
    run("run", "-scheme", AHEAD, "-mix", "-0.25", "-steps", "3", "-json", "run.json")
    result = json.loads(pathlib.Path("run.json").read_text(encoding="utf-8"))
    check(re.fullmatch("[0-9a-f]{16}", result["scheme"]["hash"]), f"JSON has the hash {result['scheme']}")
    check(result["formulation"] == "musl-ahead" and result["scheme"]["parameters"] == "mix=-0.25",
          f"JSON says {result['scheme']}")
    with h5py.File("map.h5") as file:
        attributes = picture_scenes.attributes(file)
        check(list(file["map/mix"][()]) == [-1, -0.5, 0], "the axis of mix")
    check(attributes["scheme"] == result["scheme"]["hash"], "HDF5 and JSON have different hashes")
    check(attributes["parameters"] == "mix=-0.5", f"HDF5 says {attributes['parameters']}")
    said = f"musl-ahead [{result['scheme']['hash'][:8]}, mix = -0.25]"
    check(said in picture_scenes.scene_text(result), f"a picture's text lacks {said}")
    picture_maps.growth_map("map.h5", "map.json", "map.csv")
    other = {**result, "scheme": {"hash": "0" * 16, "parameters": "mix=-0.25"}}
    check(picture_scenes.compared(result) != picture_scenes.compared(other), "pictures take two schemes for one")


def check_restart():
    run("run", "-scheme", AHEAD, "-cells", "12", "-steps", "4", "-checkpoint", "c.h5")
    run("run", "-scheme", AHEAD, "-cells", "12", "-steps", "8", "-restart", "c.h5", ranks=2)
    said = run("run", "-scheme", AHEAD, "-mix", "-1/4", "-cells", "12", "-steps", "8", "-restart", "c.h5", status=2)
    check("parameters" in said and "mix=-0.5" in said, f"a checkpoint of other parameters: {said}")
    text = pathlib.Path(AHEAD).read_text(encoding="utf-8")
    pathlib.Path("other.yaml").write_text(text.replace("a_i = -k DIV s", "a_i = -0.5 k DIV s"), encoding="utf-8")
    said = run("run", "-scheme", "other.yaml", "-cells", "12", "-steps", "8", "-restart", "c.h5", status=2)
    check("scheme" in said, f"a checkpoint of another scheme: {said}")
    said = run("run", "-formulation", "musl", "-cells", "12", "-steps", "8", "-restart", "c.h5", status=2)
    check("c.h5" in said, f"a checkpoint of another formulation: {said}")


def check_options():
    """What the command line may say of parameters, and that each refusal names the option."""
    for words, expected in (
            (("-mix", "x"), "-mix x: allowed: a finite number or a fraction"),
            (("-map_mix", "0,1"), "-map_mix 0,1: allowed: with task map"),
            (("-thetas", "1"), "unknown option -thetas"),
            (("-formulation", "usl"), "formulation and scheme are both given on the command line"),
            (("-mix", "1", "-mix", "2"), "-mix is given a second time; allowed: once")):
        said = run("run", "-scheme", AHEAD, "-steps", "2", *words, status=2)
        check(expected in said and said.count("\n") == 1, f"{words}: {said}")
    said = run("run", "-scheme", "nowhere.yaml", status=2)
    check("scheme nowhere.yaml: No such file" in said, said)
    said = run("map", "-scheme", AHEAD, "-map_axes", "mix,drift", status=2)
    check("allowed: with its span, as -map_mix lo,hi" in said, said)
    said = run("list", "formulation", "uls", status=2)
    check("did you mean usl?" in said, said)
    pathlib.Path("usl.yaml").write_text(run("list", "formulation", "usl"), encoding="utf-8")
    same = [run("symbol", *words, "-courant", "0.9", "-cells", "20", ranks=3).splitlines()
            for words in (("-scheme", "usl.yaml"), ("-formulation", "usl"))]
    growth = [next(line for line in lines if line.startswith("  symbol")) for lines in same]
    check(growth[0] == growth[1], f"usl as text: {growth}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        check_page()
        check_records()
        check_restart()
        check_options()


if __name__ == "__main__":
    main()
