#!/usr/bin/python3
"""Times mpmstab's start and end beside those of a program that only initialises and finalises SLEPc, in turn.

The script takes wall time from the outside, best (median), without mpirun and under it. The difference of the best is
compared with the target.
"""
import subprocess
import time

import bench_runs
import program
from bench_runs import best_and_median, met, told

BEYOND_S = 0.1
LAUNCHERS = {"without mpirun": [], "mpirun -n 1": "mpirun -q -n 1".split(), "mpirun -n 2": "mpirun -q -n 2".split()}


def seconds_of(command):
    start = time.perf_counter()
    done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    seconds = time.perf_counter() - start
    if done.returncode:
        program.refuse(f"{' '.join(command)}: status {done.returncode}: {done.stderr.strip()}")
    return seconds


def measure(launcher, repeats):
    """Returns best and median of each program."""
    programs = {"SLEPc alone": [bench_runs.compiled("startup")], "list": [program.PROGRAM, "list"],
                "symbol": [program.PROGRAM, "symbol", "-cells", "8"]}
    times = {name: [] for name in programs}
    for _ in range(repeats):
        for name, command in programs.items():
            times[name].append(seconds_of([*launcher, *command]))
    return {name: best_and_median(seconds) for name, seconds in times.items()}


def main():
    args = bench_runs.parser(__doc__, 9).parse_args()
    result = bench_runs.begin("startup", args)
    result["rows"] = []
    print(f"\n{'':15} {'SLEPc alone':20} {'':8} {'mpmstab':20} beyond it  target {BEYOND_S} s")
    for name, launcher in LAUNCHERS.items():
        times = measure(launcher, args.repeats)
        row = {"launcher": name, "seconds": times, "beyond": {}}
        for task in ("list", "symbol"):
            row["beyond"][task] = times[task]["best"] - times["SLEPc alone"]["best"]
            print(f"{name:15} {told(times['SLEPc alone']):20} {task:8} {told(times[task]):20} "
                  f"{row['beyond'][task]:7.3f} s  {met(row['beyond'][task] <= BEYOND_S)}", flush=True)
        result["rows"].append(row)
    bench_runs.keep(result, args)


if __name__ == "__main__":
    program.end_in_one_line(main)
