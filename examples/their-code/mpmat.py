#!/usr/bin/python3
"""Prints the tables of mpmat.md: the bar of mpmat, probed under Octave, against ours.

mpmat.py [--check]

With --check it fails unless the page has each row. MPMAT_DIR names a clone of mpmat; without it the script looks for mpmat in
the working folder and, without --check, clones it there. The status is 77 where Octave or mpmat is missing.
"""
import numpy
import scipy.io
import scipy.optimize

from sources import HERE, ask, finish, folder_of, need

URL = "https://github.com/vinhphunguyen/mpmat"


def program(*words):
    return ["-program", " ".join(["octave-cli -q", str(HERE / "mpmat.m"), str(MPMAT), *words])]


def matrix(*words):
    """The operator that a spectrum is of."""
    ask("spectrum", *words, "-write_matrix", "found.mtx")
    return scipy.io.mmread("found.mtx").toarray()


def radius(A):
    return numpy.abs(numpy.linalg.eigvals(A)).max()


def apart(one, other):
    """The largest distance between eigenvalues that belong together."""
    distance = numpy.abs(numpy.linalg.eigvals(one)[:, None] - numpy.linalg.eigvals(other)[None])
    return distance[scipy.optimize.linear_sum_assignment(distance)].max()


def at_rest():
    for formulation, double, ppc, courant in (("usl", 0, 1, 0.77), ("usl", 0, 2, 0.77), ("musl", 1, 1, 0.77), ("musl", 1, 2, 1.75)):
        theirs = matrix(*program(f"ppc={ppc}", f"doubleMapping={double}", f"dtime={courant}*deltax/c"))
        ours = matrix("-formulation", formulation, "-boundary", "fixed,free", "-cells", 16, "-ppc", ppc, "-courant", courant)
        close = numpy.abs(theirs - ours).max() < 1e-10 and apart(theirs, ours) < 1e-10
        yield (f"| {formulation} | {ppc} | {courant} | {radius(theirs):.9f} | {radius(ours):.9f} | "
               f"{'below 1e-10' if close else 'larger'} |")


def moving():
    words = ["dtime=0.5*deltax/c", "doubleMapping=1", "L=75", "noElems=48", "middle=40", "shift=0.01", "drift=1/8", "period=8"]
    theirs = ask("symbol", *program(*words))
    ours = ask("symbol", "-formulation", "musl", "-courant", 0.5, "-drift", "1/8", "-offset", 0.52, "-phases", 64)
    return (f"| musl, 64 waves | {theirs['symbol']['growth']:.9f} | {ours['symbol']['growth']:.9f} | {theirs['verdict']} |")


need("octave-cli")
MPMAT = folder_of("MPMAT_DIR", URL, "example1D/mpm1DVibrationBar.m")
if __name__ == "__main__":
    finish("mpmat.md", [*at_rest(), moving()])
