"""Attacks by files: damaged checkpoints, eigenmodes and results, outputs that are inputs, pipes, devices, folders."""
import os
import stat
import sys

from checks import SCRIPTS
from oracle import DONE, REFUSED, Beside, judge, require

RUN = "run -cells 12 -courant 0.4 -drift 1/3 -jitter 0.3 -steps".split()


def damaged(dice, data):
    """Bytes with some bits flipped, or cut, or with a part from elsewhere."""
    data = bytearray(data)
    how = dice.randrange(5)
    if how < 2:
        for _ in range(dice.choice((1, 1, 3, 30))):
            data[dice.randrange(len(data))] ^= 1 << dice.randrange(8)
    elif how == 2:
        del data[dice.randrange(len(data)):]
    elif how == 3:
        at, size = dice.randrange(len(data)), dice.choice((1, 8, 100))
        data[at:at + size] = bytes(dice.choice((0, 255)) for _ in data[at:at + size])
    else:
        at = dice.randrange(len(data))
        data[at:at] = data[:dice.choice((1, 8, 512))]
    return bytes(data)


def put(name, data):
    with open(name, "wb") as file:
        file.write(data)


def get(name):
    with open(name, "rb") as file:
        return file.read()


def attack_checkpoint(dice, program):
    """A damaged checkpoint is refused, or else the answer is that of the whole one."""
    ranks = dice.choice((1, 1, 1, 2))
    files = "-checkpoint c.h5 -csv whole.csv".split()
    judge(program.run([*RUN, "20", *files], ranks), [DONE])
    whole = get("c.h5")
    judge(program.run([*RUN, "40", "-restart", "c.h5", "-csv", "whole.csv"], ranks), [DONE])
    for _ in range(4):
        put("c.h5", damaged(dice, whole))
        beside = Beside()
        done = judge(program.run([*RUN, "40", "-restart", "c.h5", "-csv", "parts.csv"], ranks), [DONE, REFUSED])
        beside.check(done, ["parts.csv"])
        require(done.status == REFUSED or get("parts.csv") == get("whole.csv"), f"another answer:\n  {done}")


def attack_mode(dice, program):
    """A damaged file of eigenmodes ends in one line, or in a run."""
    scene = "-formulation gas1 -cells 6 -ppc 1".split()
    judge(program.run(["spectrum", *scene, "-measure", "false", "-output", "m.h5"]), [DONE])
    whole = get("m.h5")
    for _ in range(4):
        put("m.h5", damaged(dice, whole))
        beside = Beside()
        done = judge(program.run(["run", *scene, "-initial", "eigenmode", "-mode_file", "m.h5", "-steps", "5"],
                                 dice.choice((1, 1, 1, 2))), [DONE, REFUSED])
        beside.check(done, [])


INPUTS = ("scene.yaml", "c.h5", "m.h5")
# Other names, and what is no regular file.
PLACES = {"link": lambda: os.symlink("scene.yaml", "link"), "hard": lambda: os.link("scene.yaml", "hard"),
          "link.h5": lambda: os.symlink("c.h5", "link.h5"), "hard.h5": lambda: os.link("c.h5", "hard.h5"),
          "loop": lambda: os.symlink("loop", "loop"), "loop.h5": lambda: os.symlink("loop.h5", "loop.h5"),
          "nowhere": lambda: os.symlink("none/none", "nowhere"), "pipe": lambda: os.mkfifo("pipe"),
          "pipe.h5": lambda: os.mkfifo("pipe.h5"), "folder": lambda: os.mkdir("folder"),
          "folder.h5": lambda: os.mkdir("folder.h5"), ".petscrc": lambda: os.mkfifo(".petscrc")}
DEVICES = ("/dev/null", "/dev/full", "/dev/zero", "/dev/stdin", "/dev/fd/1", "/proc/self/mem", "/", ".", "..", "", "none/a",
           "./scene.yaml", "folder/../scene.yaml", "x" * 250, "x" * 5000, "a\nb", "-", "~", "o.h5", "a<b.h5", "%s.h5")


def attack_names(dice, program):
    """Random names for everything that is read or written: inputs keep their bytes, devices stay devices."""
    put("scene.yaml", b"cells: 12\ncourant: 0.4\nformulation: gas1\nppc: 1\nsteps: 20\n")
    judge(program.run("run scene.yaml -checkpoint c.h5".split()), [DONE])
    judge(program.run("spectrum scene.yaml -measure false -output m.h5".split()), [DONE])
    for name in dice.sample(sorted(set(PLACES) - {".petscrc"}), 5) + [".petscrc"] * (dice.random() < 0.05):
        PLACES[name]()
    there = [*INPUTS, *(name for name in PLACES if os.path.lexists(name)), *DEVICES]
    devices = {name: os.stat(name).st_mode for name in ("/dev/null", "/dev/full", "/dev/zero")}
    for _ in range(5):
        asked = {name: dice.choice(there) for name in dice.sample(("output", "json", "csv", "checkpoint", "restart",
                                                                   "mode_file"), dice.choice((1, 2, 3)))}
        words = ["run", dice.choice(("scene.yaml", *there)), "-steps", "25"]
        if "mode_file" in asked:
            words += ["-initial", "eigenmode"]
        for name, path in asked.items():
            words += [f"-{name}", path]
        inputs = {name: get(name) for name in (words[1], asked.get("mode_file"), asked.get("restart"))
                  if name in INPUTS and name != asked.get("checkpoint")}
        beside = Beside()
        done = judge(program.run(words, dice.choice((1, 1, 1, 1, 2))), [DONE, REFUSED])
        written = [asked[name] for name in ("output", "json", "csv", "checkpoint") if name in asked]
        beside.check(done, [*(os.path.normpath(path) for path in written if path),
                            *(os.path.splitext(path)[0] + ".xmf" for path in written if path)])
        for name, mode in devices.items():
            require(stat.S_ISCHR(mode) and os.stat(name).st_mode == mode, f"{name} is no device any more:\n  {done}")
        for name, before in inputs.items():
            require(get(name) == before, f"the input {name} was overwritten:\n  {done}")


SCENE = "-cells 12 -formulation gas1 -ppc 1".split()
PICTURES = {  # what makes the file, and what draws it
    "r.json": (["run", *SCENE, "-json", "r.json", "-csv", "r.csv"], ["growth", "r.json"]),
    "r.csv": (["run", *SCENE, "-json", "r.json", "-csv", "r.csv"], ["growth", "r.json"]),
    "s.csv": (["symbol", *SCENE, "-csv", "s.csv"], ["symbol", "s.csv"]),
    "o.h5": (["run", *SCENE, "-output", "o.h5"], ["spacetime", "o.h5"]),
    "m.h5": (["spectrum", *SCENE, "-measure", "false", "-output", "m.h5"], ["spectrum", "m.h5"]),
    "s.h5": (["symbol", *SCENE, "-output", "s.h5"], ["symbol", "s.h5"]),
    "map.h5": (["map", "-map_points", "4,3", "-phases", "8", "-output", "map.h5"], ["map", "map.h5"]),
}


def attack_scripts(dice, program):
    """Damaged results before the script that draws them."""
    name, (make, draw) = dice.choice(sorted(PICTURES.items()))
    judge(program.run(make), [DONE])
    whole = get(name)
    for _ in range(2):
        put(name, damaged(dice, whole))
        beside = Beside()
        command = [sys.executable, os.path.join(SCRIPTS, "pictures.py"), *draw, "-o", "picture"]
        done = judge(program.script(command), [DONE, REFUSED], "pictures.py")
        beside.check(done, ["picture.png", "picture.svg"])


ATTACKS = {"checkpoint": attack_checkpoint, "mode": attack_mode, "names": attack_names, "scripts": attack_scripts}
