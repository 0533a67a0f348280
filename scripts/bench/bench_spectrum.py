#!/usr/bin/python3
"""Times assembly, eigenvalues, symbol, critical and map; eigenvalues beside ARPACK (scipy) and LAPACK (numpy).

The matrices are those of gas2 on hats with two particles a cell, as mpmstab assembles them. All solvers of a row run in
turn. The seconds are those of the solvers alone, best (median). When two solvers have not found the same, the row says
so in place of a ratio, and the status is 1. The ratio of the best times is compared with the target.
"""
import csv
import json
import math
import os
import re
import subprocess
import sys
import tempfile

import bench_runs
import program
from bench_runs import at_least, best_and_median, listed, met, told

AWAY = 0.05                     # distance from 1 of a target
OF_UNKNOWN = 2400               # bytes of memory for eigenvalues near a target
DENSE_ORDER = 4096               # up to this order mpmstab takes all eigenvalues
BESIDE = 1e-10                   # how far a shift is from the eigenvalue, relatively, as in mpmstab
SAME, SAME_GROWTH = 1e-8, 1e-6   # a defective pair at 1 splits by 1e-8 or more
TIMES_ARPACK, TIMES_NUMPY, CRITICAL_S, MAP_S = 3, 2, 0.1, 10
TIMES_ALL_PARTICLES = 5          # of the ensemble by the nodes' own operators, beside the particles'
BAR = {"formulation": "usl", "courant": 0.5, "ppc": 4, "jitter": 0.9, "measure": "false"}
ENSEMBLE = {"formulation": "usl", "courant": 0.7, "cells": 100, "ppc": 4, "jitter": 0.9}
BOX = {"formulation": "usl", "courant": 0.5, "ppc": 2, "measure": "false"}
BAR_CELLS, PLANE_CELLS, SPACE_CELLS, JITTER, POWERS = 1000, 256, 24, 0.8, 200
SCHEMES, BASES, DRIFTS = ("gas2", "usl", "musl"), ("linear", "quadratic"), ("0", "1/8")


def arguments():
    parser = bench_runs.parser(__doc__, 3)
    parser.add_argument("--orders", type=listed((), int), default=(400_000,), help="of solves near a target")
    parser.add_argument("--dense", type=listed((), int), default=(2000,), help="orders of which to take all")
    parser.add_argument("--restarts", type=at_least(1), default=100, help="of ARPACK without shift-invert (100)")
    parser.add_argument("--symbol", type=at_least(2), default=1_000_000, metavar="CELLS", help="(1000000)")
    parser.add_argument("--map", type=at_least(2), default=64, metavar="POINTS", help="of a map, along each axis (64)")
    parser.add_argument("--layouts", type=at_least(2), default=20, help="of the ensembles (20)")
    parser.add_argument("--bar", type=at_least(8), default=BAR_CELLS, help=f"cells of a jittered bar ({BAR_CELLS})")
    parser.add_argument("--plane", type=at_least(4), default=PLANE_CELLS, help=f"cells in each of two directions ({PLANE_CELLS})")
    parser.add_argument("--space", type=at_least(4), default=SPACE_CELLS, help=f"cells in each of three ({SPACE_CELLS})")
    parser.add_argument("--all", action="store_true", 
                        help="orders 4e5 and 4e6, all of 2000 and 4000, the map of 256, 200 layouts")
    args = parser.parse_args()
    if args.all:
        args.orders, args.dense, args.map, args.layouts = (400_000, 4_000_000), (2000, 4000), 256, 200
    if min(args.orders) <= DENSE_ORDER or any(order % 4 for order in args.orders + args.dense):
        parser.error(f"--orders: no multiples of 4 beyond {DENSE_ORDER}; or --dense: no multiples of 4")
    if not 8 <= min(args.dense) <= max(args.dense) <= DENSE_ORDER:
        parser.error(f"--dense: not from 8 to {DENSE_ORDER}")
    return args


def scene(order):
    return {"formulation": "gas2", "basis": "linear", "ppc": 2, "courant": 0.5, "cells": order // 4}


def write_matrix(order, path):
    words = [word for name, value in scene(order).items() for word in (f"-{name}", str(value))]
    bench_runs.said([bench_runs.compiled("operator"), path, *words])


def python_solver(*words):
    """Returns what the solver found, or {"why"} when it gave no answer."""
    script = os.path.join(bench_runs.SOURCES, "scipy_spectrum.py")
    done = subprocess.run([sys.executable, script, *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode:
        return {"why": (done.stderr.strip().splitlines() or [f"status {done.returncode}"])[-1]}
    return json.loads(done.stdout)


def own_spectrum(order, folder):
    """Returns the JSON of spectrum with the leading eigenvalue that is away from 1, which is ARPACK's target."""
    path = os.path.join(folder, "eigenvalues.csv")
    found = bench_runs.result_of_run("spectrum", scene(order) | {"measure": "false", "csv": path})["spectrum"]
    with open(path, encoding="utf-8", newline="") as file:
        values = [complex(float(row["re"]), float(row["im"])) for row in csv.DictReader(file)]
    value = max((z for z in values if abs(z - 1) > AWAY and z.imag >= 0), key=abs, default=complex(math.nan, math.nan))
    found["target"] = [value.real, value.imag]
    return found


def compare_near(order, args, folder):
    """Measures a row: assembly, and the eigenvalue nearest to the symbol's target beside ARPACK's."""
    need, free = OF_UNKNOWN * order, bench_runs.memory_available()
    if need > free:
        return {"order": order, "why": f"it takes {need / 1e9:.1f} GB, {free / 1e9:.1f} are free"}
    matrix = os.path.join(folder, "A")
    write_matrix(order, matrix)
    assembly, solve, arpack, theirs = [], [], [], {}
    for _ in range(args.repeats):
        own = own_spectrum(order, folder)
        if math.isnan(own["target"][0]):
            program.refuse(f"mpmstab lists no eigenvalue away from 1 at order {order}: solver {own['solver']}")
        assembly.append(own["assemble_s"])
        solve.append(own["solve_s"])
        if "why" not in theirs:
            theirs = python_solver("near", matrix, *(part * (1 + BESIDE) for part in own["target"]))
            arpack += [theirs["seconds"]] if "seconds" in theirs else []
    row = {"order": order, "nonzeros": own["nonzeros"], "target": own["target"], "mpmstab_found": own["target"],
           "assembly": best_and_median(assembly), "mpmstab": best_and_median(solve), "arpack_found": theirs,
           "arpack_alone": python_solver("largest", matrix, args.restarts)}
    if "why" not in theirs:
        row["arpack"] = best_and_median(arpack)
        row["difference"] = abs(complex(*row["mpmstab_found"]) - complex(theirs["re"], theirs["im"]))
        row["same"] = row["difference"] <= SAME
        row["ratio"] = row["arpack"]["best"] / row["mpmstab"]["best"]
    return row


def show_near(row):
    print(f"order {row['order']}: ", end="")
    if "why" in row:
        print(f"left out, {row['why']}")
        return
    per = {name: value / row["nonzeros"] for name, value in row["assembly"].items()}
    print(f"{row['nonzeros']} nonzeros assembled in {told(row['assembly'])}, {told(per)} each")
    print(f"  one near {row['target'][0]:.9g}{row['target'][1]:+.9g}i: {told(row['mpmstab'])}; ARPACK, shift-invert: ",
          end="")
    if "arpack" not in row:
        print(f"no answer ({row['arpack_found']['why']})")
    elif not row["same"]:
        print(f"another eigenvalue, {row['difference']:.3g} away: not compared")
    else:
        print(f"{told(row['arpack'])}, the same to {row['difference']:.1e}\n    {row['ratio']:.2f} times as fast; "
              f"target {TIMES_ARPACK}: {met(row['ratio'] >= TIMES_ARPACK)}")
    alone = row["arpack_alone"]
    if "why" in alone:
        print(f"  ARPACK without shift-invert: no answer ({alone['why']})")
    else:
        print(f"  ARPACK without shift-invert: {alone['converged']} of 1 converged after {alone['restarts']} restarts, "
              f"{alone['seconds']:.3g} s: " + (f"abs {alone['size']:.9g}" if alone["converged"] else "no answer"))


def compare_all(order, args, folder):
    """Measures a row: all eigenvalues beside numpy's. The largest abs must agree; rounding splits most others."""
    matrix = os.path.join(folder, "A")
    write_matrix(order, matrix)
    times = {"mpmstab": [], "eig": [], "eigvals": []}
    for _ in range(args.repeats):
        own, theirs = own_spectrum(order, folder), python_solver("all", matrix)
        if "why" in theirs:
            return {"order": order, "why": f"numpy: {theirs['why']}"}
        for name, seconds in (("mpmstab", own["solve_s"]), ("eig", theirs["eig_s"]), ("eigvals", theirs["eigvals_s"])):
            times[name].append(seconds)
    row = {"order": order, **{name: best_and_median(seconds) for name, seconds in times.items()},
           "listed": own["listed"], "mpmstab_radius": own["spectral_radius"], "numpy_radius": theirs["radius"]}
    row["difference"] = abs(row["mpmstab_radius"] - row["numpy_radius"])
    row["same"] = row["difference"] <= SAME_GROWTH and own["listed"] == theirs["count"] == order
    for name in ("eig", "eigvals"):
        row[f"ratio_{name}"] = row["mpmstab"]["best"] / row[name]["best"]
    return row


def show_all(row):
    if "why" in row:
        print(f"all of order {row['order']}: not compared, {row['why']}")
        return
    print(f"all of order {row['order']}: {told(row['mpmstab'])}; numpy.linalg.eig {told(row['eig'])}, "
          f"eigvals {told(row['eigvals'])}")
    if not row["same"]:
        print(f"  {row['listed']} found, largest abs {row['difference']:.3g} from numpy's: not compared")
        return
    print(f"  the largest abs agrees to {row['difference']:.1e}; mpmstab takes {row['ratio_eig']:.2f} of the time of eig, which "
          f"finds vectors, too (target {TIMES_NUMPY}: {met(row['ratio_eig'] <= TIMES_NUMPY)}), and {row['ratio_eigvals']:.2f} of "
          "that of eigvals")


def nodal_scenes(args):
    """Yields name, options, ranks and target of each row; None for a size that has no target."""
    yield (f"all eigenvalues of a jittered bar, {args.bar} cells", BAR | {"cells": args.bar}, 1,
           5 if args.bar == BAR_CELLS else None)
    for dim, cells, full, target in ((2, args.plane, PLANE_CELLS, 60), (3, args.space, SPACE_CELLS, 120)):
        for jitter in (0, JITTER):
            yield (f"{dim}-D, {cells} cells in each direction{', jittered' if jitter else ''}",
                   BOX | {"dim": dim, "cells": ",".join([str(cells)] * dim), "jitter": jitter}, 2,
                   target if cells == full else None)


def nodal_rows(args):
    """Measures what the nodes' own operator makes possible, once each, and prints each row at once."""
    for name, options, ranks, target in nodal_scenes(args):
        found = bench_runs.result_of_run("spectrum", options, ranks)
        row = {"what": name, "ranks": ranks, "seconds": found["wall_s"], "verdict": found["verdict"],
               "unknowns": found["spectrum"]["unknowns"], "nodal_unknowns": found["spectrum"].get("nodal_unknowns"),
               "listed": found["spectrum"]["listed"], "memory_bytes": found["spectrum"]["memory_bytes"]}
        nodal = f" ({row['nodal_unknowns']} are of the nodes)" if row["nodal_unknowns"] else ""
        print(f"{name}, order {row['unknowns']}{nodal}, {ranks} rank{'s'[:ranks > 1]}: {row['listed']} found, "
              f"{row['verdict']}, {row['seconds']:.3g} s in all, {row['memory_bytes'] / 1e6:.4g} MB" +
              (f"; target {target} s: {met(row['seconds'] <= target)}" if target else ""), flush=True)
        yield row


def compare_powers(args):
    """Measures norms of powers by the nodes' own operator and by the particles', in turn."""
    options = BAR | {"cells": args.bar // 4, "powers": POWERS}
    times, norms = {"true": [], "false": []}, {}
    for _ in range(args.repeats):
        for nodal in times:
            found = bench_runs.result_of_run("spectrum", options | {"nodal": nodal})["transient"]
            times[nodal].append(found["seconds"])
            norms[nodal] = found["norm"]
    row = {"cells": args.bar // 4, "powers": POWERS, "nodal": best_and_median(times["true"]),
           "particles": best_and_median(times["false"]),
           "apart": max(abs(a / b - 1) for a, b in zip(norms["true"], norms["false"]))}
    row["ratio"], row["same"] = row["particles"]["best"] / row["nodal"]["best"], row["apart"] <= SAME
    print(f"norm(A^n) for n up to {POWERS}, {row['cells']} cells, ppc {BAR['ppc']}: {told(row['nodal'])}; with -nodal false "
          f"{told(row['particles'])}: {row['ratio']:.3g} times as fast, the same to {row['apart']:.1e}", flush=True)
    return row


def compare_ensembles(args):
    """Measures ensembles by the nodes' own operators and by the particles', in turn."""
    options = ENSEMBLE | {"layouts": args.layouts}
    times, grown = {"true": [], "false": []}, {"true": set(), "false": set()}
    for _ in range(args.repeats):
        for nodal in times:
            found = bench_runs.result_of_run("ensemble", options | {"nodal": nodal})["ensemble"]
            times[nodal].append(found["seconds"])
            grown[nodal].add((found["unstable"], found["undecided"]))
    row = {"layouts": args.layouts, "nodal": best_and_median(times["true"]),
           "particles": best_and_median(times["false"]), "same": grown["true"] == grown["false"]}
    row["ratio"] = row["particles"]["best"] / row["nodal"]["best"]
    print(f"ensemble of {args.layouts} layouts, {ENSEMBLE['cells']} cells, ppc {ENSEMBLE['ppc']}: "
          f"{told(row['nodal'])}; with -nodal false {told(row['particles'])}: " +
          (f"{row['ratio']:.3g} times as fast; target {TIMES_ALL_PARTICLES}: {met(row['ratio'] >= TIMES_ALL_PARTICLES)}"
           if row["same"] else "other verdicts, not compared"), flush=True)
    return row


def time_task(task, options, repeats, ranks=1):
    """Returns the seconds that the task says it took."""
    return best_and_median([bench_runs.result_of_run(task, options, ranks)[task]["seconds"] for _ in range(repeats)])


def small_tasks(args):
    """Measures the rows of symbol, critical and map and prints each at once."""
    for ppc in (1, 2, 4):
        row = {"task": "symbol", "cells": args.symbol, "ppc": ppc}
        row["seconds"] = time_task("symbol", {"cells": args.symbol, "ppc": ppc}, args.repeats)
        print(f"symbol, {args.symbol} cells, ppc {ppc}: {told(row['seconds'])}", flush=True)
        yield row
    for scheme, basis, drift in ((s, b, d) for s in SCHEMES for b in BASES for d in DRIFTS):
        row = {"task": "critical", "scheme": scheme, "basis": basis, "drift": drift}
        row["seconds"] = time_task("critical", {"formulation": scheme, "basis": basis, "drift": drift}, args.repeats)
        print(f"critical, {scheme} {basis}, drift {drift}: {told(row['seconds'])}; target {CRITICAL_S} s: "
              f"{met(row['seconds']['best'] <= CRITICAL_S)}", flush=True)
        yield row
    row = {"task": "map", "points": args.map, "ranks": 2}
    repeats = 1 if args.map >= 256 else args.repeats
    row["seconds"] = time_task("map", {"map_points": f"{args.map},{args.map}"}, repeats, 2)
    target = f"; target {MAP_S} s: {met(row['seconds']['best'] <= MAP_S)}" if args.map == 256 else ""
    print(f"map of {args.map} x {args.map} points, 2 ranks: {told(row['seconds'])}{target}")
    yield row


def blas():
    """Returns the BLAS that mpmstab loads, and the number of threads that it may take."""
    found = re.findall(r"=> (\S*blas\S*)", bench_runs.said(["ldd", program.PROGRAM]))
    names = sorted({os.path.realpath(path) for path in found})
    return {"library": " ".join(names) or "not known", "OMP_NUM_THREADS": os.environ.get("OMP_NUM_THREADS", "not set")}


def main():
    args = arguments()
    result = bench_runs.begin("spectrum", args)
    result["blas"] = blas()
    print(f"BLAS {result['blas']['library']}, OMP_NUM_THREADS {result['blas']['OMP_NUM_THREADS']}\n")
    with tempfile.TemporaryDirectory() as folder:
        result["near"], result["all"] = [], []
        for order in args.orders:
            result["near"].append(compare_near(order, args, folder))
            show_near(result["near"][-1])
        for order in args.dense:
            result["all"].append(compare_all(order, args, folder))
            show_all(result["all"][-1])
    result["nodal"], result["powers"] = list(nodal_rows(args)), compare_powers(args)
    result["ensemble"] = compare_ensembles(args)
    result["tasks"] = list(small_tasks(args))
    bench_runs.keep(result, args)
    if not all(row.get("same", True) for row in result["near"] + result["all"] + [result["powers"], result["ensemble"]]):
        program.say("not the same eigenvalues, see above")
        sys.exit(1)


if __name__ == "__main__":
    program.end_in_one_line(main)
