#!/usr/bin/python3
"""Checks the HDF5, CSV and JSON of spectrum and symbol against the same operator assembled in numpy.

check_spectrum_files.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import csv
import json
import math
import os
import sys

import h5py
import numpy

from checks import check, forks

CELLS, PPC, COURANT, MODES = 15, 2, 1.9, 5
SCENE = f"-formulation gas2 -cells {CELLS} -ppc {PPC} -courant {COURANT} -offset 0.3".split()
TOP = {"version", "task", "formulation", "basis", "transfer", "boundary", "dim", "cells", "ppc", "particles", "courant",
       "drift", "gradient", "ranks", "wall_s", "verdict", "growth", "tolerance", "uncertainty", "evidence", "predicted", "offset"}
PREDICTED = {"published", "corrected", "symbol", "corrected_off_by"}
SPECTRUM = {"unknowns", "nonzeros", "period_steps", "assemble_s", "solve_s", "solver", "converged", "listed",
            "spectral_radius", "growth", "max_residual", "step_mismatch", "symbol_mismatch", "condition", "at_one",
            "unseen", "memory_bytes"}
SYMBOL = {"phases", "growth", "beta_at_max", "seconds"}


def run(mpiexec, mpmstab, ranks, task, *options):
    name = f"{task}_{ranks}"
    for ending in (".h5", ".json", ".csv"):
        if os.path.exists(name + ending):
            os.remove(name + ending)
    command = [mpiexec, "-n", str(ranks), mpmstab, task, *SCENE, *options, "-output", name + ".h5", "-json",
               name + ".json", "-csv", name + ".csv"]
    done = forks.run(command, capture_output=True, text=True, check=False)
    check(done.returncode == 0 and done.stderr == "", f"{' '.join(command)}: {done.stderr}")
    left = [f for f in os.listdir(".") if f.endswith((".part", ".xmf")) and f.startswith(task)]
    check(not left, f"left behind: {left}")
    return name


def maps():
    """Returns P2G (nodes x particles) and GRAD (particles x nodes) of the hat basis."""
    n = CELLS * PPC
    shape, grad = numpy.zeros((n, CELLS)), numpy.zeros((n, CELLS))
    for p in range(n):
        x = (p % PPC + 0.3) / PPC
        cell, right = p // PPC, (p // PPC + 1) % CELLS
        shape[p, cell], shape[p, right] = 1 - x, x
        grad[p, cell], grad[p, right] = -1, 1
    return shape.T / shape.sum(axis=0)[:, None], grad


def operator():
    """Returns the operator of gas2: u += k D P r, then r += k D P u. The state is ordered particle by particle."""
    p2g, grad = maps()
    n, step = CELLS * PPC, COURANT * grad @ p2g
    whole = numpy.block([[numpy.eye(n), step], [step, numpy.eye(n) + step @ step]])
    order = numpy.arange(2 * n).reshape(2, n).T.ravel()
    return whole[numpy.ix_(order, order)]


def distance(one, other):
    return max(abs(other - value).min() for value in one)


def check_modes(file, values, matrix):
    """Checks that the stored modes are eigenvectors, in the order of the eigenvalues."""
    check(sorted(file["modes"]) == [f"{j + 1:04d}" for j in range(MODES)] + ["coordinates"], f"modes {sorted(file['modes'])}")
    places = [(p // PPC + (p % PPC + 0.3) / PPC) / CELLS for p in range(CELLS * PPC)]
    check(numpy.allclose(file["modes/coordinates"][:], places, rtol=0, atol=1e-15), "places of the modes' particles")
    for j in range(MODES):
        group = file[f"modes/{j + 1:04d}"]
        state = numpy.empty(2 * CELLS * PPC, complex)
        for f, field in enumerate(("u", "r")):
            state[f::2] = group[f"{field}_re"][:] + 1j * group[f"{field}_im"][:]
        check(abs(group.attrs["re"] + 1j * group.attrs["im"] - values[j]) < 1e-14, f"eigenvalue of mode {j + 1}")
        check(math.isclose(group.attrs["growth"], abs(values[j])), f"growth of mode {j + 1}")
        check(abs(matrix @ state - values[j] * state).max() < 1e-12, f"mode {j + 1} is not an eigenvector")


def check_spectrum(name):
    matrix, p2g = operator(), maps()[0]
    with h5py.File(name + ".h5", "r") as file:
        check(file.attrs["formulation"] in ("gas2", b"gas2") and "version" in file.attrs, "scene attributes")
        pairs = file["spectrum/eigenvalues"][:]
        check(pairs.shape == (2 * CELLS * PPC, 2), f"eigenvalues {pairs.shape}")
        values = pairs[:, 0] + 1j * pairs[:, 1]
        check(max(distance(values, numpy.linalg.eigvals(matrix)), distance(numpy.linalg.eigvals(matrix), values)) < 1e-7,
              "eigenvalues are not numpy's")
        check((numpy.diff(abs(values)) < 1e-7).all(), "eigenvalues are not in order")
        check(file["spectrum/residuals"].shape == (len(values),) and max(file["spectrum/residuals"][:]) < 1e-13, "residuals")
        check_modes(file, values, matrix)
        beta, share = file["spectrum/beta"][:], file["spectrum/null_share"][:]
        check(numpy.nanmax(beta) <= math.pi and ((share >= 0) & (share < 1 + 1e-9)).all(), "beta or null_share")
        row_space = numpy.linalg.pinv(p2g) @ p2g
        for j in range(MODES):
            state = [file[f"modes/{j + 1:04d}/{f}_re"][:] + 1j * file[f"modes/{j + 1:04d}/{f}_im"][:] for f in "ur"]
            unseen = math.sqrt(sum(numpy.linalg.norm(q - row_space @ q) ** 2 for q in state))
            check(abs(unseen - share[j]) < 1e-7, f"null_share of mode {j + 1}: {share[j]}, numpy {unseen}")
            power = sum(abs(numpy.fft.fft(p2g @ q)) ** 2 for q in state)
            power = power + numpy.roll(power[::-1], 1)  # +-beta
            check(abs(2 * math.pi * power[: CELLS // 2 + 1].argmax() / CELLS - beta[j]) < 1e-9, f"beta of mode {j + 1}")
        factors = file["symbol/factors"][:]
        check(factors.shape == (CELLS, 4 * PPC), f"factors {factors.shape}")
        check(distance(values, (factors[:, ::2] + 1j * factors[:, 1::2]).ravel()) < 1e-7, "symbol and eigenvalues")
    with open(name + ".csv") as file:
        rows = list(csv.DictReader(file))
    check(len(rows) == len(values), f"{len(rows)} rows")
    for row, value, b in zip(rows, values, beta):
        check(float(row["re"]) == value.real and float(row["im"]) == value.imag, "eigenvalues of the CSV")
        check(row["beta"] == "" if math.isnan(b) else float(row["beta"]) == b, "beta of the CSV")


def check_spectrum_json(name, ranks):
    with open(name + ".json") as file:
        result = json.load(file)
    check(set(result) == TOP | {"spectrum", "symbol", "run"}, f"keys {set(result) ^ (TOP | {'spectrum', 'symbol', 'run'})}")
    check(set(result["spectrum"]) == SPECTRUM, f"keys of spectrum {set(result['spectrum']) ^ SPECTRUM}")
    check(set(result["symbol"]) == SYMBOL, f"keys of symbol {set(result['symbol']) ^ SYMBOL}")
    check(set(result["predicted"]) == PREDICTED, f"keys of predicted {set(result['predicted']) ^ PREDICTED}")
    check(result["ranks"] == ranks and result["verdict"] == "unstable", "scene or verdict")
    radius = abs(numpy.linalg.eigvals(operator())).max()
    for value in (result["spectrum"]["spectral_radius"], result["symbol"]["growth"], result["growth"]):
        check(math.isclose(value, radius, rel_tol=1e-9), f"{value}, numpy {radius}")
    check(result["spectrum"]["step_mismatch"] < 1e-14 and result["spectrum"]["symbol_mismatch"] < 1e-7, "mismatches")
    return result


def check_symbol(name, phases):
    with h5py.File(name + ".h5", "r") as file:
        beta, growth, factors = (file[f"symbol/{key}"][:] for key in ("beta", "growth", "factors"))
        corrected = file["symbol/corrected"][:]
    check(numpy.allclose(beta, 2 * math.pi * numpy.arange(phases) / phases), "beta")
    check(numpy.allclose(abs(factors[:, ::2] + 1j * factors[:, 1::2]).max(axis=1), growth), "growth is not the largest factor")
    mu = -0.2 * (1 - numpy.cos(beta)) + 1j * numpy.sin(beta)  # places 0.15 and 0.65: e = C1 - C2 = -0.2
    half = 1 + COURANT**2 * mu**2 / 2
    root = numpy.sqrt(half**2 - 1)
    check(numpy.allclose(corrected, numpy.maximum(abs(half + root), abs(half - root)), atol=1e-7), "corrected")
    check(numpy.allclose(numpy.maximum(corrected, 1), growth, atol=1e-7), "corrected is not the symbol's")
    with open(name + ".csv") as file:
        rows = list(csv.DictReader(file))
    check(len(rows) == phases // 2 + 1 and set(rows[0]) == {"beta", "growth", "growth_seen", "published", "corrected"},
          f"CSV: {len(rows)} rows of {set(rows[0])}")
    check(numpy.allclose([float(r["growth"]) for r in rows], growth[: phases // 2 + 1]), "growth of the CSV")


def plane_growth(beta, courant, poisson):
    """Returns the growth of usl with hats and a centred particle a cell, from the stiffness K at each phase."""
    alpha, kappa, mu = numpy.cos(beta / 2) ** 2, 4 * numpy.sin(beta / 2) ** 2, 1j * numpy.sin(beta)
    first, second = poisson / (1 - poisson), (1 - 2 * poisson) / (2 - 2 * poisson)
    largest = []
    for a, k, m in zip(alpha, kappa, mu):
        form = numpy.array([[k[0] * a[1], m[0].conj() * m[1]], [m[1].conj() * m[0], k[1] * a[0]]])
        stiffness = first * form + second * (form.trace() * numpy.eye(2) + form.conj())
        steps = courant**2 * numpy.linalg.eigvalsh(stiffness)
        largest.append(max(abs(numpy.roots([1, s - 2, 1 + (a[0] * a[1] - 1) * s])).max() for s in steps))
    return numpy.array(largest)


def check_plane(mpiexec, mpmstab, ranks):
    """Two dimensions: the files have all phases, x fastest, and JSON lists of two."""
    command = [mpiexec, "-n", str(ranks), mpmstab, "symbol", *"-dim 2 -formulation usl -ppc 1 -courant 0.8 -poisson".split(),
               "0.2", *"-cells 6,4 -output plane.h5 -json plane.json -csv plane.csv".split()]
    done = forks.run(command, capture_output=True, text=True, check=False)
    check(done.returncode == 0 and done.stderr == "", f"{' '.join(command)}: {done.stderr}")
    with h5py.File("plane.h5", "r") as file:
        beta, growth, factors = (file[f"symbol/{key}"][:] for key in ("beta", "growth", "factors"))
        corrected = file["symbol/corrected"][:]
    phases = [[2 * math.pi * x / 6, 2 * math.pi * y / 4] for y in range(4) for x in range(6)]
    check(beta.shape == (24, 2) and numpy.allclose(beta, phases), "beta of the plane")
    check(numpy.allclose(abs(factors[:, ::2] + 1j * factors[:, 1::2]).max(axis=1), growth), "factors of the plane")
    check(numpy.allclose(corrected, plane_growth(beta, 0.8, 0.2), atol=1e-7), "corrected of the plane")
    check(numpy.allclose(numpy.maximum(corrected, 1), growth, atol=1e-7), "growth of the plane")
    with open("plane.csv") as file:
        rows = list(csv.DictReader(file))
    check(len(rows) == 24 and {"beta_x", "beta_y", "growth", "corrected"} < set(rows[0]), f"CSV: {rows[0]}")
    check(numpy.allclose([[float(r["beta_x"]), float(r["beta_y"])] for r in rows], beta), "phases of the CSV")
    check(numpy.allclose([float(r["growth"]) for r in rows], growth), "growth of the CSV of the plane")
    with open("plane.json") as file:
        symbol = json.load(file)["symbol"]
    worst = beta[growth >= growth.max() - 1e-12][0]
    check(symbol["phases"] == [6, 4] and numpy.allclose(symbol["beta_at_max"], worst), f"symbol {symbol}")
    check(math.isclose(symbol["growth"], growth.max(), rel_tol=1e-14), "growth of the JSON")


def check_turned(mpmstab):
    """Multiplies an eigenvector by i, which keeps it one. A run must then start from its imaginary part."""
    scene = "-formulation gas2 -cells 8 -courant 2.05".split()
    for command in (["spectrum", *scene, "-modes", "1", "-output", "turned.h5"], None,
                    ["run", *scene, "-initial", "eigenmode", "-mode_file", "turned.h5", "-json", "turned.json"]):
        if command:
            done = forks.run([mpmstab, *command], capture_output=True, text=True, check=False)
            check(done.returncode == 0, f"{command}: {done.stderr}")
            continue
        with h5py.File("turned.h5", "r+") as file:
            for field in ("u", "r"):
                re, im = file[f"modes/0001/{field}_re"], file[f"modes/0001/{field}_im"]
                check(abs(re[:]).max() > 0 and abs(im[:]).max() == 0, "the mode of a real eigenvalue is not real")
                im[...], re[...] = re[:], 0
    with open("turned.json") as file:
        growth = json.load(file)["run"]["growth_measured"]
    check(math.isclose(growth, 1.5625, rel_tol=1e-6), f"the turned mode grows by {growth}")


def check_tampered(mpmstab):
    """A mode file that was changed must be refused as the start of a run, in a line that says why."""
    def array(file):
        del file.attrs["cells"]
        file.attrs["cells"] = [8] * 1000

    def text(file):
        del file.attrs["cells"]
        file.attrs["cells"] = numpy.bytes_("eight")

    def short(file):
        del file["modes/0001/u_re"]
        file["modes/0001/u_re"] = numpy.zeros(3)

    def gone(file):
        del file["modes/0001/u_re"]

    def infinite(file):
        file["modes/0001/u_re"][0] = numpy.inf

    def zero(file):
        for values in file["modes/0001"].values():
            values[...] = 0

    scene = "-formulation gas2 -cells 8 -courant 2.05".split()
    forks.run([mpmstab, "spectrum", *scene, "-modes", "1", "-output", "whole.h5"], capture_output=True, check=True)
    with open("whole.h5", "rb") as file:
        whole = file.read()
    for change, why in ((array, "no cells in it"), (text, "no cells in it"),
                        (short, "/modes/0001/u_re is not 16 numbers"), (gone, "/modes/0001/u_re is not 16 numbers"),
                        (infinite, "/modes/0001/u_re holds a value that is not finite"), (zero, "mode 1 is zero"),
                        (None, "cut short or damaged")):
        with open("tampered.h5", "wb") as file:
            file.write(whole if change else whole[: len(whole) // 2])
        if change:
            with h5py.File("tampered.h5", "r+") as file:
                change(file)
        done = forks.run([mpmstab, "run", *scene, "-initial", "eigenmode", "-mode_file", "tampered.h5"],
                         capture_output=True, text=True, check=False)
        lines = done.stderr.splitlines()
        check(done.returncode == 2 and len(lines) == 1 and
              lines[0].startswith(f"mpmstab: mode_file tampered.h5: {why}; allowed: "), f"{why}: {done.stderr}")


def check_balanced(mpmstab):
    """An eigenvector of a bar of two materials must grow as predicted, though it was solved for in other variables.

    It must be refused for a bar whose second material lies elsewhere.
    """
    bar = ["-formulation", "musl", "-cells", "8", "-material", "two", "-density_ratio", "1e3", "-stiffness_ratio", "1e6",
           "-courant", "0.07", "-boundary", "fixed,free"]
    mode = ["run", *bar, "-steps", "60", "-initial", "eigenmode", "-mode_file", "bar.h5", "-json", "bar.json"]
    for options in (["spectrum", *bar, "-inclusion", "0,4", "-output", "bar.h5", "-measure", "false"],
                    [*mode, "-inclusion", "0,4"]):
        done = forks.run([mpmstab, *options], capture_output=True, text=True, check=False)
        check(done.returncode == 0, f"{options}: {done.stderr}")
    with open("bar.json") as file:
        found = json.load(file)
    check(found["growth"] > 1.01 and math.isclose(found["growth"], found["predicted"]["eigenmode"], rel_tol=1e-9),
          f"growth {found['growth']}, eigenvalue {found['predicted']['eigenmode']}")
    done = forks.run([mpmstab, *mode, "-inclusion", "1,2"], capture_output=True, text=True, check=False)
    check(done.returncode == 2 and "its inclusion_from is 0, the scene's is 1; allowed: the same" in done.stderr,
          f"a mode of another bar: {done.stderr}")


def check_critical(mpmstab):
    """Checks the JSON and CSV of critical: a limit with its reason, and no limit. The golden set has the survey (critical-29)."""
    def ask(*options):
        done = forks.run([mpmstab, "critical", *options], capture_output=True, text=True, check=False)
        check(done.returncode == 0, f"critical {options}: {done.stderr}")

    ask("-formulation", "usl", "-json", "usl.json", "-csv", "usl.csv")
    with open("usl.json") as file:
        result = json.load(file)
    limit = 1 / math.sqrt(1.75)  # q = 3/16
    keys = {"critical_courant", "limited_by_beta", "evaluations", "seconds", "stable_at", "unstable_at", "closed_form",
            "threshold", "growth_when_drifting", "layouts", "recommended"}
    check(result["task"] == "critical" and result["boundary"] == "periodic" and result["verdict"] == "stable", "usl")
    check(set(result["critical"]) == keys, f"keys of critical {set(result['critical']) ^ keys}")
    for key in ("critical_courant", "closed_form", "stable_at", "unstable_at"):
        check(math.isclose(result["critical"][key], limit, rel_tol=3e-6), f"usl: {key} {result['critical'][key]}")
    check(math.isclose(result["critical"]["limited_by_beta"], math.pi), "usl: phase")
    with open("usl.csv") as file:
        rows = list(csv.DictReader(file))
    check(len(rows) == 1 and math.isclose(float(rows[0]["critical_courant"]), limit, rel_tol=3e-6), f"usl: {rows}")
    ask("-dim", "2", "-formulation", "usl", "-transfer", "apic", "-gradient", "mls", "-basis", "quadratic", "-json",
        "mls.json", "-csv", "mls.csv")
    with open("mls.json") as file:
        found = json.load(file)["critical"]
    more = {"bound", "limited_by_wave", "phases", "growth_when_drifting_diagonally"}
    check(set(found) == keys | more, f"keys of critical in two dimensions {set(found) ^ (keys | more)}")
    check(found["limited_by_wave"] == "P" and math.isclose(max(found["limited_by_beta"]), math.pi) and
          len(found["limited_by_beta"]) == 2 and math.isclose(found["bound"], math.sqrt(0.7)), f"mls: {found}")
    with open("mls.csv") as file:
        row = next(csv.DictReader(file))
    check(row["ppc"] == "2,2" and row["boundary"] == "periodic,periodic" and row["limited_by_wave"] == "P" and
          float(row["limited_by_beta_x"]) == found["limited_by_beta"][0], f"mls: {row}")
    ask("-formulation", "usf", "-cells", "8", "-ppc", "1", "-fill", "3,4", "-json", "lone.json")
    with open("lone.json") as file:
        check("critical_courant" not in json.load(file)["critical"], "a lone particle has no limit with usf")


def main(mpiexec, mpmstab):
    first = None
    for ranks in (1, 2):
        name = run(mpiexec, mpmstab, ranks, "spectrum", "-modes", str(MODES))
        check_spectrum(name)
        result = check_spectrum_json(name, ranks)
        first = first or result
        check(math.isclose(result["growth"], first["growth"], rel_tol=1e-12), f"growth on {ranks} ranks differs")
    for ranks in (1, 3):
        check_symbol(run(mpiexec, mpmstab, ranks, "symbol", "-phases", "60"), 60)
        check_plane(mpiexec, mpmstab, ranks)
    check_tampered(mpmstab)
    check_turned(mpmstab)
    check_balanced(mpmstab)
    check_critical(mpmstab)


if __name__ == "__main__":
    main(*sys.argv[1:3])
