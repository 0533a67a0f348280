#!/usr/bin/python3
"""Marches gas2 beside the plain C loop, interleaved, and prints best and median time with their ratios.

The machine's speed drifts by tens of per cent within minutes: only ratios of runs that alternate mean anything. Both
programs end with the same energy (checked), so they do the same work.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile


def plain(args, drift):
    out = subprocess.run([args.plain, str(args.particles), "2", str(args.steps), drift], capture_output=True, text=True,
                         check=True)
    result = json.loads(out.stdout)
    return result["ns_per_particle_step"], result["energy"]


def mpmstab(args, drift, ranks):
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "run.json")
        subprocess.run(["mpirun", "-n", str(ranks), args.mpmstab, "run", "-formulation", "gas2", "-ppc", "2", "-cells",
                        str(args.particles // 2), "-courant", "0.5", "-drift", drift, "-steps", str(args.steps), "-json",
                        path], capture_output=True, text=True, check=True)
        with open(path) as file:
            run = json.load(file)["run"]
    return run["ns_per_particle_step"], run["energy"]["final"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mpmstab", default="build/mpmstab")
    parser.add_argument("--plain", default="build/gas2_plain")
    parser.add_argument("--particles", type=int, default=8000000)
    parser.add_argument("--steps", type=int, default=20)
    parser.add_argument("--repeats", type=int, default=7)
    args = parser.parse_args()

    print(f"gas2, {args.particles} particles, 2 a cell, {args.steps} steps; ns per particle and step, median (best) of "
          f"{args.repeats} interleaved runs\n")
    print(f"{'drift':>6}  {'plain C':>16}  {'1 rank':>16}  {'2 ranks':>16}  {'1 rank/plain':>12}  {'speed-up of 2':>13}")
    for drift in ("0", "0.01", "0.3"):
        times = {"plain": [], 1: [], 2: []}
        for _ in range(args.repeats):
            for key in times:
                ns, energy = plain(args, drift) if key == "plain" else mpmstab(args, drift, key)
                times[key].append(ns)
                if key == "plain":
                    expected = energy
                elif abs(energy - expected) > 1e-9 * expected:
                    sys.exit(f"bench: the two programs disagree: energy {energy} and {expected}")
        median = {key: statistics.median(values) for key, values in times.items()}
        cells = "  ".join(f"{median[key]:8.2f} ({min(times[key]):5.2f})" for key in times)
        ratio = statistics.median(a / b for a, b in zip(times[1], times["plain"]))
        speedup = statistics.median(a / b for a, b in zip(times[1], times[2]))
        print(f"{drift:>6}  {cells}  {ratio:12.2f}  {speedup:13.2f}", flush=True)


if __name__ == "__main__":
    main()
