#!/usr/bin/python3
"""Times the symbol and critical in two and three dimensions, and the eigenvalues of small matrices beside LAPACK's.

The seconds are those that the tasks say they took, best (median). The rate of the eigenvalues counts 40 n^3 operations
for a complex matrix of order n, as LAPACK does, and is compared with the rate of dgemm on one core in the same run.
"""
import json
import os
import tempfile

import bench_runs
import bench_spectrum
import program
from bench_runs import at_least, listed, met, told

ORDERS = (4, 20, 72, 144)  # 1-D; 2-D; 3-D; 3-D with apic: usl with two particles in each direction
RATE, RATE_ORDER = 1 / 3, 144  # of dgemm's
USL = {"formulation": "usl", "basis": "quadratic", "ppc": 2}


def arguments():
    parser = bench_runs.parser(__doc__, 3)
    parser.add_argument("--plane", type=at_least(4), default=256, help="phases in each of two directions (256)")
    parser.add_argument("--space", type=at_least(4), default=32, help="phases in each of three directions (32)")
    parser.add_argument("--turns", type=at_least(4), default=10, help="the same, of particles that move (10)")
    parser.add_argument("--drifts", type=listed(("0", "1/8")), default=("0", "1/8"), help="of critical (0,1/8)")
    parser.add_argument("--dims", type=listed((2, 3), int), default=(2, 3), help="of critical (2,3)")
    return parser.parse_args()


def rows(args, folder):
    """Yields name, task, options, ranks and target of each row; None for no target."""
    plane = USL | {"dim": 2, "cells": args.plane, "phases": f"{args.plane},{args.plane}"}
    space = USL | {"dim": 3, "cells": args.space, "phases": f"{args.space},{args.space},{args.space}"}
    kept = os.path.join(folder, "symbol.h5")
    yield f"symbol, {args.plane}^2 phases", "symbol", plane, 1, 1
    yield "the same, all factors of the full blocks, 2 ranks", "symbol", plane | {"output": kept}, 2, 60
    yield f"symbol, {args.plane}^2 phases, offset 0.3", "symbol", plane | {"offset": 0.3}, 1, None
    yield f"symbol, {args.space}^3 phases", "symbol", space, 1, None
    yield f"symbol, {args.space}^3 phases, apic", "symbol", space | {"transfer": "apic"}, 1, None
    turns = USL | {"dim": 3, "cells": args.turns, "phases": ",".join([str(args.turns)] * 3), "drift": "1/8"}
    for transfer in ("apic", "pic"):
        moving = turns | {"transfer": transfer}
        yield f"symbol, {args.turns}^3 phases, {transfer}, drift 1/8", "symbol", moving, 1, None
        yield "the same, all factors of the full blocks", "symbol", moving | {"output": kept}, 1, None
    for dim in args.dims:
        for drift in args.drifts:
            if dim == 3 and drift != "0":
                continue
            options = USL | {"dim": dim} | ({} if drift == "0" else {"drift": f"{drift},{drift}"})
            yield f"critical, dim {dim}, drift {drift}", "critical", options, 1, 0.1 if drift == "0" else 10


def measure_tasks(args):
    with tempfile.TemporaryDirectory() as folder:
        for name, task, options, ranks, target in rows(args, folder):
            seconds = bench_spectrum.time_task(task, options, args.repeats, ranks)
            said = f"; target {target} s: {met(seconds['best'] <= target)}" if target else ""
            print(f"{name}: {told(seconds)}{said}", flush=True)
            yield {"row": name, "task": task, "ranks": ranks, "target_s": target, "seconds": seconds}


def measure_factors():
    # one core beside one core: a thread of dgemm that waits would also be counted as time of the other solvers
    alone = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    text = bench_runs.said([bench_runs.compiled("factors"), *map(str, ORDERS)], env=alone)
    for line in text.splitlines():
        row = json.loads(line)
        dgemm = 2 * row["dgemm_order"] ** 3 / row["dgemm_s"]
        row["rate"] = 40 * row["order"] ** 3 / row["own_s"] / dgemm
        said = f"; target {RATE:.2f}: {met(row['rate'] >= RATE)}" if row["order"] == RATE_ORDER else ""
        print(f"all eigenvalues, order {row['order']}: {row['own_s'] * 1e6:.1f} us, "
              f"LAPACK {row['lapack_s'] * 1e6:.1f} us; {row['rate']:.2f} of dgemm's {dgemm / 1e9:.0f} Gflop/s{said}", flush=True)
        yield row


def main():
    args = arguments()
    result = bench_runs.begin("phases", args)
    result["blas"] = bench_spectrum.blas()
    result["tasks"] = list(measure_tasks(args))
    result["factors"] = list(measure_factors())
    bench_runs.keep(result, args)


if __name__ == "__main__":
    program.end_in_one_line(main)
