#!/usr/bin/python3
"""Checks the damping of 'symbol -damping' against runs, and the files that have it.

check_damping.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.

Of a run from a standing wave, the Fourier component of each particle field is taken once a period of the drift. Such a
series is a sum of powers of amplification factors. They are the eigenvalues of the map that takes each of its windows to
the next one, and the factor that follows from decay and frequency of the symbol must be among them.
"""
import csv
import math
import sys

from checks import check, loaded, on_ranks, text_of

import h5py
import numpy
import pictures

WAVES = 2  # in the domain of a run
CELLS = 16
SCENES = [  # the scheme, and the denominator of its drift
    ("-formulation usl -transfer flip", 1), ("-formulation usl -transfer pic -basis quadratic", 1),
    ("-formulation musl -transfer apic -basis gimp", 1), ("-formulation usf -transfer xpic -basis cubic", 1),
    ("-formulation elastic -transfer blend -blend_ratio 0.9", 1), ("-formulation gas2 -offset 0.3", 1),
    ("-formulation usl -transfer apic -basis quadratic -gradient mls -drift 1/4", 4),
    ("-formulation musl -transfer flip -drift 1/16", 16), ("-formulation gas2 -transfer pic -drift -1/3", 3),
    ("-formulation usl -transfer pic -drift 1/3 -dim 2", 3)]


def run(words, ranks=1):
    done = on_ranks(ranks, sys.argv[2], *words.split())
    check(done.returncode == 0, f"{words}: status {done.returncode}: {done.stderr}")
    return done.stdout.splitlines()


def components(path, beta):
    """Returns a row for each output step: the Fourier component of each field, at the particles of each place in a cell."""
    rows = []
    with h5py.File(path, "r") as file:
        rest = None
        for name in sorted(name for name in file if name.startswith("step_")):
            particles = file[name]["particles"]
            if rest is None:
                rest = particles["coordinates"][:, 0] * CELLS
            values = [particles[key][()] for key in sorted(particles) if key != "coordinates"]
            cell = numpy.floor(rest)
            kinds = numpy.unique(numpy.round(rest - cell, 9))
            waves = [numpy.where(abs(rest - cell - kind) < 1e-6, numpy.exp(-1j * beta * cell), 0) for kind in kinds]
            rows.append([numpy.dot(value, wave) for value in values for wave in waves])
    return numpy.array(rows)


def factors(rows):
    """Returns the amplification factors of a series, by the map between its windows of two rows each."""
    windows = numpy.hstack([rows[:-1], rows[1:]]).T
    left, sizes, right = numpy.linalg.svd(windows[:, :-1], full_matrices=False)
    kept = sizes > 1e-10 * sizes[0]
    left, sizes, right = left[:, kept], sizes[kept], right[kept]
    return numpy.linalg.eigvals(left.conj().T @ windows[:, 1:] @ right.conj().T / sizes)


def check_run(words, period):
    scene = f"{words} -cells {CELLS}{',1' if 'dim 2' in words else ''} -courant 0.4"
    if "dim 2" in words:
        scene = scene.replace("1/3", "1/3,0")
    run(f"symbol {scene} -damping -damping_divisors 1 -json damping.json")
    found = loaded("damping.json")["symbol"]["damping"]
    beta = 2 * numpy.pi * WAVES / CELLS
    decay, error = found["decay"][0][WAVES - 1], found["frequency_error"][0][WAVES - 1]
    predicted = numpy.exp(-(decay + 1j * beta * (1 + error)) * 0.4 * period)
    mode = f"{WAVES},0" if "dim 2" in words else WAVES
    run(f"run {scene} -mode {mode} -steps {40 * period} -output damping_run.h5 -output_every {period}")
    measured = factors(components("damping_run.h5", beta))
    check(abs(error) < 0.2, f"{words}: frequency error {error} of a wave of {CELLS / WAVES} cells")
    check(min(abs(measured - predicted)) < 1e-12, f"{words}: the symbol has {predicted}, the run {measured}")


def check_files():
    """Table, JSON, CSV and HDF5 have the same numbers, on 1, 2 and 3 ranks."""
    scene = ("symbol -formulation usl -transfer pic -basis quadratic -dim 2 -cells 16,2 -density 2 -sound_speed 10 "
             "-cell_width 0.1 -courant 0.25 -velocity 2.5,0 -damping -damping_divisors 1,4")
    texts = []
    for ranks in (1, 3):
        lines = run(f"{scene} -json files.json -csv files.csv -output files.h5", ranks)
        texts.append(text_of("files.csv"))
    check(len(set(texts)) == 1, "the CSV depends on the number of ranks")
    found, rows = loaded("files.json")["symbol"]["damping"], list(csv.DictReader(texts[0].splitlines()))
    check(found["courant"] == [0.25, 0.0625] and found["wavelength"] == [16, 8, 16 / 3, 4, 3.2], "steps or waves")
    check([float(row["decay"]) for row in rows] == sum(found["decay"], []), "decay in CSV and JSON")
    check([float(row["frequency_error"]) for row in rows] == sum(found["frequency_error"], []), "errors in both")
    check([float(row["kept_a_period"]) for row in rows] ==
          [math.exp(-float(row["decay"]) * float(row["wavelength"])) for row in rows], "kept a period")
    check(found["decay_per_time"] == [[100 * one for one in row] for row in found["decay"]], "decay per time")
    with h5py.File("files.h5", "r") as file:
        for name in ("wavelength", "courant", "decay", "frequency_error", "match"):
            check((file["symbol"][f"damping_{name}"][()] == found[name]).all(), f"{name} in HDF5 and JSON")
    first = next(line for line in lines if line.startswith("  0.25 ")).split()
    for shown, exact in zip(first[2:], (found["decay"][0][0], found["decay_per_time"][0][0], float(
            rows[0]["kept_a_period"]), found["frequency_error"][0][0], found["match"][0][0])):
        check(math.isclose(float(shown), exact, rel_tol=1e-4), f"{shown} in the table, {exact} in JSON")
    still = run("symbol -formulation usl -transfer pic -basis quadratic -damping -damping_divisors 8")
    check(sum("does not travel" in line for line in still) == 2, "the waves of 8 and 4 cells are overdamped")


def check_laws():
    """What docs/damping.md says of long waves and small steps: decay goes like 1 / k, with a power of the wavelength."""
    for transfer, power in (("pic", 2), ("apic", 4)):
        run(f"symbol -formulation usl -basis quadratic -transfer {transfer} -cells 256 -damping -damping_divisors 1,4 "
            "-json laws.json -output laws.h5")
        decay = loaded("laws.json")["symbol"]["damping"]["decay"]
        check(math.isclose(decay[0][1] / decay[0][0], 2**power, rel_tol=2e-3), f"{transfer}: waves of 256 and 128 cells")
        check(math.isclose(decay[1][0] / decay[0][0], 4, rel_tol=2e-3), f"{transfer}: k and k / 4")
    for formulation in ("usf", "musl", "usavg"):
        run(f"symbol -formulation {formulation} -damping -json laws.json")
        decay = loaded("laws.json")["symbol"]["damping"]["decay"]
        check(numpy.abs(decay).max() < 1e-12, f"{formulation} with flip damps")


def check_picture():
    """The picture of the last file has its numbers."""
    figure = pictures.damping("laws.h5")
    with h5py.File("laws.h5", "r") as file:
        for axes, name in zip(figure.axes, ("decay", "frequency_error")):
            drawn = [line.get_ydata() for line in axes.lines]
            check(numpy.array_equal(drawn, file[f"symbol/damping_{name}"][()]), f"the picture of {name}")
    check(all("k = " in text.get_text() for text in figure.axes[1].get_legend().get_texts()), "the legend")


def main():
    check_laws()
    check_picture()
    for words, period in SCENES:
        check_run(words, period)
    check_files()


main()
