"""Turns repeated runs into rows, orders, the efficient frontier, and the cheapest scheme for an error, in words.

A row is one combination. A family is a set of rows that differ in cells only, a line of error over time. A scheme is a
set of families that differ in the Courant number only. The times are those of the loop, best and median over repeats.
Between two grids of a family log(time) is interpolated linearly in log(error). Beyond its grids nothing is
extrapolated. Schemes are compared round by round, since what slows one round slows all of its runs.
"""
import csv
import io
import math
import statistics

PARAMETERS = ("formulation", "basis", "transfer", "ppc", "courant", "cells", "ranks")
FAMILY = tuple(name for name in PARAMETERS if name != "cells")
SCHEME = tuple(name for name in FAMILY if name != "courant")
COLUMNS = (*PARAMETERS, "dim", "drift", "steps", "time", "particles", "status", "verdict", "growth", "growth_all_waves",
           "error_l1", "error_l2", "error_linf", "field", "order", "best_s", "median_s", "repeats", "frontier", "note")
SHORT = 1e-3  # seconds; a shorter loop is measured badly
FLOOR = 0.5   # below this order errors are said to fall slowly
AS_GOOD = 1.01  # errors within this factor count as equally good
CHANCE = 0.025  # of two schemes that take as long, one is called slower with at most this probability
FIRST = 3       # so many schemes are put in an order that is certain


def key(record, names=PARAMETERS):
    return tuple(record[name] for name in names)


def error_of(record):
    """Returns the largest l1, l2 and linf over fields, and the field of the largest l2; None where one is out of range.

    The affine part of apic, c or c_xx and so on, is left out, since other transfers do not carry it.
    """
    errors = {field: error for field, error in (record.get("error") or {}).items() if field.split("_")[0] != "c"}
    if not errors or any("l2" not in error for error in errors.values()):
        return {"error_l1": None, "error_l2": None, "error_linf": None, "field": None}
    largest = {f"error_{norm}": max(error[norm] for error in errors.values()) for norm in ("l1", "l2", "linf")}
    return {**largest, "field": max(errors, key=lambda field: errors[field]["l2"])}


def make_rows(records, combinations):
    """Returns a row for each combination that has been run at least once, in the order asked for."""
    found = {}
    for record in records:
        found.setdefault(key(record), []).append(record)
    rows = []
    for combination in combinations:
        repeats = found.get(key(combination))
        if not repeats:
            continue
        first = repeats[0]
        loops = [record["loop_s"] for record in repeats if record.get("loop_s") is not None]
        row = {name: first.get(name) for name in COLUMNS}
        row.update(error_of(first))
        row.update(best_s=min(loops, default=None), median_s=statistics.median(loops) if loops else None,
                   repeats=len(loops), order=None, frontier=0,
                   loops={record["round"]: record["loop_s"] for record in repeats if record.get("loop_s") is not None})
        rows.append(row)
    set_orders(rows)
    for row in frontier(rows):
        row["frontier"] = 1
    return rows


def families(rows, names=FAMILY):
    """Returns the rows by family, or by scheme, from coarse to fine."""
    found = {}
    for row in rows:
        found.setdefault(key(row, names), []).append(row)
    return {name: sorted(members, key=lambda row: row["cells"]) for name, members in found.items()}


def usable(row):
    """Says whether a row may be the cheapest: it is stable, and has an error above 0 and a time."""
    return row["status"] == "ok" and bool(row["error_l2"]) and bool(row["best_s"])


def set_orders(rows):
    """Sets the order of convergence of each row, from the next coarser grid of its family."""
    for members in families(rows).values():
        for coarse, fine in zip(members, members[1:]):
            if usable(coarse) and usable(fine):
                fine["order"] = (math.log(coarse["error_l2"] / fine["error_l2"])
                                 / math.log(fine["cells"] / coarse["cells"]))


def frontier(rows):
    """Returns the usable rows that no faster row matches in accuracy, from the fastest on."""
    best, found = math.inf, []
    for row in sorted(filter(usable, rows), key=lambda row: (row["best_s"], row["error_l2"])):
        if row["error_l2"] * AS_GOOD < best:
            best = row["error_l2"]
            found.append(row)
    return found


def unit_of(row):
    """Says what the number of cells counts."""
    return "cells along x" if (row["dim"] or 1) > 1 else "cells"


def cheapest_of(members, wanted):
    """
    Returns where a family reaches an error in the least time: best, median, time of each round, and the rows it rests on.

    It looks at the grids that reach the error, and between neighbours that are both usable where the error is crossed.
    None: the family does not reach it.
    """
    found = [{"best_s": row["best_s"], "median_s": row["median_s"], "loops": row["loops"], "rows": (row,),
              "coarsest": row is members[0]} for row in members if usable(row) and row["error_l2"] <= wanted]
    for coarse, fine in zip(members, members[1:]):
        if usable(coarse) and usable(fine) and fine["error_l2"] <= wanted < coarse["error_l2"]:
            part = math.log(coarse["error_l2"] / wanted) / math.log(coarse["error_l2"] / fine["error_l2"])
            between = {name: coarse[name] ** (1 - part) * fine[name] ** part for name in ("best_s", "median_s")}
            loops = {number: coarse["loops"][number] ** (1 - part) * fine["loops"][number] ** part
                     for number in coarse["loops"] if number in fine["loops"]}
            found.append({**between, "loops": loops, "rows": (coarse, fine), "coarsest": False})
    return min(found, key=lambda point: point["best_s"], default=None)


def ranking(rows, wanted):
    """Returns the points at which schemes reach an error, from the cheapest on, each at its best Courant number."""
    best = {}
    for members in families(rows).values():
        point = cheapest_of(members, wanted)
        scheme = key(members[0], SCHEME)
        if point and (scheme not in best or point["best_s"] < best[scheme]["best_s"]):
            best[scheme] = point
    return sorted(best.values(), key=lambda point: point["best_s"])


def slower(point, other):
    """Says whether a point takes longer than another in so many rounds that it is no chance (a sign test)."""
    rounds = [number for number in point["loops"] if number in other["loops"]]
    wins = sum(point["loops"][number] > other["loops"][number] for number in rounds)
    return sum(math.comb(len(rounds), many) for many in range(wins, len(rounds) + 1)) <= CHANCE * 2 ** len(rounds)


def uncertain_rows(rows, wanted):
    """Returns the rows that have to be repeated until the order of the first schemes is certain; none when it is."""
    first = ranking(rows, wanted)[:FIRST]
    pairs = [pair for pair in zip(first, first[1:]) if not slower(pair[1], pair[0])]
    return [row for pair in pairs for point in pair for row in point["rows"]]


def seconds(value):
    for unit, factor in (("s", 1), ("ms", 1e3)):
        if value * factor >= 1:
            return f"{value * factor:.3g} {unit}"
    return f"{value * 1e6:.3g} us"


def varying(rows):
    """Returns the parameters of a family that differ among rows, or those that name a scheme when none differs."""
    names = [name for name in FAMILY if len({row[name] for row in rows}) > 1]
    return names or ["formulation", "basis", "transfer"]


WORDS = {"ppc": "ppc {}", "courant": "k {:g}", "ranks": "{} ranks"}


def name_of(row, names):
    return " ".join(WORDS.get(name, "{}").format(row[name]) for name in names).replace(" 1 ranks", " 1 rank")


def at(point, names):
    """Says in words where a family reaches an error."""
    *_, fine = point["rows"]
    name = name_of(fine, names)
    if len(point["rows"]) == 1:
        coarsest = " (its coarsest grid, so perhaps less)" if point["coarsest"] else ""
        return f"{name} with {fine['cells']} {unit_of(fine)}: {seconds(point['best_s'])}{coarsest}"
    return (f"{name}: {seconds(point['best_s'])} (interpolated between {point['rows'][0]['cells']} and {fine['cells']} "
            f"{unit_of(fine)})")


def answer(rows, wanted):
    """Says which scheme is cheapest for an error, and which come next."""
    names = varying(rows)
    found = ranking(rows, wanted)
    if not found:
        best = min(filter(usable, rows), key=lambda row: (row["error_l2"], row["best_s"]), default=None)
        said = f"error {wanted:g}: nothing that is stable reaches it here"
        return said if best is None else (f"{said}; the smallest is {best['error_l2']:.3g}, by {name_of(best, names)} "
                                          f"with {best['cells']} {unit_of(best)} in {seconds(best['best_s'])}")
    first = found[0]
    said = [f"for error {wanted:g} the cheapest here is {at(first, names)}"]
    if first["best_s"] < SHORT:
        said[0] += "; its loop takes less than 1 ms, so the time is rough"
    for before, point in zip(found, found[1:4]):
        said.append(f"  next {at(point, names)}, {point['best_s'] / first['best_s']:.3g} times as long"
                    + ("" if slower(point, before) else "; no difference to the one before beyond the scatter of "
                       f"{len(point['loops'])} rounds"))
    if len(found) > 4:
        said.append(f"  and {len(found) - 4} more")
    return "\n".join(said)


def remarks(rows):
    """Returns remarks on what makes the numbers less reliable."""
    names, said = varying(rows), []
    timed = [row for row in rows if row["best_s"]]
    short = [row for row in timed if row["best_s"] < SHORT]
    if short:
        said.append(f"{len(short)} of {len(timed)} loops are shorter than 1 ms: their times are rough (more cells or a "
                    "longer time help)")
    wide = [row for row in timed if row["median_s"] > 1.25 * row["best_s"]]
    if wide:
        said.append(f"the median is more than a quarter above the best in {len(wide)} of {len(timed)} rows, so the machine was not quiet")
    alone = [row for row in timed if row["growth_all_waves"] is None]
    if alone:
        said.append(f"{len(alone)} of {len(timed)} have no symbol (walls, particles that differ) and are judged by "
                    "their run alone, which may hide growth of other waves")
    ends = [row["time"] for row in timed]
    if ends and max(ends) - min(ends) > 1e-12 * max(ends):
        said.append(f"whole steps end at times from {min(ends):.6g} to {max(ends):.6g}; each error is at its own end")
    for members in families(rows).values():
        points = [row for row in members if usable(row)]
        if len(points) > 1 and points[-1]["order"] is not None and points[-1]["order"] < FLOOR:
            said.append(f"{name_of(points[-1], names)}: the error falls slowly with cells, or no more (order "
                        f"{points[-1]['order']:.2f} at {points[-1]['cells']} {unit_of(points[-1])})")
    for note in dict.fromkeys(row["note"] for row in rows if row["note"]):
        who = dict.fromkeys(name_of(row, names) for row in rows if row["note"] == note)
        said.append(f"{', '.join(who)}: {note}")
    return said


def text(value, form):
    return "-" if value is None else format(value, form)


def outstanding(rows):
    """Returns the rows that no faster row of their scheme matches in accuracy, and all of a scheme that has none."""
    found = [row for members in families(rows, SCHEME).values() for row in frontier(members) or members]
    return [row for row in rows if row in found]


def table(rows):
    """Returns the rows as aligned text."""
    names = [name for name in PARAMETERS if name == "cells" or name in varying(rows)]
    head = [*names, "steps", "error", "order", "best", "median", "growth", "all waves", "status", ""]
    lines = [head]
    for row in rows:
        parameters = [f"{row[name]:g}" if isinstance(row[name], float) else str(row[name]) for name in names]
        times = ["-" if row[name] is None else seconds(row[name]) for name in ("best_s", "median_s")]
        lines.append([*parameters, text(row["steps"], "d"), text(row["error_l2"], ".2e"), text(row["order"], ".2f"),
                      *times, text(row["growth"], ".6f"), text(row["growth_all_waves"], ".6f"), row["status"],
                      "frontier" if row["frontier"] else ""])
    widths = [max(len(line[c]) for line in lines) for c in range(len(head))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)


def csv_text(rows):
    out = io.StringIO()
    writer = csv.DictWriter(out, COLUMNS, lineterminator="\n", extrasaction="ignore")
    writer.writeheader()
    writer.writerows(rows)  # None becomes empty, and floats keep all their digits
    return out.getvalue()
