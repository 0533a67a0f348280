"""MLS-MPM in three dimensions beside Taichi and Warp, each in double precision on the processor.

They are installed into an environment in a temporary folder, which is deleted at the end; one that cannot be is left out,
with its reason. Theirs is a fluid, with one number for the stress of a particle; ours is usl with apic and the gradients
of MLS-MPM, with a stress of six. So the ratio says what each takes for a step, not that they do the same.
"""
import json
import os
import subprocess
import sys
import tempfile

import bench_runs

CELLS, STEPS = 50, 10
PACKAGES = {"taichi": ("taichi", "taichi_mpm3d.py", ((1,), (2,))), "warp": ("warp-lang", "warp_mpm3d.py", ((),))}
LONGEST = 900  # seconds of an installation, or of a run with its compilation


def tried(command, **more):
    """Returns what a command prints, or (None, why)."""
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=LONGEST, **more)
    except (OSError, subprocess.TimeoutExpired) as error:
        return None, str(error)
    if done.returncode:
        return None, ((done.stderr.strip() or done.stdout.strip()).splitlines() or [f"status {done.returncode}"])[-1]
    return done.stdout, None


def installed(package, folder):
    """Returns the Python of an environment in a folder that has a package, or (None, why)."""
    python = os.path.join(folder, "bin", "python")
    for command in ([sys.executable, "-m", "venv", folder], [python, "-m", "pip", "install", "-q", package]):
        found, why = tried(command)
        if found is None:
            return None, why
    return python, None


def time_one(python, script, words, folder):
    """Returns ns per particle and step, or (None, why)."""
    found, why = tried([python, os.path.join(bench_runs.SOURCES, script), str(CELLS), str(STEPS), *map(str, words)],
                       env=os.environ | {"WARP_CACHE_PATH": folder, "TI_OFFLINE_CACHE": "0"})
    return (json.loads(found.splitlines()[-1])["ns_per_particle_step"], None) if found else (None, why)


def own(ranks):
    row = {"dim": 3, "cells": CELLS, "basis": "quadratic", "transfer": "apic", "drift": "0", "jitter": "0.4",
           "steps": STEPS}
    return bench_runs.run_box(row, ranks)[0]


def measure(repeats):
    """Prints a row for each package and number of threads beside ours, by turns, and returns them."""
    rows = []
    print("\nMLS-MPM in three dimensions, quadratic splines, f64: ns per particle and step, best of "
          f"{repeats}; ours is usl with apic, jittered")
    for name, (package, script, runs) in PACKAGES.items():
        with tempfile.TemporaryDirectory() as folder:
            python, why = installed(package, folder)
            for words in runs if python else ():
                threads, times = (words or (1,))[0], {name: [], "mpmstab": []}
                for _ in range(repeats):
                    found, why = time_one(python, script, words, folder)
                    if found is None:
                        break
                    times[name].append(found)
                    times["mpmstab"].append(own(threads))
                if why:
                    break
                best = {program: min(values) for program, values in times.items()}
                rows.append({"package": name, "threads": threads, "best": best})
                print(f"{name:7} {threads} thread{'s' * (threads > 1):1} {best[name]:8.1f}   mpmstab, {threads} "
                      f"rank{'s' * (threads > 1):1} {best['mpmstab']:8.1f}   ratio {best['mpmstab'] / best[name]:.3f}",
                      flush=True)
            if why:
                print(f"{name}: left out: {why}", flush=True)
                rows.append({"package": name, "left_out": why})
    return rows
