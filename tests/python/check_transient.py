#!/usr/bin/python3
"""Checks the HDF5 and JSON of spectrum -powers and -pseudospectrum against the same operator assembled in numpy.

check_transient.py MPIEXEC MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import json
import math
import os
import sys

import h5py
import numpy

from checks import check, forks

CELLS, COURANT, LAST, POINTS = 15, 1.9, 40, 9
TRANSIENT = {"steps", "norm", "largest", "at_step", "seconds"}
PSEUDOSPECTRUM = {"points", "kreiss", "kreiss_at", "seconds"}


def run(command, name, *options):
    """Runs a command. Returns its JSON and its HDF5 file, open."""
    command = [*command, "spectrum", "-measure", "false", *options, "-json", name + ".json", "-output", name + ".h5"]
    done = forks.run(command, capture_output=True, text=True, check=False)
    check(done.returncode == 0 and done.stderr == "", f"{' '.join(command)}: {done.stderr}")
    with open(name + ".json") as file:
        return json.load(file), h5py.File(name + ".h5", "r"), done.stdout


def operator(ppc, offset):
    """Returns the operator of gas2 on hats: u += k D P r, then r += k D P u. All u come before all r."""
    n = CELLS * ppc
    shape, grad = numpy.zeros((n, CELLS)), numpy.zeros((n, CELLS))
    for p in range(n):
        x = (p % ppc + offset) / ppc
        cell, right = p // ppc, (p // ppc + 1) % CELLS
        shape[p, cell], shape[p, right] = 1 - x, x
        grad[p, cell], grad[p, right] = -1, 1
    step = COURANT * grad @ (shape.T / shape.sum(axis=0)[:, None])
    return numpy.block([[numpy.eye(n), step], [step, numpy.eye(n) + step @ step]])


def sigma(matrix, z):
    return numpy.linalg.svd(z * numpy.eye(len(matrix)) - matrix, compute_uv=False)[-1]


def check_powers(result, file, matrix):
    found = result["transient"]
    steps, norms = found["steps"], found["norm"]
    check(set(found) == TRANSIENT, f"keys of transient {set(found) ^ TRANSIENT}")
    check(steps == [*range(17), 20, 25, 32, 40], f"steps {steps}")
    for key, values in (("steps", steps), ("norm", norms)):
        check((file[f"transient/{key}"][:] == values).all(), f"{key} of HDF5 and JSON differ")
    expected = [numpy.linalg.norm(numpy.linalg.matrix_power(matrix, n), 2) for n in steps]
    check(numpy.allclose(norms, expected, rtol=1e-8), f"norms {norms}, numpy {expected}")
    check(math.isclose(found["largest"], max(expected), rel_tol=1e-8), f"largest {found['largest']}")
    check(found["at_step"] == steps[int(numpy.argmax(expected))], f"largest at {found['at_step']}")


def check_sigma(result, file, matrix):
    found = result["pseudospectrum"]
    check(set(found) == PSEUDOSPECTRUM and found["points"] == POINTS, f"keys of pseudospectrum {found}")
    re, im, values = (file[f"pseudospectrum/{key}"][:] for key in ("re", "im", "sigma"))
    check(values.shape == (POINTS, POINTS) and re.shape == im.shape == (POINTS,), f"shapes {values.shape} {re.shape}")
    radius = abs(numpy.linalg.eigvals(matrix)).max()
    axis = numpy.linspace(-1, 1, POINTS) * max(1.3, 1.1 * radius)
    check(numpy.allclose(re, axis) and (re == im).all(), f"axes {re} {im}")
    for i in range(POINTS):
        for j in range(POINTS):
            expected = sigma(matrix, re[j] + 1j * im[i])
            check(abs(values[i, j] - expected) < 1e-9, f"sigma at {re[j]} + {im[i]}i: {values[i, j]}, numpy {expected}")


def check_stable(command, ranks):
    """With one particle in the middle of each cell powers are bounded; numpy must find the same Kreiss constant."""
    matrix = operator(1, 0.5)
    result, file, text = run(command, f"stable_{ranks}", "-cells", str(CELLS), "-ppc", "1", "-courant", str(COURANT),
                             "-powers", str(LAST), "-pseudospectrum", str(POINTS))
    with file:
        check_powers(result, file, matrix)
        check_sigma(result, file, matrix)
    z = complex(*result["pseudospectrum"]["kreiss_at"])
    kreiss = result["pseudospectrum"]["kreiss"]
    check(math.isclose(kreiss, (abs(z) - 1) / sigma(matrix, z), rel_tol=1e-8), f"kreiss {kreiss} at {z}")
    around = [1.0003, 1.001, 1.003, 1.01, 1.03, 1.1, 1.3]
    angles = numpy.exp(1j * numpy.linspace(0, math.pi, 181))
    largest = max((r - 1) / sigma(matrix, r * angle) for r in around for angle in angles)
    check(1 < largest <= kreiss * (1 + 1e-9), f"kreiss {kreiss}, numpy {largest}")
    check("growth is 1, and norms do not go on growing up to n" in text, f"what is printed: {text}")
    return kreiss, result["transient"]["norm"]


def check_unstable(command):
    """With particles off the middle eigenvalues lie outside the unit circle, and there is no Kreiss constant."""
    matrix = operator(2, 0.3)
    result, file, text = run(command, "unstable", "-cells", str(CELLS), "-courant", str(COURANT), "-offset", "0.3",
                             "-powers", str(LAST), "-pseudospectrum", str(POINTS))
    with file:
        check_powers(result, file, matrix)
        check_sigma(result, file, matrix)
    kreiss = [result["pseudospectrum"][key] for key in ("kreiss", "kreiss_at")]
    check(kreiss == [None, None], f"Kreiss constant {kreiss}")
    check("late norms go like growth^n" in text and "infinite" in text, f"what is printed: {text}")


def check_range(command):
    """Norms beyond the range of doubles must be null in JSON and NaN in HDF5. What was not asked for must be absent."""
    result, file, _ = run(command, "range", "-formulation", "gas1", "-cells", "4", "-courant", "1e100", "-powers", "4")
    with file:
        check("pseudospectrum" not in result and "pseudospectrum" not in file, "a pseudospectrum that nobody asked for")
        norms = result["transient"]["norm"]
        check(norms[:4] and norms[4] is None and result["transient"]["largest"] is None, f"norms {norms}")
        check(numpy.isnan(file["transient/norm"][4]) and file["transient/norm"][3] == norms[3], "norms of HDF5")


def main(mpiexec, mpmstab):
    first = None
    for ranks in (1, 3):
        found = check_stable([mpiexec, "-n", str(ranks), mpmstab], ranks)
        first = first or found
        check(math.isclose(found[0], first[0], rel_tol=1e-10), f"kreiss on {ranks} ranks {found[0]}, on one {first[0]}")
        check(numpy.allclose(found[1], first[1], rtol=1e-10), f"norms on {ranks} ranks differ")
    check_unstable([mpmstab])
    check_range([mpmstab])
    left = [name for name in os.listdir(".") if name.endswith(".part")]
    check(not left, f"left behind: {left}")


if __name__ == "__main__":
    main(*sys.argv[1:3])
