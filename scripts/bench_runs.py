"""The programs that bench.py runs: mpmstab, plain C, numba, triad; and what there is to say of the machine."""
import json
import os
import re
import subprocess
import sys
import tempfile

import program

BUILD = os.path.dirname(os.path.abspath(program.PROGRAM))
FOLDER = os.path.join(BUILD, "bench")
SOURCES = os.path.join(program.ROOT, "scripts", "bench")
FLAGS = ["-O3", "-march=native"]
SCHEMES, BASES = ("gas1", "gas2", "elastic", "usl", "musl"), ("linear", "quadratic")
PPC = 2


def said(command, **more):
    done = subprocess.run(command, capture_output=True, text=True, check=False, **more)
    if done.returncode:
        program.refuse(f"{' '.join(command)}: status {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def compile_one(name, sources, defines=()):
    said(["cc", *FLAGS, *defines, "-o", os.path.join(FOLDER, name),
          *[os.path.join(SOURCES, source) for source in sources], "-lm"])


def compile_all():
    os.makedirs(FOLDER, exist_ok=True)
    compile_one("triad", ["triad.c"])
    for scheme in SCHEMES:
        for basis in BASES:
            defines = ["-DQUADRATIC"] if basis == "quadratic" else []
            compile_one(f"{scheme}-{basis}", ["plain.c", f"plain_{scheme}.c"], defines)


def numba_python():
    """The Python of an environment that has numba, made when it is not there; (None, why) when it cannot be."""
    folder = os.path.join(FOLDER, "venv")
    python = os.path.join(folder, "bin", "python")
    for command in ([sys.executable, "-m", "venv", folder], [python, "-m", "pip", "install", "-q", "numba"]):
        if os.path.exists(python) and subprocess.run([python, "-c", "import numba"], capture_output=True,
                                                     check=False).returncode == 0:
            break
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            return None, (done.stderr.strip() or done.stdout.strip()).splitlines()[-1]
    return python, None


def options(row):
    """One wave in 32 cells. At drifts 0.01 and 0.3 no particle meets a node, where rounding would decide."""
    cells = row["particles"] // PPC
    return {"formulation": row["scheme"], "basis": row["basis"], "ppc": PPC, "offset": 0.51, "courant": 0.01,
            "cells": cells, "mode": cells // 32, "steps": row["steps"], "drift": row["drift"]}


def run_mpmstab(row, ranks):
    """ns per particle and step, the energy at the end, bytes moved per particle and step."""
    status, found, error = program.launch("run", options=options(row), ranks=ranks)
    if status:
        program.refuse(f"mpmstab ended with status {status}: {error}")
    run = found["run"]
    return run["ns_per_particle_step"], run["energy"]["final"], run["bytes_per_particle_step"]


def run_plain(row):
    out = json.loads(said([os.path.join(FOLDER, f"{row['scheme']}-{row['basis']}"), str(row["particles"]),
                           str(row["steps"]), str(row["drift"])]))
    return out["ns_per_particle_step"], out["energy"]


def run_numba(python, row):
    out = json.loads(said([python, os.path.join(SOURCES, "numba_gas2.py"), str(row["particles"]), str(row["steps"]),
                           str(row["drift"]), row["basis"]]))
    return out["ns_per_particle_step"], out["energy"]


def triad(processes):
    """GB/s that so many processes draw together."""
    running = [subprocess.Popen([os.path.join(FOLDER, "triad")], stdout=subprocess.PIPE, text=True)
               for _ in range(processes)]
    return sum(float(one.communicate()[0].split()[0]) for one in running)


def peak_bytes(row, ranks):
    """Of each rank the largest resident size it ever had, added up."""
    words = [word for name, value in options(row).items() for word in (f"-{name}", str(value))]
    with tempfile.TemporaryDirectory() as folder:
        said(["mpirun", "-q", "-n", str(ranks), sys.executable, os.path.join(SOURCES, "peak.py"), folder,
              program.PROGRAM, "run", *words])
        peaks = []
        for name in os.listdir(folder):
            with open(os.path.join(folder, name), encoding="utf-8") as file:
                peaks.append(1024 * int(file.read()))
    if len(peaks) != ranks:
        program.refuse(f"{len(peaks)} of {ranks} ranks said how much memory they had")
    return sum(peaks)


def processor():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        found = re.search(r"model name\s*:\s*(.*)", file.read())
    return found.group(1) if found else "unknown"


def machine():
    with open(os.path.join(BUILD, "CMakeCache.txt"), encoding="utf-8") as file:
        cache = dict(re.findall(r"^(\w+):\w+=(.*)$", file.read(), re.M))
    revision = said(["git", "-C", program.ROOT, "describe", "--always", "--dirty", "--abbrev=12"]).strip()
    return {"processor": processor(), "cores": os.cpu_count(),
            "load": round(os.getloadavg()[0], 2),
            "compiler": said(["cc", "--version"]).splitlines()[0], "plain_flags": " ".join(FLAGS),
            "build": {name: cache.get(name, "") for name in ("CMAKE_BUILD_TYPE", "CMAKE_C_FLAGS", "MPMSTAB_NATIVE")},
            "revision": revision}
