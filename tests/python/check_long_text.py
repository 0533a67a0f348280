#!/usr/bin/python3
"""Checks that long texts of a user, and long lists of them, are named whole or refused: one line, status 2, no crash.

check_long_text.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.

check_long_text.py --program WIDTH ERROR is a code for -program: one with as many fields and parameters of long names as
there may be, whose names have WIDTH characters; it answers to "set" with an error of ERROR characters.
"""
import json
import os
import pathlib
import re
import struct
import sys

from checks import ROOT, check, check_one_line, forks

FIELDS = 62   # of particles beside v and s, and of nodes beside v_i and a_i: 128 in all
MARCHED = 50  # a line of the step for each
SCHEME = """scheme:
  name: mine
  particles: {{v: vector, s: stress{particles}}}
  nodes: {{v_i: vector, a_i: vector{nodes}}}
  step:
    - v_i = P2G v
    - IMPOSE v_i
    - FILTER v v_i
    - a_i = -k DIV s
    - REACT a_i v_i
    - v_i += a_i
    - v += G2P a_i
    - s += k STRESS GRAD v_i
    - {line}
  energy: {{v: mass, s: compliance}}
"""
PLAIN = "formulation: usl\ncourant: 0.5\ncells: 4\n"
GIVEN = "-formulation usl -courant 0.5 -cells 4".split()
LENGTHS = (250, 1100, 5000, 70000)


def answer(width, error):
    """Speaks protocol 1."""
    names = [str(i).rjust(width, "p") for i in range(64)]
    fields = [{"name": name, "size": 1} for name in names]
    fields[0]["place"] = True
    described = {"protocol": 1, "name": "long", "dim": 1, "cell_width": 1.0, "particles": 2, "fields": fields,
                 "parameters": {name: 1.0 for name in names}}
    for line in sys.stdin.buffer:
        if json.loads(line)["do"] == "describe":
            state = struct.pack("<128d", *[0.5] * 64, 1.5, *[0.5] * 63)
            sys.stdout.buffer.write(json.dumps(described).encode() + b"\n" + state)
        else:
            sys.stdout.buffer.write(json.dumps({"error": "e" * error}).encode() + b"\n")
        sys.stdout.buffer.flush()


def start(mpmstab, *words, **environment):
    return forks.run([mpmstab, *words], capture_output=True, text=True, check=False, timeout=60,
                     env={**os.environ, **environment}, errors="replace")


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


def refuse(mpmstab, says, *words, **environment):
    check_one_line(start(mpmstab, *words, **environment), [word[:60] for word in words], says)


def check_schemes(mpmstab):
    """A message that names all fields of a scheme names the last one too."""
    names = [f"field_of_n{i:02d}" for i in range(FIELDS)]
    own = [f"p{name[1:]}" for name in names]
    particles = "".join(f", {name}: scalar" for name in own)
    nodes = "".join(f", {name}: scalar" for name in names)
    write("wrong.yaml", SCHEME.format(particles=particles, nodes=nodes, line="other = P2G v"))
    refuse(mpmstab, f"{names[-1]}\n", "run", "wrong.yaml", "-courant", "0.5")
    own = own[:MARCHED]
    sums = [f"w_i += P2G {name}" for name in own[1:]]
    lines = "\n    - ".join([f"w_i = P2G {own[0]}", *sums, f"{own[0]} += 0 G2P w_i", "DRIFT"])
    particles = "".join(f", {name}: scalar" for name in own)
    write("many.yaml", SCHEME.format(particles=particles, nodes=", w_i: scalar", line=lines))
    done = start(mpmstab, "run", "many.yaml", "-courant", "0.5", "-cells", "4", "-steps", "2", "-ringing",
                 "-source_term", "-csv", "many.csv")
    check(done.returncode == 0, f"{done.stdout[-500:]} {done.stderr[:500]}")
    with open("many.csv", encoding="utf-8") as file:
        header, row = file.read().splitlines()[:2]
    columns = header.split(",")
    check(len(columns) == len(row.split(",")) == 5 + 2 * (MARCHED + 2) and columns[-1].endswith(own[-1]),
          f"columns of many fields: {header}")


def check_programs(mpmstab):
    """A message that names all parameters of a code names the last one too; what the code says may be long."""
    def code(width, error=10):
        return f"{sys.executable} {os.path.abspath(__file__)} --program {width} {error}"

    last = "63".rjust(63, "p")
    refuse(mpmstab, f"{last}\n", "spectrum", "-program", code(63), "-program_set", "other=1")
    refuse(mpmstab, f"{last}\n", "critical", "-program", code(63), "-program_dt", "other")
    refuse(mpmstab, f"{last}\n", "map", "-program", code(63), "-map_axes", "other,another", "-map_other", "0,1",
           "-map_another", "0,1", "-map_points", "2,2")
    refuse(mpmstab, "needed: 1 to 63 characters", "spectrum", "-program", code(4000))
    for length in LENGTHS:
        scene = f"formulation=usl,courant=0.{'5' * length}"
        refuse(mpmstab, "", "symbol", "-program", code(63), "-compare", scene)
        refuse(mpmstab, "-program_set", "spectrum", "-program", code(63), "-program_set", "p" * length)
        refuse(mpmstab, "eeeeeeee", "spectrum", "-program", code(63, length), "-program_set", f"{last}=2")


def check_options(mpmstab):
    """Values of options: those that no option has, of the command line, of a file of options and of a scene."""
    listed = start(mpmstab, "list", "options").stdout
    options = sorted(set(re.findall(r"^ *-?([a-z]\w+)  ", listed, re.M)))
    check({"formulation", "output", "json", "matrix", "map_axes", "compare"} <= set(options), f"options: {options}")
    for length in LENGTHS:
        value = "x" * length
        for name in ("formulation", "scheme", "output", "json", "csv", "boundary", "transfer", "courant", "ppc",
                     "drift", "checkpoint", "restart", "expect", "material"):
            given = [] if name in ("formulation", "courant", "scheme") else GIVEN
            refuse(mpmstab, "xxxxx", "run", *given, f"-{name}", value)
        for task, name in (("spectrum", "program"), ("spectrum", "plugin"), ("spectrum", "matrix"),
                           ("symbol", "matrix_blocks")):
            check_one_line(start(mpmstab, task, f"-{name}", value), f"-{name} of {length}", "xxxxxxxx")
        refuse(mpmstab, "map_axes", "map", *GIVEN[:2], "-map_axes", value)
        refuse(mpmstab, "unknown option", "run", *GIVEN, f"-{value}", "1")
        refuse(mpmstab, "xxxxxxxx", "run", value)
        check(start(mpmstab, value).returncode == 2, f"a task of {length} characters")
        done = start(mpmstab, "spectrum", *GIVEN, "-eps_type", value[:60000])
        check_one_line(done, "a solver with a long name", value[:60000])
        write("options", f"-formulation {value}\n")
        done = start(mpmstab, "run", "-options_file", "options", "-courant", "0.5")
        check(done.returncode == 2, f"a file of options: {done.returncode}, {done.stderr[:300]}")
        refuse(mpmstab, "formulation", "run", "-courant", "0.5", PETSC_OPTIONS=f"-formulation {value}")
        for text in (f"{PLAIN}{value}: 1\n", f"{PLAIN}transfer: {value}\n", f"{PLAIN}expect: {{{value}: 1}}\n",
                     f"{PLAIN}cells: [4, {value}]\n", f"{PLAIN}{value}\n",
                     SCHEME.format(particles=f", {value}: scalar", nodes="", line="DRIFT"),
                     SCHEME.format(particles="", nodes="", line=value),
                     SCHEME.format(particles="", nodes="", line="DRIFT") + f"  {value}: 1\n",
                     SCHEME.format(particles="", nodes="", line="DRIFT") + f"  parameters: {{a: {value}}}\n"):
            write("scene.yaml", text)
            refuse(mpmstab, "scene", "run", "scene.yaml")
        write("long.mtx", f"%%MatrixMarket matrix coordinate real general\n%{value}\n1 1 1\n1 1 0.5\n")
        check(start(mpmstab, "spectrum", "-matrix", "long.mtx").returncode == 0, "a long comment in a matrix")
        write("long.mtx", f"%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 {value}\n")
        refuse(mpmstab, "long.mtx", "spectrum", "-matrix", "long.mtx")


def check_numbers(mpmstab):
    """No number is cut: these have their last digits beyond what a buffer holds."""
    refuse(mpmstab, "-prestress", "run", *GIVEN, "-prestress", f"0.{'0' * 70}5e70")
    write("own.yaml", SCHEME.format(particles="", nodes="", line="DRIFT").replace("k STRESS", "a k STRESS") +
          "  parameters: {a: 1}\n" + f"courant: 0.5\na: 0.{'0' * 150}5e150\n")
    done = start(mpmstab, "run", "own.yaml", "-cells", "4", "-steps", "1")
    check(done.returncode == 2 or "a=0.5" in done.stdout.replace(" ", ""), f"{done.stdout} {done.stderr}")


def check_folders(mpmstab):
    """A path that is longer than any file's name."""
    deep = "/".join(["d" * 200] * 25)
    for name in ("json", "csv", "output", "checkpoint"):
        refuse(mpmstab, f"-{name}", "run", *GIVEN, f"-{name}", f"{deep}/a.h5")
    refuse(mpmstab, "dddd", "run", f"{deep}/scene.yaml")


def check_sources():
    """PetscStrlcat of PETSc 3.18 writes beyond the memory that it is given."""
    for path in pathlib.Path(ROOT, "src").rglob("*.[ch]"):
        check("PetscStrlcat(" not in path.read_text(encoding="utf-8"), f"{path}: PetscStrlcat; allowed: MpmTextJoin")


if sys.argv[1] == "--program":
    answer(int(sys.argv[2]), int(sys.argv[3]))
else:
    check_sources()
    for one in (check_schemes, check_programs, check_options, check_numbers, check_folders):
        one(sys.argv[2])
