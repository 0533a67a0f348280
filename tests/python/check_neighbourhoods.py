#!/usr/bin/python3
"""Neighbourhoods of critical and spectrum: keys of JSON, the same numbers on 1, 2 and 3 ranks, the worst of those asked.

check_neighbourhoods.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import json
import math
import sys

from checks import check, forks

WATER = ("-dim 2 -formulation usl -transfer apic -gradient mls -basis quadratic -density 1 -sound_speed 20 -poisson 0.5"
         " -neighbourhood lone").split()


def run(task, words, ranks=1, status=0):
    done = forks.run([sys.argv[1], "-q", "-n", str(ranks), sys.argv[2], task, *words, "-json", "n.json"],
                     capture_output=True, text=True, check=False, timeout=120)
    check(done.returncode == status, f"{task} {words}: status {done.returncode}: {done.stderr}")
    with open("n.json", encoding="utf-8") as file:
        return json.load(file), done.stdout


def without_cost(each):
    """What must be the same on any number of ranks. The bulk's search is not this one's, and lone has none."""
    return {name: {key: value for key, value in one.items() if key not in ("seconds", "evaluations")}
            for name, one in each.items() if name != "bulk"}


def check_issue():
    """The time step of a lone particle of Taichi's mpm88, on grids of 128 and 200 cells a side of length 1."""
    for cells, printed in ((128, "0.000276214"), (200, "0.000176777")):
        found, text = run("critical", [*WATER, "-cell_width", repr(1 / cells)])
        critical = found["critical"]
        limit = 1 / math.sqrt(2) / cells / 20
        check(abs(critical["critical_dt"] / limit - 1) < 1e-12, f"dt {critical['critical_dt']}, not {limit}")
        check(set(critical) == {"critical_courant", "critical_dt", "neighbourhoods", "limited_by_neighbourhood",
                                 "any_layout"},
              f"keys {sorted(critical)}")
        check(abs(critical["any_layout"] * math.sqrt(2) - 1) < 1e-12, f"any layout: {critical['any_layout']}")
        check(f"a lone particle limits the Courant number to 0.707107, the time step to {printed} (wherever" in text, text)
        check("verdict" not in found and "verdict" not in text, "a verdict on a time step that nobody gave")
        check("courant" not in found and "growth" not in critical["neighbourhoods"]["lone"], "growth at no given step")


def check_all():
    """What each search finds is the same on any number of ranks, and the worst is the least of them."""
    words = "-formulation usl -basis quadratic -courant 0.6 -neighbourhood all -layouts 7".split()
    first = None
    for ranks in (1, 3):
        found, text = run("critical", words, ranks)
        critical = found["critical"]
        each = critical["neighbourhoods"]
        first = first or without_cost(each)
        check(without_cost(each) == first, f"{ranks} ranks: {each}\nnot {first}")
        check(list(each) == ["bulk", "edge", "lone", "random", "disordered"], f"all in one dimension: {list(each)}")
        least = min(each, key=lambda name: each[name]["critical_courant"])
        check(least == "lone" == critical["limited_by_neighbourhood"], f"the least is {least}")
        check(critical["critical_courant"] == each["lone"]["critical_courant"], "the worst is not the least")
        check(each["lone"]["approached"] and each["lone"]["place"] == [0.5], f"lone: {each['lone']}")
        check(0 <= each["random"]["share"] == each["random"]["unstable"] / 7, f"random: {each['random']}")
        check(found["verdict"] == "unstable" and abs(found["growth"] - max(1, 6 * 0.36 - 1)) < 1e-8,
              f"{found['verdict']}, growth {found['growth']}")
        check(text.count("\nverdict: ") == 1, text)
    found, _ = run("critical", [*words[:-4], "-neighbourhood", "bulk,lone", "-expect_critical", "0.577,0.578"])
    check(list(found["critical"]["neighbourhoods"]) == ["bulk", "lone"], "bulk,lone")
    run("critical", [*words[:-4], "-neighbourhood", "bulk,lone", "-expect_critical", "1,2"], status=3)


def check_bulk():
    """The bulk alone is what it was, in a scene file too."""
    with open("n.yaml", "w", encoding="utf-8") as file:
        file.write("formulation: musl\nneighbourhood: [bulk]\nvoids: 0.3\n")
    found, text = run("critical", ["n.yaml"])
    check("neighbourhoods" not in found["critical"] and "neighbourhood" not in text, text)
    check(found == {**found, **{"verdict": "stable"}} and abs(found["critical"]["critical_courant"] - 3**0.5) < 1e-6,
          f"{found['critical']}")


def check_none():
    """On hats a lone particle has no limit but 0. The report then says what holds in the scene's own layout."""
    found, text = run("critical", "-formulation usl -sound_speed 10 -cell_width 0.1 -neighbourhood bulk,lone".split())
    check(found["critical"]["critical_courant"] == 0, f"{found['critical']}")
    check("in the scene's own layout the limit of the bulk holds: 0.755929, a time step of 0.00755929; others may" in text, text)


def check_spectrum():
    """The growth of each at the scene's own Courant number, and the verdict by the worst."""
    words = "-cells 8 -formulation usl -courant 0.7 -basis quadratic -measure false".split()
    for ranks in (1, 3):
        found, text = run("spectrum", [*words, "-neighbourhood", "bulk,lone,random", "-layouts", "4", "-expect",
                                       "unstable", "-expect_spectrum", "1.9399999,1.9400001"], ranks)
        each = found["spectrum"]["neighbourhoods"]
        check(each["bulk"]["verdict"] == "stable" and found["spectrum"]["worst_neighbourhood"] == "lone", f"{each}")
        check("critical_courant" not in each["random"] and "unknowns" in found["spectrum"], f"{each}")
        check("a lone particle grows by a factor of 1.94 per step" in text, text)
    found, text = run("spectrum", "-cells 8 -formulation usl -neighbourhood lone".split())
    check("operator" not in text and "growth" not in found and found["verdict"] == "unstable", text)
    check("a lone particle grows without bound" in text, text)
    _, text = run("spectrum", "-cells 8 -formulation usl -drift 1/8 -neighbourhood lone".split())
    check("bulk" not in text and "these are of particles at rest, whatever the scene's drift is" in text, text)


check_issue()
check_all()
check_bulk()
check_none()
check_spectrum()
