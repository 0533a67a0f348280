#!/usr/bin/python3
"""Limits of neighbourhood disordered are those that critical finds of each of its layouts, made again by its options. That of
neighbourhood worst is the limit of the layout that it writes, and not below what a lone particle bounds.

check_disordered.py; MPMSTAB names the program. Silent when all is well.
"""
import json
import math
import os
import sys
import tempfile

from checks import forks

MPMSTAB = os.environ["MPMSTAB"]
SAME = 1e-5  # limits by halving, with a tolerance of growth, and by an eigenvalue at -1
CASES = (("-formulation usl -basis quadratic -courant 0.9", 24, 6),
         ("-formulation musl -courant 1.41 -jitter 0.5", 24, 6),
         ("-formulation usavg -basis cubic -transfer pic -ppc 1", 24, 6),
         ("-formulation verlet -basis quadratic", 24, 4),
         ("-formulation rk -basis quadratic", 24, 4),
         ("-dim 2 -formulation usf -basis quadratic -ppc 1", 6, 4),
         ("-dim 3 -formulation usl -basis quadratic -ppc 1", 4, 2))


def critical(words):
    """Returns what critical writes as JSON."""
    done = forks.run([MPMSTAB, "critical", *words, "-json", "critical.json"], capture_output=True, text=True,
                     timeout=120)
    assert done.returncode == 0, (words, done.stderr)
    with open("critical.json", encoding="utf-8") as file:
        return json.load(file)["critical"], done.stdout


def own_limits(words, cells, layouts):
    """Returns the limit of each layout, by its own scene: in turn jittered and anywhere."""
    jittered = [] if "-jitter" in words else ["-jitter", "1"]
    scattered = words[:words.index("-jitter")] + words[words.index("-jitter") + 2:] if "-jitter" in words else words
    limits = []
    for seed in range(1, layouts + 1):
        kind = scattered + ["-layout", "random"] if seed % 2 == 0 else words + jittered
        limits.append(critical(kind + ["-cells", str(cells), "-seed", str(seed)])[0]["critical_courant"])
    return limits


def check(case, cells, layouts):
    """Checks the least limit, its seed and the quantiles."""
    words = case.split()
    found, said = critical(words + ["-neighbourhood", "disordered", "-layouts", str(layouts)])
    found = found["neighbourhoods"]["disordered"]
    limits = own_limits(words, cells, layouts)
    assert found["worst_seed"] == 1 + limits.index(min(limits)), (case, found, limits)
    wanted = {"5": 0.05, "50": 0.5, "95": 0.95}
    for name, share in wanted.items():
        limit = sorted(limits)[math.ceil(share * layouts) - 1]
        assert abs(found["quantiles"][name] - limit) <= SAME * limit, (case, name, found, limits)
    assert abs(found["critical_courant"] - min(limits)) <= SAME * min(limits), (case, found, limits)
    assert f"-seed {found['worst_seed']}" in said, said
    if "-courant" in words:
        courant = float(words[words.index("-courant") + 1])
        assert found["unstable"] == sum(limit < courant for limit in limits), (case, found, limits)


def check_worst(case, cells, bound):
    """Checks the worst layout of a scheme none of whose layouts has a limit below bound."""
    words = case.split()
    found, _ = critical(words + ["-neighbourhood", "worst,disordered", "-layouts", "4", "-write_layout", "worst.csv"])
    worst = found["neighbourhoods"]["worst"]["critical_courant"]
    words = case.replace(" -ppc 1", "").split()  # the file says how many there are
    again = critical(words + ["-cells", str(cells), "-cell_width", "1", "-layout", "worst.csv"])[0]["critical_courant"]
    assert abs(again - worst) <= SAME * worst, (case, again, worst)
    disordered = found["neighbourhoods"]["disordered"]["critical_courant"]
    assert abs(found["any_layout"] - bound) <= SAME * bound, (case, found["any_layout"], bound)
    assert bound * (1 - SAME) <= worst < 0.97 * disordered, (case, worst, disordered)
    if "rk" in words:  # half the edge times that of musl (docs/theory.md, section 5)
        words[words.index("rk")] = "musl"
        musl = critical(words + ["-cells", str(cells), "-cell_width", "1", "-layout", "worst.csv"])[0]["critical_courant"]
        assert abs(worst - math.sqrt(2) * musl) <= SAME * worst, (case, worst, musl)


def check_table(case, kinds, recommended):
    """Rows of the table of the default answer are the answers to each neighbourhood, and the step that is recommended."""
    words, units = case.split(), "-sound_speed 8 -cell_width 0.5".split()
    found, said = critical(words + units)
    rows = {row["layout"]: row for row in found["layouts"]}
    assert list(rows) == ["lattice", "disordered", "edge", "lone", "worst", "bound"], rows
    for kind in kinds:
        one = critical(words + ["-neighbourhood", kind])[0]["neighbourhoods"][kind]
        limit = one.get("quantiles", {}).get("5", one.get("critical_courant"))
        assert rows[kind].get("courant") == limit, (case, kind, rows[kind], one)
    for row in [*rows.values(), found["recommended"]]:
        assert ("courant" in row) == ("dt" in row) and \
            abs(row.get("dt", 0) - row.get("courant", 0) * 0.5 / 8) < 1e-15, (case, row)
    for name in set(rows) - {"lattice", "bound", *kinds}:
        assert "courant" in rows[name] or f"-neighbourhood {name}" in rows[name]["how"] or name == "worst", (case, rows[name])
    assert found["recommended"].get("courant") == (rows[recommended]["courant"] if recommended else None), (case, found)
    zeros = [row for row in rows.values() if row.get("courant") == 0]
    assert not zeros or "chi = 0 on hats" in said or "grows" in found["recommended"]["reason"] or not recommended, (case, said)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for each in CASES:
            check(*each)
        check_worst("-formulation usl -basis quadratic", 24, math.sqrt(1 / 3))
        check_worst("-formulation musl -basis quadratic", 24, math.sqrt(2 / 3))
        check_worst("-dim 2 -formulation usl -basis quadratic -ppc 1 -poisson 0", 6, math.sqrt(1 / 3))
        check_worst("-formulation verlet -basis quadratic", 24, math.sqrt(2 / 3))
        check_worst("-formulation rk -basis quadratic", 24, math.sqrt(4 / 3))
        check_table("-formulation usl", ("disordered", "edge", "lone"), "disordered")
        check_table("-formulation usl -basis quadratic -dim 2 -ppc 1", ("disordered", "edge", "lone"), "bound")
        check_table("-formulation gas2", ("edge", "lone"), None)
        check_table("-formulation usl -basis quadratic -dim 3 -ppc 1", ("lone",), "bound")
    sys.exit(0)
