#!/usr/bin/python3
"""Checks that pictures.py draws or refuses HDF5 files with flipped bits, and reports a signal in one line.

check_picture_flipped.py MPMSTAB [TRIALS [SEED]], in a folder that may be filled. Silent when all is well.

Each trial flips one to three bits of a small file. Allowed are a picture, or one line and status 2.
"""
import os
import random
import subprocess
import sys
import time

from checks import check, forks
import pictures
from program import end_in_one_line

TRIALS, SEED, PATIENCE = 24, 1, 60
SCENE = "-formulation gas2 -cells 4".split()
FILES = {"spectrum": "spectrum -modes 2 -pseudospectrum 4", "symbol": "symbol", "map": "map -map_points 3,3",
         "run": "run -steps 6 -output_every 2", "plane": "run -dim 2 -steps 6 -output_every 3", "zone": "symbol -dim 2",
         "torus": "spectrum -dim 2 -ppc 1 -modes 2 -measure false"}
# Kinds of pictures and the files they are made from.
KINDS = [("frames", "plane"), ("frames", "run"), ("map", "map"), ("modes", "spectrum"), ("modes", "torus"),
         ("pseudospectrum", "spectrum"), ("spacetime", "run"), ("spectrum", "spectrum"), ("symbol", "symbol"),
         ("symbol", "zone")]


def make(mpmstab):
    for name, words in FILES.items():
        forks.run([mpmstab, *words.split(), *SCENE, "-output", f"{name}.h5", "-json", f"{name}.json"], check=True,
                  stdout=subprocess.DEVNULL)


def drawn(*words):
    """Runs pictures.py in a copy of this process, which has its modules already. Returns its status and its lines."""
    with open("said.txt", "w+", encoding="utf-8") as said:
        child = os.fork()
        if not child:
            os.dup2(said.fileno(), 2)
            sys.argv = ["pictures.py", *words]
            status = 0
            try:
                end_in_one_line(pictures.main)
            except SystemExit as end:
                status = end.code
            except BaseException:
                sys.excepthook(*sys.exc_info())
                status = 1
            sys.stderr.flush()
            os._exit(status or 0)
        begin = time.monotonic()
        while True:
            ended, status = os.waitpid(child, os.WNOHANG)
            if ended:
                break
            if time.monotonic() - begin > PATIENCE:
                os.kill(child, 9)
            time.sleep(0.005)
        said.seek(0)
        return os.waitstatus_to_exitcode(status), said.read().splitlines()


def flip(source, target, chance):
    """Writes a copy with flipped bits, in bytes that are not zero; most zeros only fill space."""
    with open(source, "rb") as file:
        content = bytearray(file.read())
    used = [place for place, byte in enumerate(content) if byte]
    for _ in range(chance.randint(1, 3)):
        content[chance.choice(used)] ^= 1 << chance.randrange(8)
    with open(target, "wb") as file:
        file.write(content)


def check_trial(number):
    chance = random.Random(number)
    kind, source = chance.choice(KINDS)
    flip(f"{source}.h5", "flipped.h5", chance)
    more = ["map.json"] if kind == "map" else []
    outputs = ["out/movie.gif"] if kind == "frames" else ["out.png", "out.svg"]
    for path in filter(os.path.exists, outputs):
        os.remove(path)
    status, lines = drawn(kind, "flipped.h5", *more, "-o", "out")
    said = f"trial {number}, {kind}: status {status}, said {lines}"
    if status == 0:
        check(all(map(os.path.exists, outputs)), f"no picture: {said}")
        check(all(line.startswith("pictures.py: warning: ") for line in lines), said)
    else:
        check(status == 2 and len(lines) == 1 and lines[0].startswith("pictures.py: flipped.h5"), said)
        check("; allowed: " in lines[0], said)
    check(not [name for name in os.listdir(".") if name.endswith(".part")], f"a .part is left: {said}")


def check_signals():
    """A signal must become one line that names the file, even when the C library prints something before."""
    real = pictures.draw
    for end, name in ((os.abort, "SIGABRT"), (lambda: os.kill(os.getpid(), 11), "SIGSEGV")):
        def dies(_, end=end):
            os.write(2, b"double free or corruption\n")
            end()
        pictures.draw = dies
        status, lines = drawn("spectrum", "spectrum.h5")
        check(status == 2 and len(lines) == 1, f"{name}: status {status}, said {lines}")
        check(lines[0].startswith("pictures.py: spectrum.h5: ") and name in lines[0], f"{name}: said {lines}")
    pictures.draw = real
    status, lines = drawn("spectrum", "spectrum.h5", "-o", "whole")
    check(status == 0 and not lines, f"a whole file: status {status}, said {lines}")


def main(mpmstab, trials=TRIALS, seed=SEED):
    make(mpmstab)
    check_signals()
    for number in range(int(seed), int(seed) + int(trials)):
        check_trial(number)


if __name__ == "__main__":
    main(*sys.argv[1:])
