#!/usr/bin/python3
"""Times the march and the spectrum over sizes and fits how the cost grows: seconds = constant x size^exponent.

The scene is gas2 on hats with two particles a cell, at rest. The exponent comes from least squares in logarithms over
the sizes from --from on, since smaller ones fit into caches or are over too soon. For the march the script times a
step; for the spectrum it times assembly and the eigenvalues near a target. Up to order 4096 the program takes all
eigenvalues, and these times are not fitted. Each time is the best of the repeats.
"""
import math

import bench_runs
import bench_spectrum
import program
from bench_runs import at_least, best_and_median, listed, told

OF_PARTICLE = 75  # bytes of memory that a march takes
WORK, MOST_STEPS, LEAST_STEPS = 2e7, 2000, 4
PARTICLES = (1000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000)
ORDERS = (1000, 10_000, 40_000, 100_000, 400_000, 1_000_000, 4_000_000)


def arguments():
    parser = bench_runs.parser(__doc__, 3)
    parser.add_argument("--particles", type=listed((), int), default=PARTICLES[:-1])
    parser.add_argument("--orders", type=listed((), int), default=ORDERS[:-2])
    parser.add_argument("--from", type=listed((), int), default=(1_000_000, 40_000), dest="least",
                        metavar="PARTICLES,ORDER", help="smallest sizes that are fitted (1000000,40000)")
    parser.add_argument("--per-rank", type=at_least(1000), default=4_000_000, metavar="PARTICLES",
                        help="of weak scaling (4000000)")
    parser.add_argument("--all", action="store_true", help="up to 1e8 particles and order 4e6")
    args = parser.parse_args()
    if args.all:
        args.particles, args.orders = PARTICLES, ORDERS
    if min(args.particles) < 1000 or min(args.orders) < 8 or any(order % 4 for order in args.orders):
        parser.error("--particles: less than 1000; or --orders: no multiples of 4 from 8 on")
    if len(args.least) != 2:
        parser.error("--from: not two numbers")
    return args


def exponent(sizes, seconds, least):
    """Returns the slope of log seconds over log size, for the sizes from least on; None for fewer than two of them."""
    points = [(math.log(n), math.log(s)) for n, s in zip(sizes, seconds) if n >= least]
    if len(points) < 2:
        return None
    x, y = (sum(values) / len(points) for values in zip(*points))
    return sum((a - x) * (b - y) for a, b in points) / sum((a - x) ** 2 for a, _ in points)


def fitted(what, sizes, seconds, least):
    """Prints the exponent and returns it."""
    slope = exponent(sizes, seconds, least)
    used = [size for size in sizes if size >= least]
    said = "not fitted, it takes two sizes" if slope is None else f"exponent {slope:.3f}"
    print(f"  {what}: {said} from {least} on ({len(used)} sizes)")
    return {"exponent": slope, "from": least, "sizes": len(used)}


def lack_of_memory(need):
    free = bench_runs.memory_available()
    return f"left out, it takes {need / 1e9:.1f} GB and {free / 1e9:.1f} are free" if need > free else None


def seconds_of_step(particles, ranks=1):
    steps = int(min(MOST_STEPS, max(LEAST_STEPS, WORK // particles)))
    row = {"scheme": "gas2", "basis": "linear", "particles": particles, "drift": "0", "steps": steps}
    return 1e-9 * particles * bench_runs.run_mpmstab(row, ranks)[0]


def march(args):
    """Times a step for each size, with the sizes in turn."""
    print(f"\n{'particles':>10}  seconds of a step, 1 rank; a particle's")
    lacking = {n: lack_of_memory(OF_PARTICLE * n) for n in args.particles}
    times = {n: [] for n in args.particles if not lacking[n]}
    for _ in range(args.repeats):
        for n, seconds in times.items():
            seconds.append(seconds_of_step(n))
    rows = [{"particles": n, **best_and_median(seconds)} for n, seconds in times.items()]
    for row in rows:
        print(f"{row['particles']:>10}  {told(row):22} {1e9 * row['best'] / row['particles']:6.2f} ns")
    for n in (n for n, why in lacking.items() if why):
        print(f"{n:>10}  {lacking[n]}")
    return {"rows": rows, "fit": fitted("step", [row["particles"] for row in rows], [row["best"] for row in rows],
                                        args.least[0])}


def weak(args):
    """Times two ranks with twice the particles beside one rank, in turn."""
    n = args.per_rank
    why = lack_of_memory(2 * OF_PARTICLE * n)
    if why:
        print(f"  weak scaling with {n} particles a rank: {why}")
        return {"per_rank": n, "why": why}
    one, two = zip(*[(seconds_of_step(n), seconds_of_step(2 * n, 2)) for _ in range(args.repeats)])
    row = {"per_rank": n, "one": best_and_median(one), "two": best_and_median(two)}
    row["efficiency"] = row["one"]["best"] / row["two"]["best"]
    print(f"  weak scaling, {n} particles a rank: 1 rank {told(row['one'])}, 2 ranks {told(row['two'])} a step, "
          f"efficiency {row['efficiency']:.2f}")
    return row


def spectrum(args):
    print(f"\n{'unknowns':>10}  {'assembly':22} {'eigenvalues':22}")
    rows = []
    for order in args.orders:
        why = lack_of_memory(bench_spectrum.OF_UNKNOWN * order)
        if why:
            print(f"{order:>10}  {why}")
            continue
        runs = [bench_runs.result_of_run("spectrum", bench_spectrum.scene(order) | {"measure": "false"})["spectrum"]
                for _ in range(args.repeats)]
        row = {"unknowns": order, "what": "all" if runs[0]["listed"] == order else "near a target",
               "assembly": best_and_median([run["assemble_s"] for run in runs]),
               "solve": best_and_median([run["solve_s"] for run in runs])}
        rows.append(row)
        print(f"{order:>10}  {told(row['assembly']):22} {told(row['solve']):22} {row['what']}", flush=True)
    near = [row for row in rows if row["what"] != "all"]
    fits = {name: fitted(name, [row["unknowns"] for row in near], [row[name]["best"] for row in near], args.least[1])
            for name in ("assembly", "solve")}
    return {"rows": rows, "fit": fits}


def main():
    args = arguments()
    result = bench_runs.begin("growth", args)
    result |= {"march": march(args), "weak": weak(args), "spectrum": spectrum(args)}
    bench_runs.keep(result, args)


if __name__ == "__main__":
    program.end_in_one_line(main)
