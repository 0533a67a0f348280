#!/usr/bin/python3
"""Checks -layout FILE: lattices written as CSV give the limits and runs of the same lattices, on any number of ranks; field
output is a layout; particles that are held stay; the particles are written again with their bounds and the mode; and bad
files are refused with the number of their line.

check_layout_file.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import csv
import itertools
import math
import os
import subprocess
import sys

import h5py
import numpy

from checks import check, loaded, on_ranks


def run(words, ranks=1, status=0):
    done = on_ranks(ranks, sys.argv[2], *words.split(), "-json", "out.json")
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
    for ends, basis in (("fixed,free", "cubic"), ("symmetry", "linear"), ("symmetry", "cubic"), ("fixed_reaction", "linear")):
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
    for words in (units, ""):
        out, _ = run(f"critical {scheme} {words} -layout units.csv")
        check("note: mass over volume of the particles is from 1000 to 4000" in out, out)
    write("alike.csv", "x,volume,mass,poisson", [[x, v, 1000 * v, 0.3] for x, v, _, _ in rows])
    out, _ = run(f"critical {scheme} {units} -layout alike.csv")
    check("note:" not in out and "; not used: poisson" in out, out)
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
    runs = [run(f"run {words} -initial random -steps 40", ranks)[1]["run"] for ranks in (1, 3)]
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
    runs = [run(f"run {words} -steps 20", ranks)[1]["run"]["growth_measured"] for ranks in (1, 3)]
    for other in runs[1:]:
        same(runs[0], other, "a run on ranks", 1e-12)
    check(len({limit(f"usl -basis quadratic -cells 8 -layout random -seed {seed}") for seed in (1, 2)}) == 2, "seeds")
    run(f"run {words} -steps 5 -checkpoint kept.h5")
    run(f"run {words} -steps 9 -restart kept.h5")
    _, error = run(f"run {words.replace('-layout random', '')} -steps 9 -restart kept.h5", 1, 2)
    check("its layout is random, the scene has none" in error, error)


def check_many():
    """Of many particles the leftmost eigenvalue alone is found, by products: all eigenvalues of spectrum say the same."""
    rng = numpy.random.default_rng(3)
    write("many.csv", "x,y", 6 + 6 * rng.random((210, 2)))
    for scheme, courant in (("usl -basis quadratic", 1.3), ("musl -basis cubic", 2.7)):
        scene = f"-dim 2 -cells 24 -length 24 -layout many.csv -measure false -formulation {scheme} -courant"
        answers = [run(f"critical {scene} {courant}".replace("-measure false ", ""), ranks) for ranks in (1, 3)]
        check("by a Krylov space" in answers[0][0], f"{scheme}: {answers[0][0]}")
        one, three = ({**found["critical"], "growth": found["growth"]} for _, found in answers)
        for key in ("critical_courant", "growth"):
            same(one[key], three[key], f"{scheme}: {key} on three ranks", 1e-9)
        check(one["mode_fastest"]["id"] == three["mode_fastest"]["id"], f"{scheme}: the fastest particle")
        if "usl" not in scheme:
            continue  # to find all eigenvalues takes seconds
        for at, growth in ((courant, one["growth"]), (one["critical_courant"] * (1 - 1e-6), 1)):
            same(run(f"spectrum {scene} {at!r}")[1]["spectrum"]["spectral_radius"], growth, f"{scheme} at {at}")
        beyond = run(f"spectrum {scene} {one['critical_courant'] * (1 + 1e-5)!r}")[1]["spectrum"]
        check(beyond["spectral_radius"] > 1 + 1e-5, f"{scheme}: {beyond['spectral_radius']} beyond the limit")


def check_long():
    """A file with more lines than memory has room for ends in one message, in the memory of a short file."""
    with open("long.csv", "w", encoding="utf-8") as file:
        file.write("x\n")
        for _ in range(100):
            file.write("0\n" * 100000)
    with open("said", "w", encoding="utf-8") as said:
        process = subprocess.Popen(["sh", "-c", 'ulimit -v 500000 && exec "$@"', "sh", sys.argv[2], *"critical usl -cells 4 -length 4 -layout long.csv".split()],
                                   stdout=subprocess.DEVNULL, stderr=said)
        _, status, used = os.wait4(process.pid, 0)
    error = open("said", encoding="utf-8").read()
    check(os.waitstatus_to_exitcode(status) == 2 and len(error.splitlines()) == 1 and
          "long.csv: a copy of the particles on each rank needs about 0.3 GB" in error, f"status {status}: {error}")
    check(used.ru_maxrss < 100000, f"a file that is refused took {used.ru_maxrss} kB")


def check_field_output():
    """The last step of field output is the layout of its places, volumes and masses. A checkpoint is not one, and says why."""
    words = "-formulation usl -kinematics finite -material neo -dim 2 -cells 6 -basis quadratic -courant 0.3 -amplitude 0.05"
    run(f"run {words} -steps 20 -output out.h5 -output_every 10 -checkpoint kept.h5")
    with h5py.File("out.h5") as file:
        of = file["step_0000000020/particles"]
        columns = [of["coordinates"][:, 0], of["coordinates"][:, 1], of["volume"][:], of["mass"][:]]
        stretch = of["f_xx"][:] * of["f_yy"][:] - of["f_xy"][:] * of["f_yx"][:]
    check(numpy.allclose(columns[2], stretch / 144, rtol=1e-14), "volumes are not det F of the share of a cell")
    check(numpy.allclose(columns[3], 1 / 144, rtol=1e-14), "masses are not those at rest")
    write("out.csv", "x,y,volume,mass", numpy.transpose(columns))
    scheme = "usl -dim 2 -cells 6 -basis quadratic"
    same(limit(f"{scheme} -layout out.h5"), limit(f"{scheme} -layout out.csv"), "field output and CSV", 1e-12)
    same(limit(f"{scheme} -layout out.h5"), run(f"critical {scheme} -layout out.h5", 2)[1]["critical"]["critical_courant"],
         "field output on ranks", 1e-9)
    run(f"run {words} -steps 20 -restart kept.h5 -output again.h5")
    same(limit(f"{scheme} -layout out.h5"), limit(f"{scheme} -layout again.h5"), "output of a checkpoint", 1e-12)
    for file, dim in (("kept.h5", 2), ("out.h5", 1)):
        _, error = run(f"critical usl -dim {dim} -cells 6 -basis quadratic -layout {file}", 1, 2)
        check(len(error.splitlines()) == 1 and "run -restart FILE -output" in error, error)
    with h5py.File("out.h5", "a") as file:
        file["step_0000000020/particles/mass"][3] = -1
    _, error = run(f"critical {scheme} -layout out.h5", 1, 2)
    check("particle 3: mass -1" in error, error)


def check_held():
    """Particles with fixed 1 stay at rest, and the others feel them, on any number of ranks."""
    import random
    random.seed(2)
    rows = [[8 * random.random(), 8 * random.random(), int(p % 5 == 0)] for p in range(120)]
    write("held.csv", "x,y,fixed", rows)
    words = "-formulation musl -dim 2 -basis quadratic -cells 8 -length 8 -courant 0.4 -initial random"
    found = [run(f"run {words} -layout held.csv -steps 30 -output held.h5", ranks)[1]["run"] for ranks in (1, 2)]
    same(found[0]["growth_measured"], found[1]["growth_measured"], "held particles on ranks", 1e-12)
    with h5py.File("held.h5") as file:
        of = file["step_0000000030/particles"]
        speed = abs(of["v_x"][:]) + abs(of["v_y"][:])
    held = numpy.array([row[2] for row in rows]) == 1
    check((speed[held] == 0).all() and (speed[~held] > 0).all(), "held particles move, or the others do not")
    check(run(f"spectrum {words.replace(' -initial random', '')} -layout held.csv")[1]["spectrum"]["step_mismatch"] < 1e-12, "operator and march differ")
    for extra in ("-drift 1/8", "-kinematics finite"):
        _, error = run(f"run {words.replace('musl', 'usl')} -layout held.csv -steps 1 {extra}", 1, 2)
        check(len(error.splitlines()) == 1, error)


def check_written():
    """The particles come back with their bounds, the least of which decides, and the mode; and are a layout again."""
    import random
    random.seed(3)
    write("more.csv", "x,y,volume,mass,young", [[6 * random.random(), 6 * random.random(), *(random.uniform(0.1, 0.4)
                                                 for _ in range(3))] for _ in range(80)])
    scheme = "usl -dim 2 -basis quadratic -cells 6 -length 6"
    found = run(f"critical {scheme} -layout more.csv -write_layout back.csv", 2)[1]["critical"]
    with open("back.csv", encoding="utf-8") as file:
        rows = [{name: float(cell) for name, cell in row.items()} for row in csv.DictReader(file)]
    for name in ("lone", "particle"):
        least = min(range(80), key=lambda i, name=name: rows[i][name])
        same(rows[least][name], found["bounds"][name], f"least bound {name}", 1e-12)
        check(least == found["bounds"][f"{name}_decided_by"]["id"], f"another particle decides {name}")
    speed = [math.hypot(row["mode_x"], row["mode_y"]) for row in rows]
    fastest = found["mode_fastest"]
    check(abs(speed[fastest["id"]] - 1) < 1e-12 and max(speed) < 1 + 1e-5, "the fastest particle")
    same(rows[fastest["id"]]["x"], fastest["place"][0], "the place of the fastest", 1e-12)
    same(limit(f"{scheme} -layout back.csv"), found["critical_courant"], "written and read again", 1e-9)


def check_around():
    """Layouts around that of a file: nearer ones have nearer limits, and an ensemble of them is the same on ranks."""
    write("around.csv", "x", [[(i + 0.3 * (i % 3)) / 2] for i in range(15)])
    scheme = "usl -basis quadratic -cells 8 -length 8 -layout around.csv"
    exact = limit(scheme)
    away = [abs(limit(f"{scheme} -jitter {jitter} -seed 5") / exact - 1) for jitter in (1e-6, 1e-3, 1)]
    check(1e-9 < away[0] < 1e-5 < away[1] < 1e-2 < away[2], f"limits around: {away}")
    shares = [run(f"ensemble {scheme} -jitter 1 -courant 1 -layouts 12", ranks)[1]["ensemble"]["unstable"]
              for ranks in (1, 2)]
    check(shares[0] == shares[1] and 0 < shares[0] < 12, f"an ensemble around a file: {shares}")


BAD = [("", "it is empty"), ("x\n", "no particle"), ("y\n0\n", "line 1: there is no column x"),
       ("x,y\n0,0\n", "line 1: there is a column y"), ("x,volume\n.5,1\n.5,-1\n", "line 3: volume '-1'"),
       ("x\nnan\n", "line 2: x 'nan'"), ("x\n.5\n\n.6\n", "line 3: x ''"), ("x\n.5,.6\n", "line 2: more numbers"),
       ("x,mass\n.5\n", "line 2: fewer numbers"), ("x\n.5\n1.5\n", "line 3: x 1.5 is outside"),
       ("x,x\n1,1\n", "line 1: a column twice"), ("x\n.5e\n", "line 2: x '.5e'"), ("\0\1\2", "line 1: not text"),
       ("\177ELF\2\1\n\0", "line 1: not text"), ("x\n" + "1" * 5000 + "\n", "line 2: not text, or longer"), ("x,volume\n.5,1e-320\n", "line 2: mass, volume"),
       ("x,fixed\n.5,0.5\n", "line 2: fixed '0.5'")]


def check_refusals():
    for text, says in BAD:
        with open("bad.csv", "w", encoding="utf-8") as file:
            file.write(text)
        _, error = run("critical usl -cells 4 -layout bad.csv", 1, 2)
        check(len(error.splitlines()) == 1 and says in error and "layout bad.csv" in error, f"{text!r}: {error}")
    write("good.csv", "x", [[0.1]])
    for words in ("critical usl -layout none.csv", "symbol -layout good.csv",
                  "critical usl -layout good.csv -ppc 2", "critical usl -layout good.csv -neighbourhood lone",
                  "ensemble -layout good.csv"):
        _, error = run(words, 1, 2)
        check(len(error.splitlines()) == 1, f"{words}: {error}")
    for header, more in (("x,y,poisson", 0.2), ("x,y,poisson,young", 0.5)):  # a modulus for each ratio, which is below 1/2
        write("poisson.csv", header, [[0.1, 0.1, 0.3, 1], [0.2, 0.2, more, 1]])
        text = open("poisson.csv", encoding="utf-8").read().replace(",1.0", "" if "young" not in header else ",1.0")
        with open("poisson.csv", "w", encoding="utf-8") as file:
            file.write(text)
        _, error = run("critical usl -dim 2 -layout poisson.csv", 1, 2)
        check(f"line 3: poisson {more}" in error and "with a column young" in error, error)
    write("poisson.csv", "x,y,poisson,young", [[0.1, 0.1, 0.3, 1], [0.2, 0.2, 0.2, 1]])
    _, error = run("critical usl -dim 2 -layout poisson.csv -viscosity 0.1", 1, 2)  # it would be that of the first particle
    check("poisson differs" in error and "viscosity 0.1" in error, error)


def check_poisson():
    """Poisson's ratios of the particles: those of the option where all are alike; march and operator agree, on any ranks; energy stays."""
    rng = numpy.random.default_rng(4)
    for dim, cells, ranks in ((2, 6, 3), (3, 4, 2)):
        places = rng.random((4 * cells ** dim // dim ** 2, dim)) * cells
        n, nu = len(places), rng.uniform(0, 0.45, len(places))
        columns, header = numpy.column_stack([places, rng.uniform(0.5, 1.5, (n, 2))]), "x,y,z"[:2 * dim - 1] + ",young,mass,poisson"
        scheme = f"usl -dim {dim} -basis quadratic -cells {cells} -length {','.join([str(cells)] * dim)}"
        write("alike.csv", header, numpy.column_stack([columns, numpy.full(n, 0.2)]))
        same(limit(f"{scheme} -layout alike.csv -poisson 0.4"), limit(f"{scheme} -layout alike.csv"),
             "ratios that are not the option's", 1e-9)
        write("mixed.csv", header, numpy.column_stack([columns, nu]))
        found = run(f"critical {scheme} -layout mixed.csv -write_layout back.csv", 2)[1]["critical"]
        same(limit(f"{scheme} -layout back.csv -poisson {float(nu[0])!r}"), found["critical_courant"], "ratios written and read again", 1e-9)
        words = f"-formulation musl {scheme[4:]} -layout mixed.csv"
        check(run(f"spectrum {words} -courant 0.3")[1]["spectrum"]["step_mismatch"] < 1e-12, "operator and march differ")
        runs = [run(f"run {words} -courant 0.3 -initial random -steps 30 -output nu.h5 {way}", count)[1]["run"]["energy"]["final"]
                for count, way in ((1, ""), (ranks, ""), (1, "-march plain"))]
        for other in runs[1:]:
            same(runs[0], other, "energies on ranks and of the plain march", 1e-11)
        same(limit(f"{scheme} -layout nu.h5"), found["critical_courant"], "field output", 1e-9)
        energy = run(f"run -formulation rk -rk_on particles {scheme[4:]} -layout mixed.csv -courant 0.005 -initial random -steps 20")[1]["run"]["energy"]
        same(energy["initial"], energy["final"], "the energy of short steps that keep it", 1e-9)


check_lattices()
check_materials()
check_poisson()
check_long()
check_ranks()
check_random()
check_many()
check_field_output()
check_held()
check_written()
check_around()
check_refusals()
