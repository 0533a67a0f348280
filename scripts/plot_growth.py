#!/usr/bin/env python3
"""Norm of the state over steps for runs made with -json RUN.json -csv RUN.csv, with the predicted growth dashed.

plot_growth.py [-o PICTURE] RUN.json...     PICTURE ends in .png, .svg or .pdf
"""
import argparse
import csv
import json
import math

import matplotlib

matplotlib.use("Agg")
matplotlib.rcParams["svg.fonttype"] = "none"  # text stays text
from matplotlib import pyplot  # noqa: E402 (the backend comes first)

COLOURS = ["#D55E00", "#0072B2", "#CC79A7", "#009E73", "#E69F00", "#56B4E9"]  # Okabe and Ito, for every eye
MARKERS = "osD^vP"


def read(path):
    with open(path) as file:
        result = json.load(file)
    with open(path[: -len(".json")] + ".csv") as file:
        rows = list(csv.DictReader(file))
    rows = [r for r in rows if r["energy"]]  # empty: out of the range of doubles
    return result, [int(r["step"]) for r in rows], [float(r["energy"]) for r in rows]


def label(result):
    drift = f", drift {result['drift']:g}" if result["drift"] else ""
    measured = result["run"].get("growth_measured")
    text = "not measured" if measured is None else f"{measured:.6f} per step"
    return f"{result['formulation']}, k = {result['courant']:g}{drift}: {text}"


def draw(axes, number, result, steps, energy):
    size = [math.sqrt(e / energy[0]) for e in energy]
    colour = COLOURS[number % len(COLOURS)]
    axes.semilogy(steps, size, color=colour, marker=MARKERS[number % len(MARKERS)], markevery=max(1, len(steps) // 9),
                  label=label(result))
    predicted = result["predicted"].get("corrected_mode", result["predicted"].get("corrected"))
    if predicted is not None:
        axes.semilogy(steps, [predicted**s for s in steps], color="black", linestyle="--", linewidth=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", default="growth.png")
    parser.add_argument("-s", "--steps", type=int, default=640, help="last step shown")
    parser.add_argument("results", nargs="+", metavar="RUN.json")
    args = parser.parse_args()

    figure, axes = pyplot.subplots(figsize=(8, 4.5), constrained_layout=True)
    for number, path in enumerate(args.results):
        result, steps, energy = read(path)
        shown = [i for i, step in enumerate(steps) if step <= args.steps]
        draw(axes, number, result, [steps[i] for i in shown], [energy[i] for i in shown])
    axes.plot([], [], color="black", linestyle="--", linewidth=1, label="predicted (corrected analysis)")
    axes.set_xlabel("time step")
    axes.set_ylabel("square root of energy, relative to the start")
    axes.set_xlim(0, args.steps)
    axes.grid(True, alpha=0.3)
    axes.legend(title="measured growth")
    figure.savefig(args.output, dpi=150)


if __name__ == "__main__":
    main()
