"""The limit of a layout at rest, without a matrix: the step at which the first disturbance changes its sign in each step.

K is the stiffness of the nodes and A what a transfer makes of nodal velocities that it takes to the particles and back,
both over the lumped masses and symmetric. The step is stable below dt^2 = factor / the largest eigenvalue of K C with

    musl, usf, usavg   factor 4      C = A             (flip)
    rk                 factor w^2    C = A             (flip), |R(i w)| = 1
    verlet             factor 4      C = 1             (flip), with share 1/2
    usl                factor 2      C = 1 - A / 2     (flip)
    usl                factor 2      C = (1 + A)^-1    (pic, apic)

which is where the determinant of the step's matrix at the eigenvalue -1 vanishes. (docs/theory.md, section 4)
"""
import sys
import time

import numpy

from . import dt

ACCURACY = 1e-9  # of eigenvalues
CHEBYSHEV = 14   # terms of (1 + A)^-1, whose eigenvalues are from 1/2 to 1: an error of 1e-10
LONG = 10        # seconds that are announced
SMOOTHS = {"quadratic": 4, "cubic": 3}  # D = h^2 over this, of apic


def spread(at, smooth, weigh, v, affine):
    """A v. smooth: the layout with the gradients of the least squares of apic, which are S (x_i - x_p) / D."""
    moved = [(at.root[:, a] * v[:, a])[at.by_node[0]] for a in range(at.dim)]
    found = numpy.zeros_like(v)
    for a in range(at.dim):
        given = at.by_weight * (at.mass * numpy.einsum("ip,ip->p", moved[a], at.by_weight))
        for b in range(at.dim if affine else 0):
            g = smooth.by_node[1][b]
            given += g * (at.mass * at.h[b] ** 2 / weigh * numpy.einsum("ip,ip->p", moved[a], g))
        found[:, a] = at.root[:, a] * numpy.bincount(at.by_node[0].ravel(), given.ravel(), minlength=len(v))
    return found


def inverse(apply, v):
    """(1 + A)^-1 v by Chebyshev's iteration; A has its eigenvalues in [0, 1]."""
    middle, half = 1.5, 0.5
    x, residual, rho = numpy.zeros_like(v), v, half / middle
    step = residual / middle
    for _ in range(CHEBYSHEV):
        x = x + step
        residual = residual - step - apply(step)
        rho_next = 1 / (2 * middle / half - rho)
        step = rho_next * rho * step + 2 * rho_next / half * residual
        rho = rho_next
    return x


class Strains:
    """Products with D^1/2 B C B^T D^1/2, which has the eigenvalues of K C, on a symmetric tensor for each particle."""

    def __init__(self, at, between):
        self.at, self.between = at, between
        root = numpy.sqrt(2 * at.mu)
        self.shear = numpy.sqrt(at.volume) * root
        self.more = numpy.sqrt(at.volume) * (numpy.sqrt(2 * at.mu + at.dim * at.lame) - root) / at.dim

    def weigh(self, tensor):
        trace = numpy.trace(tensor) * self.more
        tensor = (tensor + tensor.swapaxes(0, 1)) / 2 * self.shear
        for a in range(self.at.dim):
            tensor[a, a] += trace
        return tensor

    def product(self, tensor):
        at, d = self.at, range(self.at.dim)
        node, g = at.by_node
        weighed = self.weigh(tensor)
        given = [sum(weighed[a, b] * g[b] for b in d) for a in d]
        v = at.root * numpy.stack([numpy.bincount(node.ravel(), f.ravel(), minlength=len(at.root)) for f in given], -1)
        v = self.between(v) * at.root
        moved = [v[:, a][node] for a in d]
        return self.weigh(numpy.array([[numpy.einsum("ip,ip->p", moved[a], g[b]) for b in d] for a in d]))


def find(at, scheme, transfer="flip", smooth=None, basis="quadratic", products=400, chance=1e-6, seed=1):
    """(dt^2 from below but for the chance, dt^2 from above, factor over it), or None where no such limit is known."""
    if products < 1 or transfer != "flip" and scheme != "usl" or transfer == "apic" and basis == "hats":
        return None
    at.by_weight = numpy.ascontiguousarray(at.S.T)

    def apply(v):
        return spread(at, smooth, SMOOTHS.get(basis), v, transfer == "apic")

    between = {"verlet": lambda v: v, "usl": lambda v: v - apply(v) / 2}.get(scheme, apply)
    if transfer != "flip":
        between = lambda v: inverse(apply, v)  # noqa: E731 (one of three)
    strains = Strains(at, between)
    ids = 2 * numpy.arange(at.dim * at.dim * at.n)
    start = numpy.sqrt(-2 * numpy.log(1 - dt.random(seed, ids))) * numpy.cos(2 * numpy.pi * dt.random(seed, ids + 1))
    start = start.reshape(at.dim, at.dim, at.n)
    start = (start + start.swapaxes(0, 1)) / 2
    begin = time.monotonic()
    strains.product(start)
    if (seconds := products * (time.monotonic() - begin)) > LONG:
        print(f"the limit takes up to {seconds:.0f} s (-products 0 leaves it out)", file=sys.stderr)
    level = dt.certain(at.n * at.dim * (at.dim + 1) // 2, chance)
    most, least, _ = dt.lanczos(strains.product, start, level, products, accuracy=ACCURACY)
    factor = dt.FACTOR[scheme]
    return (factor / most, factor / least) if least > 0 else (numpy.inf, numpy.inf)
