"""Attacks by what a machine does not give: memory, the size of files, room on a disk."""
import os
import resource
import subprocess

from oracle import DONE, REFUSED, Beside, judge, require

MEMORY = ("run -cells 64 -steps 20", "run -cells 1000000 -steps 2 -ppc 2", "run -cells 300000 -steps 2 -output o.h5",
          "symbol -cells 64", "symbol -cells 200000", "symbol -cells 40000 -output o.h5", "spectrum -cells 64",
          "spectrum -cells 500 -measure false -jitter 0.2", "spectrum -cells 5000 -measure false -output o.h5",
          "critical gas2", "critical gas2 -boundary fixed -cells 60", "map -map_points 20,10", "ensemble -jitter 0.4 -layouts 3",
          "spectrum -cells 40 -pseudospectrum 5 -powers 9", "list")
FILES = ("run -cells 64 -steps 100 -output {0}.h5 -output_every 10", "map -map_points 20,15 -output {0}.h5 -csv {0}.csv",
         "symbol -cells 4000 -output {0}.h5", "symbol -cells 8000 -csv {0}.csv",
         "run -cells 4000 -steps 5 -checkpoint {0}.h5",
         "run -cells 500 -steps 300 -csv {0}.csv -json {0}.json", "spectrum -cells 30 -measure false -output {0}.h5",
         "run -cells 200 -steps 50 -output {0}.h5 -checkpoint {0}c.h5 -checkpoint_every 5 -csv {0}.csv -json {0}.json")
LOADER = 127


class Skip(Exception):
    """This machine does not let the attack be tried."""


def attack_memory(dice, program):
    """Less address space than a task may want: it does the work, or ends in one line."""
    words = dice.choice(MEMORY).split()
    size = dice.choice((dice.uniform(100, 400), dice.uniform(300, 800), dice.uniform(600, 2500)))
    beside = Beside()
    done = program.run(words, limits={resource.RLIMIT_AS: int(size * 1e6)})
    done.words = [f"{size:.0f} MB:", *done.words]
    if done.status == LOADER and "shared libraries" in done.err:
        return  # the system cannot load the program
    beside.check(judge(done, [DONE, REFUSED]), ["o.h5", "o.xmf"])


def attack_sizes(dice, program):
    """Files may not grow beyond a limit. Open MPI needs 4 MiB of its own."""
    words = dice.choice(("symbol -phases 400000 -csv a.csv", "run -cells 200000 -steps 1 -output a.h5 -csv b.csv",
                         "symbol -phases 100000 -output a.h5", "run -cells 300000 -steps 2 -checkpoint a.h5 -json j.json",
                         "run -cells 64 -steps 20 -output a.h5", "map -output a.h5")).split()
    size = dice.randrange(4200000, 9000000)
    beside = Beside()
    done = program.run(words, limits={resource.RLIMIT_FSIZE: size})
    done.words = [f"files of {size} bytes:", *done.words]
    beside.check(judge(done, [DONE, REFUSED]), ["a.csv", "a.h5", "a.xmf", "b.csv", "j.json"])


def attack_disk(dice, program):
    """A small disk: the work is done, or refused. Files that are whole by then stay, others do not."""
    os.mkdir("small")
    size = dice.choice((dice.randrange(4, 100), dice.randrange(100, 1000)))
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "none", "small"], capture_output=True,
                             text=True, check=False)
    if mounted.returncode:
        raise Skip(f"a small disk cannot be mounted here: {mounted.stderr.strip()}")
    try:
        words = dice.choice(FILES).format("small/o").split()
        done = program.run(words, dice.choice((1, 1, 2)))
        done.words = [f"{size} kB:", *done.words]
        judge(done, [DONE, REFUSED])
        left = os.listdir("small")
        asked = {word.partition("/")[2] for word in words}
        require(set(left) <= asked | {"o.xmf"}, f"left on the disk: {left}\n  {done}")
        for name in left:
            with open(f"small/{name}", "rb") as file:
                data = file.read()
            require(data[-1:] == b"\n" or data[:4] == b"\x89HDF" or b"HDF" in data[:2048], f"{name} is not whole:\n  {done}")
    finally:
        subprocess.run(["umount", "small"], check=True)


ATTACKS = {"memory": attack_memory, "sizes": attack_sizes, "disk": attack_disk}

