"""The study of docs/work-precision.md: its schemes and scenes, its runs, and the time that a scheme takes for an error.

A scheme is a line of SCHEMES, a transfer one of TRANSFERS, a scene one of SCENES. Each scheme runs with each transfer at
two parts of its limit at rest, and at a third where neither reaches the error. It runs on several grids, to generic end times, in
several layouts (offsets of the lattice, or seeds of the disorder). Runs are kept in FOLDER/runs.jsonl as soon as they are done.

The error of a run is the largest l2 error over the fields, over the amplitude of the exact solution (the affine part of apic
does not count). Its time is not measured, since other programs share the machine: precision_costs has the cost of a step.
"""
import json
import math
import os
import statistics
import sys
from typing import NamedTuple

import precision_costs
from program import launch

os.environ.setdefault("OMP_NUM_THREADS", "1")  # runs are small, and the threads of a solver wait for one another on a busy machine

# The options of a scheme. Those that update one field first start it half a step early.
SCHEMES = {
    "usl": {"formulation": "usl", "stagger": "true"},
    "usf": {"formulation": "usf", "stagger": "true"},
    "musl": {"formulation": "musl", "stagger": "true"},
    "usavg": {"formulation": "usavg"},
    "verlet": {"formulation": "verlet"},
    "rk4": {"formulation": "rk", "rk": "rk4"},
    "kg5": {"formulation": "rk", "rk": "kg5"},
    "implicit": {"formulation": "implicit"},
}
TRANSFERS = {
    "flip": {},
    "apic": {"transfer": "apic"},
    "fmpm": {"transfer": "fmpm", "xpic_order": "4"},
    "blend": {"transfer": "blend", "blend_ratio": "0.99"},
}
SHARES = (0.9, 0.5, 0.25)  # of the limit at rest; the last one where the others do not reach the error
USUAL = 0.5                # the share that a careful person takes
FIXED = {1: 0, 2: 0, 5: USUAL, 10: 0}  # the Courant numbers of a scheme without a limit
GRAIN = 40                 # Courant numbers are multiples of its inverse, so that drifts are short fractions
LOUD = 1.0                 # decades: a scheme rings if noise grows by more than this during a run
NEAR = 1.5                 # times the error that is wanted: up to there seconds are extrapolated
NOISE_STEPS = 2000         # of a march of noise
FEWEST = 6                 # steps a period: with fewer an error may be small by chance
LOST = 0.6                 # a longer run is left out if a shorter one has this times the error that is wanted


class Scene(NamedTuple):
    title: str
    options: dict
    cells: tuple    # along each direction
    errors: dict    # wanted, by the number of periods
    period: float   # in L / c
    layouts: tuple  # options that differ from layout to layout
    quiet: int      # cells along each direction where the growth of noise is found; 0: nowhere


LINE = {"basis": "quadratic", "ppc": "2"}
PLANE = {"basis": "quadratic", "ppc": "2", "dim": "2", "mode": "1,1"}
FINITE = {"basis": "quadratic", "ppc": "2", "kinematics": "finite", "material": "neo", "initial": "manufactured",
          "amplitude": "0.03"}
OFFSETS = tuple({"offset": value} for value in ("0.5", "0.3", "0.05"))
SEEDS = tuple({"jitter": "0.4", "seed": value} for value in ("1", "2", "3"))
LONG = {1.37: 0.01, 10.37: 0.03, 100.37: 0.3}
ROUGH = {1.37: 0.15, 100.37: 0.6}  # disordered particles have errors that do not fall with the cells


def line(title, mach, layouts=OFFSETS, basis="quadratic"):
    return Scene(title, {**LINE, "basis": basis, **({"mach": mach} if mach else {})}, (16, 32, 64, 128),
                 LONG if layouts == OFFSETS else ROUGH, 1.0, layouts, 32)


def plane(title, mach, layouts=OFFSETS):
    return Scene(title, {**PLANE, **({"mach": f"{mach},{mach}"} if mach else {})}, (16, 24, 32, 48),
                 {1.37: 0.05, 10.37: 0.3}, math.sqrt(0.5), layouts, 8)


SCENES = {
    "line-rest": line("1-D, at rest", None),
    "line-slow": line("1-D, Mach 1/100", "1/100"),
    "line-fast": line("1-D, Mach 1/10", "1/10"),
    "hats-fast": line("1-D, hats, Mach 1/10", "1/10", basis="linear"),
    "cubic-fast": line("1-D, cubic splines, Mach 1/10", "1/10", basis="cubic"),
    "jitter-rest": line("1-D, disordered, at rest", None, SEEDS),
    "jitter-slow": line("1-D, disordered, Mach 1/100", "1/100", SEEDS),
    "jitter-fast": line("1-D, disordered, Mach 1/10", "1/10", SEEDS),
    "plane-rest": plane("2-D, at rest", None),
    "plane-slow": plane("2-D, Mach 1/100 along x and y", "1/100"),
    "plane-fast": plane("2-D, Mach 1/10 along x and y", "1/10"),
    "plane-jitter": plane("2-D, disordered, Mach 1/10 along x and y", "1/10", SEEDS),
    "finite-line": Scene("1-D, strain up to 19 %", FINITE, (16, 32, 64, 128), {1.37: 0.03, 10.37: 0.1}, 1.0, OFFSETS, 0),
    "finite-plane": Scene("2-D, strain up to 19 %", {**FINITE, "dim": "2"}, (16, 24, 32), {1.37: 0.03, 10.37: 0.1}, 1.0, OFFSETS[:2], 0),
}


class Runs:
    """The runs of a folder: each is done once, and kept."""

    def __init__(self, folder):
        self.path = os.path.join(folder, "runs.jsonl")
        self.known = {}
        if os.path.exists(self.path):
            with open(self.path, encoding="utf-8") as file:
                for text in file:
                    if text.endswith("\n"):
                        record = json.loads(text)
                        self.known[record["key"]] = record

    def ask(self, task, options, reader):
        """Returns what the reader finds in the result of a task, from the file if it is there."""
        key = " ".join([task, *(f"-{name} {value}" for name, value in options.items())])
        if key not in self.known:
            record = {"key": key, **reader(task, options)}
            with open(self.path, "a", encoding="utf-8") as file:
                file.write(json.dumps(record) + "\n")
            self.known[key] = record
        return self.known[key]


def read_limit(task, options):
    _, found, said = launch(task, None, options)
    return {"limit": found.get("critical", {}).get("critical_courant"), "note": said}


def read_error(task, options):
    """Returns steps, iterations of a solver, and the largest error of a run; no error: the state is out of range."""
    _, found, said = launch(task, None, options)
    if "run" not in found:
        return {"refused": said.removeprefix("mpmstab: ")}
    errors = [error.get("l2") for field, error in found["run"].get("error", {}).items() if field.split("_")[0] != "c"]
    error = None if not errors or None in errors or not all(map(math.isfinite, errors)) else max(errors)
    return {"steps": found["run"]["steps"], "iterations": found["run"].get("iterations_per_step", 0), "error": error}


def read_growth(task, options):
    """Returns the growth per step of the worst wave, by the symbol, or that of a march of noise."""
    _, found, said = launch(task, None, options)
    if task == "symbol":
        return {"growth": found.get("symbol", {}).get("growth"), "note": said}
    exponential = found.get("run", {}).get("growth_kind") == "exponential"
    return {"growth": found["growth"] if exponential else 1.0, "note": said}


def courants_of(runs, scene, scheme, transfer):
    """Returns the Courant numbers of a scheme and the shares of its limit that they are; {} if it is refused."""
    if scheme == "implicit":
        return {} if "kinematics" in scene.options else FIXED
    given = {name: value for name, value in {**SCHEMES[scheme], **TRANSFERS[transfer], **scene.options}.items()
             if name in ("formulation", "rk", "transfer", "xpic_order", "blend_ratio", "basis", "ppc", "dim")}
    limit = runs.ask("critical", given, read_limit)["limit"]
    if not limit:
        return {}
    return {math.floor(GRAIN * share * limit) / GRAIN: share for share in SHARES}


def cells_of(scene, cells):
    return ",".join([str(cells)] * int(scene.options.get("dim", 1)))


def growth_of(runs, scene, step):
    """Returns the growth per step of noise: by the symbol of a lattice, or by a march of noise in a disordered layout."""
    if not scene.quiet:
        return 1.0
    given = {name: value for name, value in {**step, **scene.layouts[0]}.items() if name not in ("mode", "stagger")}
    given["cells"] = cells_of(scene, scene.quiet)
    if "jitter" in given:
        return runs.ask("run", {**given, "initial": "random", "steps": NOISE_STEPS}, read_growth)["growth"]
    return runs.ask("symbol", given, read_growth)["growth"] or 1.0


def point_of(runs, scene, step, periods, cells, layouts, row):
    """Runs a grid in these layouts and adds errors and steps to its row."""
    for layout in layouts:
        found = runs.ask("run", {**step, **layout, "cells": cells_of(scene, cells),
                                 "time": f"{periods * scene.period:.6g}"}, read_error)
        if "refused" in found:
            row.update(status="refused", note=found["refused"])
            return
        row["errors"].append(math.inf if found["error"] is None else found["error"])
        row.update(steps=found["steps"], iterations=found["iterations"])
        row["seconds"] = precision_costs.seconds_of(row, scene.options)


def curve_of(runs, scene, name, step, periods, wanted, before):
    """Returns the rows of a scheme at one step and time, from coarse to fine until the first layout has the error."""
    rows = []
    courant = float(step["courant"])
    growth = growth_of(runs, scene, step)
    for cells in scene.cells:
        steps = math.ceil(cells * periods * scene.period / courant)
        row = {**name, "periods": periods, "cells": cells, "status": "ok", "errors": [], "steps": steps,
               "note": "", "growth": growth}
        rows.append(row)
        if math.log10(growth) * steps > LOUD:
            row["status"] = "rings"
        elif before.get(cells, 0) > LOST * wanted or cells * scene.period < FEWEST * courant:
            row["status"] = "lost"
        else:
            point_of(runs, scene, step, periods, cells, scene.layouts[:1], row)
            if row["status"] == "refused" or row["errors"][0] <= wanted:
                break
    return rows


def reaches(rows, wanted):
    return any(row["errors"] and row["errors"][0] <= wanted for row in rows)


def one_scheme(runs, scene, scheme, transfer):
    """
    Returns the rows of a scheme with a transfer, at each Courant number, time and grid.

    The first layout chooses the best Courant number. Then the other layouts run there, too.
    """
    found, before = [], {}
    courants = courants_of(runs, scene, scheme, transfer)
    for periods, wanted in scene.errors.items():
        curves = {}
        for courant, share in courants.items():
            name = {"scheme": scheme, "transfer": transfer, "courant": courant, "share": share}
            step = {**SCHEMES[scheme], **TRANSFERS[transfer], **scene.options, "courant": f"{courant:g}"}
            if share == SHARES[-1] and any(reaches(rows, wanted) for _, rows in curves.values()):
                continue
            curves[courant] = step, curve_of(runs, scene, name, step, periods, wanted, before.get(courant, {}))
        best = min(curves, key=lambda courant: seconds_for(curves[courant][1], wanted, statistics.median), default=None)
        for courant, (step, rows) in curves.items():
            before[courant] = {**before.get(courant, {}), **{row["cells"]: row["errors"][0] for row in rows if row["errors"]}}
            if courant == best:
                for row in rows:
                    if row["errors"] and row["status"] == "ok":
                        point_of(runs, scene, step, periods, row["cells"], scene.layouts[1:], row)
            found += rows
    return found


def rows_of(runs, scene, schemes=None, transfers=None):
    """Returns all rows of a scene."""
    rows = []
    for scheme in schemes or SCHEMES:
        for transfer in transfers or TRANSFERS:
            if sys.stderr.isatty():
                print(f"\r{scene.title}: {scheme} {transfer}    ", end="", file=sys.stderr, flush=True)
            rows += one_scheme(runs, scene, scheme, transfer)
    return rows


def seconds_for(members, wanted, statistic):
    """Returns the seconds in which the grids of one Courant number reach an error; inf: they do not.

    Between grids the seconds are interpolated. A layout that just misses the error on the finest grid is extrapolated.
    """
    points = sorted((row["cells"], row["seconds"], statistic(row["errors"])) for row in members if row["errors"])
    best = min((seconds for _, seconds, error in points if error <= wanted), default=math.inf)
    for place, ((_, fast, coarse), (_, slow, fine)) in enumerate(zip(points, points[1:]), 2):
        missed = best == math.inf and place == len(points) and fine <= NEAR * wanted
        if (fine <= wanted or missed) and max(fine, wanted) < coarse < math.inf:
            part = math.log(coarse / wanted) / math.log(coarse / fine)
            best = min(best, fast ** (1 - part) * slow ** part)
    return best


def standing(rows, periods, wanted):
    """
    Returns for each scheme with each transfer how it reaches an error: at its best step and at the usual one.

    A result has the seconds for the median error, and for the least and the largest of the layouts. None reaches it:
    seconds is inf, and smallest is the smallest error that it has.
    """
    found = []
    for scheme in SCHEMES:
        for transfer in TRANSFERS:
            mine = [row for row in rows if (row["scheme"], row["transfer"], row["periods"]) == (scheme, transfer, periods)]
            if not any(row["status"] != "refused" for row in mine):
                continue
            choices = []
            for courant in dict.fromkeys(row["courant"] for row in mine):
                members = [row for row in mine if row["courant"] == courant]
                low, middle, high = (seconds_for(members, wanted, how) for how in (min, statistics.median, max))
                choices.append({"courant": courant, "share": members[0]["share"], "seconds": middle, "low": low,
                                "high": high})
            best = min(choices, key=lambda choice: choice["seconds"])
            usual = next((choice for choice in choices if choice["share"] == USUAL), best)
            errors = [statistics.median(row["errors"]) for row in mine if row["errors"]]
            found.append({"scheme": scheme, "transfer": transfer, **best, "usual": usual["seconds"],
                          "smallest": min(errors, default=math.inf),
                          "rings": all(row["status"] == "rings" for row in mine if row["cells"] == max(r["cells"] for r in mine))})
    return sorted(found, key=lambda one: (one["seconds"], one["smallest"]))
