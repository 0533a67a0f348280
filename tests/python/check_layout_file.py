#!/usr/bin/python3
"""Checks -layout FILE: lattices written as CSV give the limits and runs of the same lattices, on any number of ranks, and bad
files are refused with the number of their line.

check_layout_file.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import itertools
import math
import subprocess
import sys

from checks import check, loaded


def run(words, ranks=1, status=0):
    launch = [sys.argv[1], "-n", str(ranks)] if ranks > 1 else []
    done = subprocess.run([*launch, sys.argv[2], *words.split(), "-json", "out.json"],
                          capture_output=True, text=True, check=False)
    check(done.returncode == status, f"{words}: status {done.returncode}: {done.stderr}")
    return done.stdout, (loaded("out.json") if status == 0 else done.stderr)


def write(name, header, rows):
    with open(name, "w", encoding="utf-8") as file:
        file.write(header + "\n")
        file.writelines(",".join(repr(float(number)) for number in row) + "\n" for row in rows)


def same(one, other, what, tolerance=1e-6):
    check(math.isclose(one, other, rel_tol=tolerance), f"{what}: {one} and {other}")


def limit(words):
    return run(f"critical {words}")[1]["critical"]["critical_courant"]


def check_lattices():
    """The same particles by options and by a file. Assembled operators have the accuracy of their tolerance."""
    lattice = [[(i + 0.25 + j / 2) / 4] for i in range(8) for j in range(2)]
    write("line.csv", "x", lattice)
    for ends in ("fixed,free", "symmetry", "fixed_reaction"):
        for basis in ("linear", "cubic"):
            scheme = f"musl -cells 8 -length 2 -basis {basis} -boundary {ends}"
            same(limit(scheme), limit(f"{scheme} -layout line.csv"), f"a lattice between ends {ends}")
    plane = [[x, y] for y, x in itertools.product([(j + 0.5) / 2 for j in range(8)], repeat=2)]
    write("plane.csv", "x,y", plane)
    scheme = "usl -dim 2 -basis quadratic -cells 4 -length 4 -boundary periodic,fixed"
    same(limit(scheme), limit(f"{scheme} -layout plane.csv"), "a lattice in the plane")


def check_materials():
    """Two materials, one of them four times as heavy and nine times as stiff; cells with one or two particles."""
    cells, two = 8, "-material two -density_ratio 4 -stiffness_ratio 9"
    rows = [[(i + 0.5) / 16, 1 / 16, (1 if i < 8 else 4) / 16, 1 if i < 8 else 9] for i in range(2 * cells)]
    write("two.csv", "x,volume,mass,young", rows)
    scheme = f"usl -cells {cells}"
    same(limit(f"{scheme} {two}"), limit(f"{scheme} -layout two.csv"), "two materials")
    units = "-density 1000 -young 2e6"
    write("units.csv", "young,mass,volume,x", [[2e6 * e, 1000 * m, v, x] for x, v, m, e in rows])
    same(limit(f"{scheme} {two}"), limit(f"{scheme} {units} -layout units.csv"), "two materials in SI units")
    places = [(c + (j + 0.5) / n, 1 / n) for c in range(cells) for n in [1 + c % 2] for j in range(n)]
    write("counts.csv", "x,volume", [[x / cells, v / cells] for x, v in places])
    same(limit(f"{scheme} -counts 1,2"), limit(f"{scheme} -layout counts.csv"), "cells with one and two")
    nu = 0.2
    modulus = (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    stiff = [[x, y, 9 / modulus if x >= 2 else 1 / modulus, nu]
             for y, x in itertools.product([(j + 0.5) / 2 for j in range(8)], repeat=2)]
    write("plane.csv", "x,y,young,poisson", stiff)
    scheme = "usl -dim 2 -cells 4 -length 4"
    same(limit(f"{scheme} -poisson {nu} -material two -stiffness_ratio 9"), limit(f"{scheme} -layout plane.csv"),
         "two materials in the plane")


def check_ranks():
    """Runs and spectra do not depend on ranks, nor on the order of the lines but for ids."""
    import random
    random.seed(1)
    write("random.csv", "x,y", [[8 * random.random(), 8 * random.random()] for _ in range(120)])
    words = "-formulation usl -dim 2 -basis quadratic -cells 8 -length 8 -layout random.csv -courant 0.4"
    runs = [run(f"run {words} -initial random -steps 40", ranks)[1]["run"] for ranks in (1, 2, 3)]
    for other in runs[1:]:
        same(runs[0]["growth_measured"], other["growth_measured"], "a run on ranks", 1e-12)
    radii = [run(f"spectrum {words}", ranks)[1]["spectrum"] for ranks in (1, 2)]
    same(radii[0]["spectral_radius"], radii[1]["spectral_radius"], "a spectrum on ranks", 1e-9)
    check(all(of["step_mismatch"] < 1e-12 for of in radii), "operator and march differ")
    out, found = run(f"run {words} -steps 1")
    check("120 particles of random.csv" in out and found["layout"] == "random.csv", "the layout is not named")


def check_random():
    """Particles anywhere: the same on any number of ranks, another layout for another seed, and kept in checkpoints."""
    words = "-formulation usl -dim 2 -basis quadratic -cells 8 -layout random -courant 0.3 -initial random"
    runs = [run(f"run {words} -steps 20", ranks)[1]["run"]["growth_measured"] for ranks in (1, 2, 3)]
    for other in runs[1:]:
        same(runs[0], other, "a run on ranks", 1e-12)
    check(len({limit(f"usl -basis quadratic -cells 8 -layout random -seed {seed}") for seed in (1, 2)}) == 2, "seeds")
    run(f"run {words} -steps 5 -checkpoint kept.h5")
    run(f"run {words} -steps 9 -restart kept.h5")
    _, error = run(f"run {words.replace('-layout random', '')} -steps 9 -restart kept.h5", 1, 2)
    check("its layout is random, the scene has none" in error, error)


BAD = [("", "it is empty"), ("x\n", "no particle"), ("y\n0\n", "line 1: there is no column x"),
       ("x,y\n0,0\n", "line 1: there is a column y"), ("x,volume\n.5,1\n.5,-1\n", "line 3: volume '-1'"),
       ("x\nnan\n", "line 2: x 'nan'"), ("x\n.5\n\n.6\n", "line 3: x ''"), ("x\n.5,.6\n", "line 2: more numbers"),
       ("x,mass\n.5\n", "line 2: fewer numbers"), ("x\n.5\n1.5\n", "line 3: x 1.5 is outside"),
       ("x,x\n1,1\n", "line 1: a column twice"), ("x\n.5e\n", "line 2: x '.5e'"), ("\0\1\2", "line 1: not text"),
       ("x\n" + "1" * 5000 + "\n", "line 2: not text, or longer"), ("x,volume\n.5,1e-320\n", "line 2: mass, volume")]


def check_refusals():
    for text, says in BAD:
        with open("bad.csv", "w", encoding="utf-8") as file:
            file.write(text)
        _, error = run("critical usl -cells 4 -layout bad.csv", 1, 2)
        check(len(error.splitlines()) == 1 and says in error and "layout bad.csv" in error, f"{text!r}: {error}")
    write("good.csv", "x", [[0.1]])
    for words in ("critical usl -layout none.csv", "critical usl -layout good.csv -jitter 1", "symbol -layout good.csv",
                  "critical usl -layout good.csv -ppc 2", "critical usl -layout good.csv -neighbourhood lone",
                  "ensemble -layout good.csv"):
        _, error = run(words, 1, 2)
        check(len(error.splitlines()) == 1, f"{words}: {error}")
    write("poisson.csv", "x,y,poisson", [[0.1, 0.1, 0.3], [0.2, 0.2, 0.2]])
    _, error = run("critical usl -dim 2 -layout poisson.csv", 1, 2)
    check("line 3: poisson 0.2" in error, error)


check_lattices()
check_materials()
check_ranks()
check_random()
check_refusals()
