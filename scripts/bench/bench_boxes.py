#!/usr/bin/python3
"""Messages and bytes of a step in two and three dimensions, in slabs, pencils and blocks, and the step time on many ranks.

  T(P) = t0 + tp N / P + messages latency + 8 fields shared / bandwidth + reductions log2(P) latency

A rank sends its sums at each node to every other rank that has the node too, as its own or as a ghost: all node fields that
the step sums in one message to each neighbour. Neighbours are 2 in slabs, 8 in pencils and in the blocks of a plane, 26 in
blocks of a space. So shared is the product of (cells + 6 width) less that of (cells + 2 width) over the directions that ranks
share, times the cells of the others. These counts are PETSc's (-log_view); that they follow this rule is checked: fields is a
whole number. Particles are at rest. scaling is the same in one dimension.
"""
import json
import math
import os
import tempfile

import bench_runs
import program
from bench_scaling import add_network, networks, read_counts

SCHEME = {"formulation": "usl", "basis": "quadratic", "poisson": 0.3, "ppc": bench_runs.PPC, "offset": 0.51,
          "courant": 0.01, "mode": 1}
SHAPES = {2: {"slabs": (1, 3), "blocks": (3, 3)}, 3: {"slabs": (1, 1, 3), "pencils": (1, 3, 3), "blocks": (3, 3, 3)}}
COUNTED_CELLS = {2: 24, 3: 15}
RANKS = (1000, 100_000)
TOTALS, PER_RANK = (1e8, 1e9), (1e4, 1e6)


def run_box(dim, cells, steps, ranks, *more):
    options = SCHEME | {"dim": dim, "cells": cells, "steps": steps}
    words = [word for name, value in options.items() for word in (f"-{name}", str(value))]
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out.json")
        bench_runs.said(program.command_of(["run", *words, *more, "-json", out], ranks))
        with open(out, encoding="utf-8") as file:
            return json.load(file)["run"]


def counts_of(dim, ranks_along):
    """Returns messages, bytes and reductions of a step on so many ranks along each direction, the most of all ranks."""
    ranks, found = 1, []
    for n in ranks_along:
        ranks *= n
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "log.csv")
        for steps in (1, 33):
            run_box(dim, COUNTED_CELLS[dim], steps, ranks, "-ranks", ",".join(map(str, ranks_along)), "-log_view",
                    f":{path}:ascii_csv")
            with open(path, encoding="utf-8", newline="") as file:
                found.append(read_counts(file)["summary"])
    _, messages, length, reductions = ((b - a) / 32 for a, b in zip(*found))
    return {"messages": messages / 2, "bytes": length / 2, "reductions": reductions}


def shared_nodes(part, width):
    """Returns how many sums of a field a rank of a periodic grid sends. part: the cells along each direction, and whether
    ranks share it. Along a shared direction a rank has width ghosts on either side. So it has 2 width nodes together with each
    of the two ranks beside it, and all its nodes and ghosts with those that differ in other directions alone.
    """
    shared = [n for n, is_shared in part if is_shared]
    alone = product(n for n, is_shared in part if not is_shared)
    return alone * (product(n + 6 * width for n in shared) - product(n + 2 * width for n in shared))


def product(numbers):
    result = 1.0
    for number in numbers:
        result *= number
    return result


def part_of(dim, shape, cells_in_all, ranks):
    """Returns the cells of a rank's part along each direction, and whether that direction is shared."""
    side = cells_in_all ** (1 / dim)
    shared = sum(n > 1 for n in SHAPES[dim][shape])
    return [(side, False)] * (dim - shared) + [(side / ranks ** (1 / shared), True)] * shared


def step_time(model, shape, particles, ranks, network):
    counts, ppc = model["shapes"][shape], bench_runs.PPC ** model["dim"]
    part = part_of(model["dim"], shape, particles / ppc, ranks)
    sent = 8 * counts["fields"] * shared_nodes(part, model["width"])
    return (model["t0"] + model["tp"] * particles / ranks + counts["messages"] * network["latency"]
            + sent / network["bandwidth"] + counts["reductions"] * math.log2(ranks) * network["latency"])


def fits(model, shape, particles, ranks):
    """Every rank must have as many cells along a direction as its ghosts are wide."""
    part = part_of(model["dim"], shape, particles / bench_runs.PPC ** model["dim"], ranks)
    return min(n for n, _ in part) >= model["width"]


def width_of(dim):
    """Returns how many ghosts a rank has beyond its cells, which the program says when it refuses too few cells."""
    _, _, error = program.launch("run", options=SCHEME | {"dim": dim, "cells": 1})
    return int(error.split("at least ")[1].split()[0])


def make_model(dim, args):
    model = {"dim": dim, "width": width_of(dim), "shapes": {}}
    for shape, along in SHAPES[dim].items():
        counts = counts_of(dim, along)
        part = [(COUNTED_CELLS[dim] / n, n > 1) for n in along]
        counts["fields"] = counts["bytes"] / 8 / shared_nodes(part, model["width"])
        model["shapes"][shape] = counts
    cells = bench_runs.BOXES[dim]["1e6"]
    few = min(run_box(dim, 8, 2000, 1)["loop_s"] for _ in range(args.repeats)) / 2000
    many = min(run_box(dim, cells, 20, 1)["loop_s"] for _ in range(args.repeats)) / 20
    model["tp"] = (many - few) / (cells ** dim - 8 ** dim) / bench_runs.PPC ** dim
    model["t0"] = max(0.0, few - model["tp"] * (8 * bench_runs.PPC) ** dim)
    return model


def check(model, args, network):
    """Measures strong and weak scaling on 1 and 2 ranks beside the model: the grid of the model, and half of it."""
    rows, dim = [], model["dim"]
    cells = bench_runs.BOXES[dim]["1e6"]
    for along, ranks in ((f"{cells}", 1), (f"{cells}", 2), (",".join([str(cells)] * (dim - 1) + [str(cells // 2)]), 1)):
        run = min((run_box(dim, along, 20, ranks) for _ in range(args.repeats)), key=lambda run: run["loop_s"])
        particles = (bench_runs.PPC * cells) ** dim // (2 if "," in along else 1)
        time = model["t0"] + model["tp"] * particles if ranks == 1 else step_time(model, "slabs", particles, 2, network)
        rows.append({"particles": particles, "ranks": ranks, "measured": run["loop_s"] / 20, "model": time})
    one, two, half = (row["measured"] for row in rows)
    return {"rows": rows, "strong": one / two, "weak": half / two}


def show(model):
    print(f"\nusl quadratic, dim {model['dim']}, at rest: tp {1e9 * model['tp']:.2f} ns, t0 {1e6 * model['t0']:.2f} us, ghosts "
          f"{model['width']} wide")
    for shape, counts in model["shapes"].items():
        along = " x ".join(map(str, SHAPES[model["dim"]][shape]))
        print(f"  {shape} ({along} ranks, {COUNTED_CELLS[model['dim']]} cells in each direction): a step sends "
              f"{counts['messages']:.3g} messages of {counts['bytes'] / counts['messages']:.4g} bytes, the sums of "
              f"{counts['fields']:.3g} fields at the nodes that ranks share, and makes {counts['reductions']:.3g} reductions")


def show_check(found):
    for row in found["rows"]:
        print(f"    {row['particles']:9} particles, {row['ranks']} rank{'s' * (row['ranks'] > 1)}: measured "
              f"{1e6 * row['measured']:9.1f} us, model {1e6 * row['model']:9.1f} us ({row['model'] / row['measured']:.2f})")
    print(f"    2 ranks: strong {found['strong']:.2f} times as fast, weak efficiency {found['weak']:.2f}", flush=True)


def extrapolate(model, network):
    """Prints the step time and the efficiency of each shape on many ranks, and returns them."""
    rows = []
    for kind, sizes in (("strong", TOTALS), ("weak", PER_RANK)):
        for size in sizes:
            for shape in SHAPES[model["dim"]]:
                row = {"kind": kind, "particles": size, "shape": shape, "ranks": {}}
                said = []
                for ranks in RANKS:
                    total = size if kind == "strong" else size * ranks
                    if not fits(model, shape, total, ranks):
                        said.append(f"{ranks:,} ranks: too few cells for a rank")
                        continue
                    time = step_time(model, shape, total, ranks, network)
                    share = (model["t0"] + model["tp"] * total / ranks) / time
                    row["ranks"][str(ranks)] = {"seconds": time, "efficiency": share}
                    said.append(f"{ranks:,} ranks: {1e6 * time:.3g} us a step, efficiency {share:.2f}")
                rows.append(row)
                what = "particles in all" if kind == "strong" else "particles a rank"
                print(f"  {kind}, {size:.0e} {what}, {shape}: {'; '.join(said)}")
    return rows


def main():
    parser = bench_runs.parser(__doc__, 3)
    add_network(parser)
    args = parser.parse_args()
    result = bench_runs.begin("boxes", args)
    network, here = networks(args)
    result |= {"network": network, "here": here, "models": []}
    for dim in SHAPES:
        model = make_model(dim, args)
        show(model)
        print("  measured on this machine, and the model with its latency and bandwidth:")
        model["check"] = check(model, args, here)
        show_check(model["check"])
        print("  on the assumed network:")
        model["rows"] = extrapolate(model, network)
        result["models"].append(model)
    bench_runs.keep(result, args)


if __name__ == "__main__":
    program.end_in_one_line(main)
