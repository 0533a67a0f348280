"""The parts of the benchmark share this: programs that they run, options, the machine, the history."""
import argparse
import concurrent.futures
import csv
import datetime
import functools
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), os.pardir))
import program  # noqa: E402 (the path comes first)

BUILD = os.path.dirname(os.path.abspath(program.PROGRAM))
FOLDER = os.path.join(BUILD, "bench")
SOURCES = os.path.join(program.ROOT, "scripts", "bench")
FLAGS = ["-O3", "-march=native"]
SCHEMES, BASES = ("gas1", "gas2", "elastic", "usl", "musl", "verlet", "rk4", "kg5"), ("linear", "quadratic")
STEPS = ("usl", "musl", "verlet", "rk4", "rk4 nodes", "kg5", "implicit")  # of momentum, beside one another
PLAIN_STEPS = {"flip": [], "verlet": ["-DVERLET"], "rk4": ["-DRK"], "kg5": ["-DRK", "-DFIVE"], "implicit": ["-DIMPLICIT"]}
IMPLICIT = {"courant": 5, "steps": 4}  # it has no limit, and a step has some fifty sweeps
MACH = "1/10"  # of particles that move, where a limit of the Courant number is asked for
PPC = 2
LAWS = {"neo": {}, "mises": {"yield": 0.002}, "snow": {}, "sand": {}, "clay": {"yield": 0.002}}  # in a wave in which all but the first flow
NODES = {"linear": 2, "quadratic": 3, "cubic": 4}  # of a particle along a direction
BOXES = {2: {"1e3": 16, "1e6": 500, "4e6": 1000}, 3: {"1e3": 6, "1e6": 50, "4e6": 80}}  # cells along each direction, by dimension and size
HISTORY = os.path.join(SOURCES, "history.jsonl")


def listed(allowed, kind=str):
    def parse(text):
        values = tuple(kind(word) for word in text.split(","))
        if allowed and set(values) - set(allowed):
            raise argparse.ArgumentTypeError(f"{text} is not some of {','.join(allowed)}")
        return values
    parse.__name__ = f"list of {kind.__name__}"  # argparse shows this name when it refuses
    return parse


def parser(description, repeats):
    """Returns a parser with the options that every part has."""
    result = program.Parser(description)
    result.add_argument("--repeats", type=at_least(1), default=repeats, help=f"runs of each row ({repeats})")
    result.add_argument("--history", default=HISTORY, metavar="FILE", help="where a line of JSON is added")
    result.add_argument("--no-history", action="store_true", help="keep no line of this run")
    return result


def at_least(least, kind=int):
    def number(text):
        value = kind(text)
        if value < least:
            raise argparse.ArgumentTypeError(f"{text} is less than {least}")
        return value
    number.__name__ = kind.__name__
    return number


def begin(part, args):
    """Prints the machine and returns what every run of the benchmark keeps; its part adds the rest."""
    program.require_program()
    if not args.no_history:
        program.require_outputs([args.history])
        with open(args.history, "a", encoding="utf-8"):  # it is refused now, not when all is done
            pass
    result = {"part": part, "date": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
              **machine(), "repeats": args.repeats}
    print(f"{result['processor']}, {result['cores']} cores, load {result['load']}; {result['compiler']}; "
          f"revision {result['revision']}", flush=True)
    return result


def keep(result, args):
    if not args.no_history:
        with open(args.history, "a", encoding="utf-8") as file:
            file.write(json.dumps(result) + "\n")


def best_and_median(seconds):
    return {"best": min(seconds), "median": statistics.median(seconds)}


def told(seconds):
    """Returns best (median), in units that fit."""
    units = ((1, "s"), (1e-3, "ms"), (1e-6, "us"))
    unit, name = next((one for one in units if seconds["best"] >= one[0]), (1e-9, "ns"))
    return f"{seconds['best'] / unit:.3g} ({seconds['median'] / unit:.3g}) {name}"


def met(is_met):
    return "met" if is_met else "not met"


def compiled(name):
    """Returns the path of a program that the build has made for the benchmark."""
    path = os.path.join(FOLDER, name)
    if not os.path.exists(path):
        program.refuse(f"there is no {path}; ./scripts/setup.sh builds it beside mpmstab (MPMSTAB names that)")
    return path


def memory_available():
    with open("/proc/meminfo", encoding="utf-8") as file:
        return 1024 * int(re.search(r"MemAvailable:\s*(\d+)", file.read()).group(1))


def result_of_run(task, options, ranks=1):
    """Runs mpmstab and returns its JSON."""
    status, found, error = program.launch(task, options=options, ranks=ranks)
    if status:
        program.refuse(f"mpmstab {task} ended with status {status}: {error}")
    return found


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
            defines = (["-DQUADRATIC"] if basis == "quadratic" else []) + (["-DFIVE"] if scheme == "kg5" else [])
            source = "rk" if scheme in ("rk4", "kg5") else scheme
            compile_one(f"{scheme}-{basis}", ["plain.c", f"plain_{source}.c"], defines)
    for dim in BOXES:
        for nodes in NODES.values():
            for name, defines in PLAIN_STEPS.items():
                compile_one(f"{name}-{dim}d-{nodes}", ["plain_nd.c"], [f"-DDIM={dim}", f"-DNODES={nodes}", *defines])
            if nodes > 2:
                compile_one(f"apic-{dim}d-{nodes}", ["plain_nd.c"], [f"-DDIM={dim}", f"-DNODES={nodes}", "-DAFFINE"])


def compile_finite():
    os.makedirs(FOLDER, exist_ok=True)
    for dim in BOXES:
        compile_one(f"finite-{dim}d", ["plain_finite.c"], [f"-DDIM={dim}", "-DNODES=3"])


def numba_python():
    """Returns the Python of an environment with numba, which it makes when needed; (None, why) when it cannot."""
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


def formulation(scheme):
    """Returns the options of a scheme, such as 'rk4 nodes'."""
    method, *on = scheme.split()
    chosen = {"formulation": "rk", "rk": method} if method in ("rk4", "kg5") else {"formulation": method}
    return chosen | ({"rk_on": on[0]} if on else {})


@functools.lru_cache(maxsize=None)
def limit(scheme, basis, moves):
    """Returns the largest Courant number without growth in one dimension, at rest or at Mach 1/10; 0 where there is none."""
    chosen = formulation(scheme) | {"basis": basis} | ({"mach": MACH} if moves else {})
    return result_of_run("critical", chosen)["critical"].get("critical_courant", 0)


def covered(scheme, basis, moves, ns, particles):
    """Returns c t / h, the time that a second of run time covers at the limit. None: the scheme is none of momentum."""
    if scheme not in STEPS:
        return None
    if scheme == "implicit":
        return IMPLICIT["courant"] / (1e-9 * ns * particles)
    return limit(scheme, basis, moves) / (1e-9 * ns * particles)


def options(row):
    """Returns the options of a run: one wave in 32 cells. At drifts 0.01 and 0.3 no particle meets a node."""
    cells = row["particles"] // PPC
    return formulation(row["scheme"]) | {"basis": row["basis"], "ppc": PPC, "offset": 0.51, "courant": 0.01,
            "cells": cells, "mode": cells // 32, "steps": row["steps"], "drift": row["drift"]}


def box_options(row):
    """Returns the options of usl in a box: with flip, or with apic and the gradients of MLS-MPM."""
    affine = {"transfer": "apic", "gradient": "mls"} if row["transfer"] == "apic" else {}
    return {"dim": row["dim"], "cells": row["cells"], "formulation": "usl", "basis": row["basis"], "poisson": 0.3,
            "ppc": PPC, "offset": 0.51, "courant": 0.01, "mode": 1, "steps": row["steps"], "drift": row["drift"],
            "jitter": row["jitter"], **affine}


def run_box(row, ranks):
    """Returns ns per particle and step, and the energy at the end."""
    run = result_of_run("run", box_options(row), ranks)["run"]
    return run["ns_per_particle_step"], run["energy"]["final"]


def run_finite(row, ranks):
    """Returns ns per particle and step of a march at finite strain, and the energy at the end."""
    chosen = {"dim": row["dim"], "cells": row["cells"], "formulation": "usl", "kinematics": "finite", "material": "neo",
              "lame_ratio": 1, "basis": "quadratic", "ppc": PPC, "offset": 0.51, "courant": 0.1, "mode": 1,
              "amplitude": row["amplitude"], "steps": row["steps"], "drift": row["drift"]} | row.get("law", {})
    run = result_of_run("run", chosen, ranks)["run"]
    return run["ns_per_particle_step"], run["energy"]["final"]


def run_bounds(row):
    """Returns seconds of a march that chooses its steps, of its passes, of the bounds that it finds, and how often it found them."""
    chosen = {"dim": row["dim"], "cells": row["cells"], "formulation": "usl", "transfer": "apic", "kinematics": "finite",
              "material": "neo", "basis": row["basis"], "ppc": PPC, "jitter": 0.5, "initial": "random", "amplitude": 0.01,
              "mach": MACH, "courant": "auto", "steps": row["steps"]}
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "log.csv")
        run = result_of_run("run", chosen | {"log_view": f":{path}:ascii_csv"}, 1)["run"]
        with open(path, encoding="utf-8", newline="") as file:
            seconds = {line["Event Name"]: float(line["Time"]) for line in csv.DictReader(file)}
    found = {name: seconds.get(name, 0) for name in ("MpmPass", "MpmGridSum", "MpmMigrate", "MpmWatch", "MpmCertificate")}
    return found | {"looks": run["courant_auto"]["looks"], "certificates": run["courant_auto"]["certificates"],
                    "steps": row["steps"]}


def run_plain_finite(row):
    out = json.loads(said([os.path.join(FOLDER, f"finite-{row['dim']}d"),
                           *[str(row[key]) for key in ("cells", "steps", "drift", "amplitude")]]))
    return out["ns_per_particle_step"], out["energy"]


def run_box_pair(row):
    """Returns ns per particle and step of two independent programs side by side, each with half the cells along x."""
    half = row | {"cells": ",".join([str(row["cells"] // 2)] + [str(row["cells"])] * (row["dim"] - 1))}
    with concurrent.futures.ThreadPoolExecutor(2) as threads:
        return max(found[0] for found in threads.map(run_box, (half, half), (1, 1))) / 2


def run_step(row, step):
    """Returns ns per particle and step of one of the steps of momentum, and the energy at the end."""
    more = IMPLICIT if step == "implicit" else {}
    run = result_of_run("run", box_options(row) | formulation(step) | more)["run"]
    return run["ns_per_particle_step"], run["energy"]["final"]


def run_plain_box(row, name=None):
    name = f"{name or row['transfer']}-{row['dim']}d-{NODES[row['basis']]}"
    out = json.loads(said([os.path.join(FOLDER, name),
                           *[str((row | (IMPLICIT if name.startswith("implicit") else {}))[key])
                             for key in ("cells", "steps", "drift", "jitter")]]))
    return out["ns_per_particle_step"], out["energy"]


def run_mpmstab(row, ranks):
    """Returns ns per particle and step, the energy at the end, and bytes moved per particle and step."""
    run = result_of_run("run", options(row), ranks)["run"]
    return run["ns_per_particle_step"], run["energy"]["final"], run["bytes_per_particle_step"]


def run_two_ranks(row):
    """Returns the same on 2 ranks, and which part of its steps a rank spent in sums over ranks, in the mean.

    Messages take microseconds of it. In the rest one rank waits for the other.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "log.csv")
        run = result_of_run("run", options(row) | {"log_view": f":{path}:ascii_csv"}, 2)["run"]
        with open(path, encoding="utf-8", newline="") as file:
            sums = [float(line["Time"]) for line in csv.DictReader(file) if line["Event Name"] == "MpmGridSum"]
    return (run["ns_per_particle_step"], run["energy"]["final"], run["bytes_per_particle_step"],
            sum(sums) / len(sums) / run["loop_s"])


def run_pair(row):
    """Returns ns per particle and step of two independent programs side by side, each with half the particles.

    This is how much faster two cores of this machine can be when they send no messages.
    """
    half = row | {"particles": row["particles"] // 2}
    with concurrent.futures.ThreadPoolExecutor(2) as threads:
        return max(found[0] for found in threads.map(run_mpmstab, (half, half), (1, 1))) / 2


def run_plain(row):
    out = json.loads(said([os.path.join(FOLDER, f"{row['scheme']}-{row['basis']}"), str(row["particles"]),
                           str(row["steps"]), str(row["drift"])]))
    return out["ns_per_particle_step"], out["energy"]


def run_numba(python, row):
    out = json.loads(said([python, os.path.join(SOURCES, "numba_gas2.py"), str(row["particles"]), str(row["steps"]),
                           str(row["drift"]), row["basis"]]))
    return out["ns_per_particle_step"], out["energy"]


def triad(processes):
    """Returns the GB/s that so many processes move together."""
    running = [subprocess.Popen([os.path.join(FOLDER, "triad")], stdout=subprocess.PIPE, text=True)
               for _ in range(processes)]
    return sum(float(one.communicate()[0].split()[0]) for one in running)


def peak_bytes(chosen, ranks):
    """Returns the largest resident sizes of the ranks of a run with options, added up."""
    words = [word for name, value in chosen.items() for word in (f"-{name}", str(value))]
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
