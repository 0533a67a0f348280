#!/usr/bin/python3
"""Prints two tables of the demo's results: growth in five columns, and runs.

summary.py FOLDER SCENE...

For each scene it reads FOLDER/SCENE-spectrum.json (spectrum -json) and FOLDER/SCENE.json (run -json).
"""
import json
import sys


def number(value, form):
    return "-" if value is None else format(value, form)


def ratio(energy):
    first, last = energy.get("initial"), energy.get("final")
    return f"{last / first:.3g}" if first and last is not None else "-"


def load(path):
    try:
        with open(path, encoding="utf-8") as file:
            return json.load(file)
    except (OSError, ValueError, RecursionError) as error:
        why = getattr(error, "strerror", None) or "is not JSON"
        print(f"summary.py: {path}: {why}; allowed: a file that mpmstab has written with -json", file=sys.stderr)
        sys.exit(2)


def scheme(result):
    drifts = result["drift"] if isinstance(result["drift"], list) else [result["drift"]]
    drift = ",".join(f"{one:g}" for one in drifts) if any(drifts) else "-"
    return [result["formulation"], f"{result['courant']:g}", drift]


def growth_row(result):
    predicted = result["predicted"]
    columns = [predicted["published"], predicted["corrected"], predicted["symbol"], result["spectrum"].get("growth"),
               result.get("run", {}).get("growth_measured")]
    off = number(predicted.get("published_off_by"), ".3f")
    return scheme(result) + [number(c, ".6f") for c in columns] + [off, result["verdict"]]


def run_row(result):
    run, predicted = result["run"], result["predicted"]
    errors = " ".join(f"{field} {number(error.get('l2'), '.1e')}" for field, error in run.get("error", {}).items())
    return scheme(result) + [
        number(predicted.get("corrected_mode", predicted["corrected"]), ".6f"),
        number(run.get("growth_measured"), ".6f"),
        run.get("growth_kind", "-"),
        ratio(run["energy"]),
        errors or "-",
    ]


def table(title, head, rows):
    rows = [head] + rows
    widths = [max(len(row[c]) for row in rows) for c in range(len(head))]
    print(title)
    for line in rows:
        print("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip())


def main(folder, scenes):
    table("growth per step, the largest over all waves; measured: random data marched;\n"
          "off by: largest error of the published abs(G) over all waves",
          ["scheme", "k", "drift", "published", "corrected", "symbol", "spectrum", "measured", "off by", "verdict"],
          [growth_row(load(f"{folder}/{scene}-spectrum.json")) for scene in scenes])
    print()
    table("the same scenes run from their own initial data; l2 errors relative to the exact solution's amplitude",
          ["scheme", "k", "drift", "predicted", "measured", "growth", "energy last/first", "l2 errors"],
          [run_row(load(f"{folder}/{scene}.json")) for scene in scenes])


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2:])
