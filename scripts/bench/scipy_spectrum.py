"""Finds eigenvalues as a Python user would, and prints them as JSON.

scipy_spectrum.py near FILE RE IM | largest FILE RESTARTS | all FILE

FILE is a matrix in PETSc's binary format. The times are those of the solver, without reading.
"""
import json
import resource
import sys
import time

import numpy
import scipy.sparse
import scipy.sparse.linalg

MATRIX = 1211216  # PETSc marks a matrix by this number; rows, columns and nonzeros follow, big-endian


def read(path):
    with open(path, "rb") as file:
        kind, rows, columns, nonzeros = numpy.fromfile(file, ">i4", 4)
        if kind != MATRIX:
            sys.exit(f"{path}: no matrix in PETSc's binary format with 32-bit integers")
        starts = numpy.concatenate(([0], numpy.cumsum(numpy.fromfile(file, ">i4", rows))))
        where = numpy.fromfile(file, ">i4", nonzeros).astype(numpy.int32)
        values = numpy.fromfile(file, ">f8", nonzeros).astype(float)
    return scipy.sparse.csr_matrix((values, where, starts.astype(numpy.int32)), shape=(rows, columns))


def timed(work, *args, **options):
    start = time.perf_counter()
    found = work(*args, **options)
    return time.perf_counter() - start, found


def near(matrix, re, im):
    """Solves by ARPACK with shift-invert, by a complex SuperLU."""
    seconds, (values, vectors) = timed(scipy.sparse.linalg.eigs, matrix.astype(complex), k=1, sigma=complex(re, im))
    residual = numpy.linalg.norm(matrix @ vectors[:, 0] - values[0] * vectors[:, 0])
    return {"seconds": seconds, "re": values[0].real, "im": values[0].imag, "residual": residual}


def largest(matrix, restarts):
    """Solves by ARPACK alone, which may give no answer."""
    start = time.perf_counter()
    try:
        values = scipy.sparse.linalg.eigs(matrix, k=1, which="LM", maxiter=restarts, return_eigenvectors=False)
    except scipy.sparse.linalg.ArpackNoConvergence as error:
        values = error.eigenvalues
    found = {"seconds": time.perf_counter() - start, "restarts": restarts, "converged": len(values)}
    return found | ({"size": float(abs(values[0]))} if len(values) else {})


def everything(matrix):
    """Solves by numpy's dense solver, with vectors and without."""
    dense = matrix.toarray()
    eig_s, (values, _) = timed(numpy.linalg.eig, dense)
    eigvals_s, alone = timed(numpy.linalg.eigvals, dense)
    return {"eig_s": eig_s, "eigvals_s": eigvals_s, "count": len(values), "radius": float(max(abs(values))),
            "radius_alone": float(max(abs(alone)))}


def memory_limit():
    """Limits memory to what is free. The solver then fails by itself, and the machine ends no other program."""
    with open("/proc/meminfo", encoding="utf-8") as file:
        free = next(1024 * int(line.split()[1]) for line in file if line.startswith("MemAvailable"))
    resource.setrlimit(resource.RLIMIT_AS, (free, free))


def main():
    task, path, *more = sys.argv[1:]
    memory_limit()
    matrix = read(path)
    if task == "near":
        found = near(matrix, *map(float, more))
    elif task == "largest":
        found = largest(matrix, int(more[0]))
    else:
        found = everything(matrix)
    print(json.dumps(found))


if __name__ == "__main__":
    main()
