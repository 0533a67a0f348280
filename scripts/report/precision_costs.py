"""What a step costs: the one rule by which docs/work-precision.md turns steps into seconds.

    seconds = steps x particles x (step + iteration x iterations of the solver) x NS[dim]

*step* and *iteration* are costs in steps of usl with flip. They are in precision_costs.json, for one and two dimensions at
small strain; only implicit has iterations. measure() finds them anew: marches of all schemes take turns in a jittered layout
that moves with Mach 1/10, and the least processor time of each counts, without that of start-up. So costs are those of many
particles in any layout. This program's faster paths for uniform layouts, which other codes have not, do not count, and what a
step costs on a grid of a few cells does not count either.
"""
import json
import math
import os
import resource

from program import launch, refuse, say, write_whole

FILE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "precision_costs.json")
NS = {1: 14.0, 2: 67.0}  # of usl with flip per particle and step, on one core (AMD EPYC, AVX2, docs/dev/speed.md)
GRID = {"1": {"cells": "32768", "mach": "0.1"}, "2": {"cells": "64,64", "dim": "2", "mach": "0.1,0.1"}}
LAYOUT = {"basis": "quadratic", "ppc": "2", "jitter": "0.4", "initial": "random"}
STEPS, SOLVES = 100, 10  # of a march; of one that solves in each step
with open(FILE, encoding="utf-8") as read:
    COSTS = json.load(read)


def seconds_of(row, options):
    """Returns the seconds of a run from its steps, cells, and iterations a step."""
    dim = int(options.get("dim", 1))
    cost = COSTS[str(dim)][f"{row['scheme']} {row['transfer']}"]
    particles = (int(options["ppc"]) * row["cells"]) ** dim
    return row["steps"] * particles * (cost["step"] + cost.get("iteration", 0) * row["iterations"]) * NS[dim] * 1e-9


def march(options, steps):
    """Returns the processor time of a march and its iterations a step; None: the scheme is refused."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    status, found, said = launch("run", None, {**options, "steps": steps})
    if status == 2:
        return None
    if "run" not in found:
        refuse(said)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, found["run"].get("iterations_per_step", 0)


def costs_of(dim, cases, rounds):
    """Returns the costs of cases, which are options by name and Courant number, in units of the first."""
    least, iterations = {}, {}
    for number in range(rounds):
        for case, options in cases.items():
            steps = SOLVES if options["formulation"] == "implicit" else STEPS
            runs = [march(options, many) for many in (steps + 1, 1)]
            if None not in runs:
                least[case] = [min(run[0], before) for run, before in zip(runs, least.get(case, (math.inf, math.inf)))]
                iterations[case] = runs[0][1]
        say(f"{dim}-D: round {number + 1} of {rounds}")
    times = {case: (whole - start) / (SOLVES if case[0].startswith("implicit") else STEPS) for case, (whole, start) in least.items()}
    unit = next(iter(times.values()))
    times = {case: time / unit for case, time in times.items()}
    found = {}
    for name in dict.fromkeys(name for name, _ in times):
        (low, some), *_, (high, many) = [(times[case], iterations[case]) for case in times if case[0] == name for _ in "12"]
        slope = (high - low) / (many - some) if many > some else 0
        found[name] = {"step": round(low - slope * some, 2), **({"iteration": round(slope, 3)} if slope else {})}
    return found


def measure(schemes, transfers, rounds):
    """Measures all costs and writes their file."""
    for dim, grid in GRID.items():
        cases = {(f"{scheme} {transfer}", courant): {**schemes[scheme], **transfers[transfer], **LAYOUT, **grid, "stagger": "false", "courant": courant}
                 for scheme in schemes for transfer in transfers for courant in ((1, 5) if scheme == "implicit" else (0.1,))}
        COSTS[dim] = costs_of(dim, cases, rounds)
        write_whole(FILE, json.dumps(COSTS, indent=1) + "\n")
