#!/usr/bin/env python3
"""Prints one line for each result of `mpmstab run -json`: predicted and measured growth, errors, verdict."""
import json
import sys


def number(value, form):
    return "-" if value is None else format(value, form)


def ratio(energy):
    first, last = energy.get("initial"), energy.get("final")
    return f"{last / first:.3g}" if first and last is not None else "-"


def row(path):
    with open(path) as file:
        result = json.load(file)
    run, predicted = result["run"], result["predicted"]
    errors = " ".join(f"{field} {number(error.get('l2'), '.1e')}" for field, error in run.get("error", {}).items())
    return [
        result["formulation"],
        f"{result['courant']:g}",
        number(predicted["published"], ".6f"),
        number(predicted.get("corrected_mode", predicted["corrected"]), ".6f"),
        number(run.get("growth_measured"), ".6f"),
        run.get("growth_kind", "-"),
        ratio(run["energy"]),
        errors or "-",
        result["verdict"],
    ]


def main(paths):
    head = ["scheme", "k", "published", "predicted", "measured", "growth", "energy", "l2 errors", "verdict"]
    rows = [head] + [row(path) for path in paths]
    widths = [max(len(r[c]) for r in rows) for c in range(len(head))]
    print("growth per step: published by the slides; predicted for this wave by the corrected analysis; measured")
    print("energy: last / first; l2 errors: against the exact solution, relative to its amplitude\n")
    for line in rows:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip())


if __name__ == "__main__":
    main(sys.argv[1:])
