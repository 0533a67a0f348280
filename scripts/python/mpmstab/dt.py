"""The largest stable time step of particles as they stand now, in numpy: the bounds of include/mpmstab_dt.h.

    from mpmstab import dt

    found = dt.step(x, volume, mass, h=h, young=1e5, poisson=0.3, scheme="musl", basis="quadratic")
    found.dt, found.particle

K = sum_p V_p B_p^T C_p B_p is the stiffness of the nodes, M has their lumped masses, and omega2 is the largest eigenvalue of
M^-1 K. The step is stable at rest while dt^2 omega2 <= factor. Volumes and moduli are those of now. The bounds of omega2:

    lone      each particle as if it were alone; infinite where a particle meets a node on hats
    particle  the mass of a node split between particles by V_p |grad S_ip|, and sweeps improvements
    lanczos   a certificate from a random start: wrong with the probability chance, some nine tenths of the exact step
"""
from collections import namedtuple

import numpy

WIDTH = {"hats": 2, "quadratic": 3, "cubic": 4}
# dt^2 omega2 <= factor. mls-mpm is usl with apic and the gradients of mls: dt^2 <= 2 / omega2 + 2 / lone.
FACTOR = {"usl": 2, "mls-mpm": 2, "usf": 4, "musl": 4, "usavg": 4, "verlet": 4, "rk3": 3, "kg3": 4, "rk4": 8, "kg5": 16}
LEAST_SHARE, NO_LENGTH, ROUNDING = 1e-8, 1e-14, 1e-7

Step = namedtuple("Step", "dt omega2 omega2_least particle bound mode")


def line(t, basis):
    """Weights and gradients per cell in one direction at t cells, and the first node."""
    first = numpy.floor(t - 0.5 if basis == "quadratic" else t)
    f = t - first
    e = 1 - f
    if basis == "hats":
        S, g = (e, f), (-numpy.ones_like(f), numpy.ones_like(f))
    elif basis == "quadratic":
        S, g = ((1.5 - f) ** 2 / 2, 0.75 - e * e, (f - 0.5) ** 2 / 2), (f - 1.5, 2 * e, f - 0.5)
    else:
        S = (e ** 3 / 6, 2 / 3 - f * f + f ** 3 / 2, 2 / 3 - e * e + e ** 3 / 2, f ** 3 / 6)
        g = (-e * e / 2, 1.5 * f * f - 2 * f, 2 * e - 1.5 * e * e, f * f / 2)
        first, f = first - 1, f + 1
    return first, f, numpy.stack(S, -1), numpy.stack(g, -1)


def random(seed, ids):
    """Random numbers in [0, 1) by splitmix64 (Steele, Lea and Flood 2014)."""
    with numpy.errstate(over="ignore"):
        z = numpy.uint64(seed) + (ids.astype(numpy.uint64) + numpy.uint64(1)) * numpy.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> numpy.uint64(30))) * numpy.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> numpy.uint64(27))) * numpy.uint64(0x94D049BB133111EB)
    return ((z ^ (z >> numpy.uint64(31))) >> numpy.uint64(11)) / 2.0 ** 53


def positive(name, values, particles):
    values = numpy.broadcast_to(numpy.asarray(values, float), (particles,))
    bad = numpy.flatnonzero(~((values > 0) & (values < numpy.inf)))
    if bad.size:
        raise ValueError(f"{name} of particle {bad[0]} is {values[bad[0]]}; it must be a positive number")
    return values


class Layout:
    """Particles on a grid whose node (i, j, k) has the number i + nx (j + ny k).

    x: n places of dim numbers; volume, mass and moduli: n numbers or one. h, origin, nodes, periodic: one for each direction
    or one for all; without nodes the grid is as large as the particles need. gradient: basis or mls (MLS-MPM). fixed: nodes
    whose velocity is zero, or for each node and direction whether a wall sets it.
    """

    def __init__(self, x, volume, mass, *, h, young=None, poisson=None, lame=None, mu=None, basis="quadratic",
                 gradient="basis", nodes=None, origin=None, periodic=False, fixed=None):
        x = numpy.asarray(x, float)
        x = x[:, None] if x.ndim == 1 else x
        self.n, self.dim = x.shape
        self.volume, self.mass = positive("volume", volume, self.n), positive("mass", mass, self.n)
        self.lame, self.mu = moduli(self.n, self.dim, young, poisson, lame, mu)
        h = numpy.broadcast_to(numpy.asarray(h, float), (self.dim,))
        if nodes is None:
            origin = h * (numpy.floor(x.min(axis=0) / h) - 2)
            nodes = numpy.floor((x.max(axis=0) - origin) / h) + 4
        self.shape, self.h = numpy.broadcast_to(numpy.asarray(nodes, int), (self.dim,)), h
        self.origin = numpy.broadcast_to(numpy.asarray(0.0 if origin is None else origin), (self.dim,))
        t = (x - self.origin) / h
        self.set_weights(t, h, basis, gradient, numpy.broadcast_to(periodic, (self.dim,)))
        # for products, which then run along the particles
        self.by_node = numpy.ascontiguousarray(self.node.T), numpy.ascontiguousarray(numpy.moveaxis(self.g, (2, 1, 0), (0, 1, 2)))
        self.nodal_mass = self.sum_nodes(self.mass[:, None] * self.S)
        self.walls = numpy.zeros((len(self.nodal_mass), self.dim), bool)
        if fixed is not None:
            fixed = numpy.asarray(fixed)
            self.walls[() if fixed.dtype == bool else fixed] = fixed if fixed.ndim == 2 else fixed[:, None] if fixed.dtype == bool else True
        self.free = (self.nodal_mass > 0)[:, None] & ~self.walls
        self.root = numpy.where(self.free, 1 / numpy.sqrt(numpy.where(self.free, self.nodal_mass[:, None], 1)), 0)

    def set_weights(self, t, h, basis, gradient, periodic):
        width = WIDTH[basis]
        self.node, to = numpy.zeros((self.n, 1), int), 1
        self.S = numpy.ones((self.n, 1))
        self.g = numpy.ones((self.n, 1, self.dim))
        for a in range(self.dim):
            first, f, S, g = line(t[:, a], basis)
            inside = numpy.isfinite(first) & (periodic[a] | ((first >= 0) & (first + width <= self.shape[a])))
            if not inside.all():
                raise ValueError(f"particle {numpy.flatnonzero(~inside)[0]} is at {t[~inside][0] * h}, which is not in the grid")
            if gradient == "mls" and basis != "hats":
                g = (4 if basis == "quadratic" else 3) * S * (numpy.arange(width) - f[:, None])
            index = to * ((first[:, None] + numpy.arange(width)).astype(int) % self.shape[a])
            to *= self.shape[a]
            # x runs fastest
            self.node = (index[:, :, None] + self.node[:, None, :]).reshape(self.n, -1)
            self.S, S_before = (S[:, :, None] * self.S[:, None, :]).reshape(self.n, -1), self.S
            slopes = [(g[:, :, None] / h[a] * S_before[:, None, :] if c == a else S[:, :, None] * self.g[:, None, :, c])
                      for c in range(self.dim)]
            self.g = numpy.stack([s.reshape(self.n, -1) for s in slopes], -1)

    def sum_nodes(self, values):
        """Sums what particles give to their nodes."""
        return numpy.bincount(self.node.ravel(), values.ravel(), minlength=int(numpy.prod(self.shape)))

    def of_particles(self, part):
        """The largest eigenvalue of C applied to sym(. G), G = sum_i part g g^T, of each particle."""
        G = numpy.einsum("pi,pia,pib->pab", part, self.g, self.g)
        G = numpy.maximum(numpy.linalg.eigvalsh(G), 0)
        root = numpy.sqrt(G)
        T = self.lame[:, None, None] * root[:, :, None] * root[:, None, :]
        T += 2 * self.mu[:, None, None] * numpy.einsum("pa,ab->pab", G, numpy.eye(self.dim))
        return numpy.linalg.eigvalsh(T)[:, -1]

    def lone(self, walls=True):
        """The bound of each particle as if it were alone, or beside walls."""
        slope = numpy.any(self.g != 0, axis=-1) & (~self.walls.all(axis=1)[self.node] if walls else True)
        meets = (slope & (self.S <= 0)).any(axis=1)
        part = slope * (self.volume / self.mass)[:, None] / numpy.where(self.S > 0, self.S, 1)
        return numpy.where(meets, numpy.inf, self.of_particles(part))

    def particle(self, sweeps=0):
        """The least bound of all splits of the masses of nodes, and the particle that decides."""
        share, least = numpy.ones(self.n), (numpy.inf, -1)
        for _ in range(sweeps + 1):
            own = self.split(share)
            least = min(least, (own.max(), int(own.argmax())))
            if not own.max() > 0:
                break
            share = numpy.maximum(share * own / own.max(), LEAST_SHARE)
        return least

    def split(self, share):
        """The bound of each particle, where a node's mass is split by share V |grad S|."""
        length = numpy.sqrt(numpy.sum(self.g ** 2, axis=-1))
        total = self.sum_nodes((self.volume * share)[:, None] * length)
        per_mass = numpy.where(self.free.any(axis=1), total / numpy.where(self.nodal_mass > 0, self.nodal_mass, 1), 0)
        return self.of_particles(per_mass[self.node] / (numpy.where(length > 0, length, 1) * share[:, None]))

    def product(self, v, energies=False):
        """M^-1/2 K M^-1/2 v, v of nodes x dim; or the strain energies of the particles, twice."""
        d, node = range(self.dim), self.by_node[0]
        moved = [(self.root[:, a] * v[:, a])[node] for a in d]
        L = [[numpy.einsum("ip,ip->p", moved[a], self.by_node[1][b]) for b in d] for a in d]
        pressure = self.lame * sum(L[a][a] for a in d)
        f = [[self.volume * (self.mu * (L[a][b] + L[b][a]) + (pressure if a == b else 0)) for b in d] for a in d]
        if energies:
            return sum(f[a][b] * L[a][b] for a in d for b in d)
        given = [sum(f[a][b] * self.by_node[1][b] for b in d) for a in d]
        return self.root * numpy.stack([numpy.bincount(node.ravel(), g.ravel(), minlength=len(v)) for g in given], -1)

    def lanczos(self, products=20, chance=1e-6, seed=1, mode=False):
        """omega2 from above but for this chance, from below, and with mode the mode of the nodes, else None."""
        ids = 2 * numpy.arange(self.root.size)
        v = numpy.sqrt(-2 * numpy.log(1 - random(seed, ids))) * numpy.cos(2 * numpy.pi * random(seed, ids + 1))
        v = numpy.where(self.free, v.reshape(self.root.shape), 0)
        if not self.free.any():
            return 0.0, 0.0, None
        return lanczos(self.product, v, certain(numpy.count_nonzero(self.free), chance), products, mode)


def certain(unknowns, chance):
    """The logarithm of what a polynomial of Lanczos exceeds at the largest eigenvalue with this chance at most."""
    return numpy.log(numpy.sqrt(2 * unknowns / numpy.pi) / chance)


def lanczos(product, v, level, products, mode=False, accuracy=0.0):
    """The largest eigenvalue from above (level: certain()) and from below, and with mode its vector, else None.

    With an accuracy it ends when the residual of the largest Ritz value is below this part of it.
    """
    v = v / numpy.linalg.norm(v)
    before, alpha, beta, size, kept, residual = numpy.zeros_like(v), [], [], 0, [], numpy.inf
    while len(alpha) < products and (not beta or beta[-1] > NO_LENGTH * size) and residual > accuracy:
        kept += [v] if mode else []
        w = product(v) - (beta[-1] * before if beta else 0)
        alpha.append(float(numpy.vdot(w, v)))
        w -= alpha[-1] * v
        beta.append(float(numpy.linalg.norm(w)))
        size = max(size, alpha[-1] + 2 * beta[-1])
        before, v = v, w / (beta[-1] or 1)
        if accuracy and len(alpha) % 10 == 0:
            ritz, vectors = numpy.linalg.eigh(numpy.diag(alpha) + numpy.diag(beta[:-1], 1) + numpy.diag(beta[:-1], -1))
            residual = beta[-1] * abs(vectors[-1, -1]) / ritz[-1]
    if not size > 0:
        return 0.0, 0.0, None
    beta[-1] = max(beta[-1], NO_LENGTH * size)
    ritz, vectors = numpy.linalg.eigh(numpy.diag(alpha) + numpy.diag(beta[:-1], 1) + numpy.diag(beta[:-1], -1))
    found = sum(s * k for s, k in zip(vectors[:, -1], kept)) if mode else None
    most = max(largest_root(alpha, beta, level, size), float(ritz[-1]) * (1 + ROUNDING))
    return most, float(ritz[-1]), found


def largest_root(alpha, beta, level, size):
    """The largest t with log p_k(t) <= level; p_k(A) v_1 is the vector of Lanczos that follows k products."""
    low, high = 0.0, size * (2 + numpy.exp(level / len(alpha)))
    for _ in range(120):
        t, d, total = low + (high - low) / 2, 1.0, 0.0
        for j, (a, b) in enumerate(zip(alpha, beta)):
            d = t - a - (beta[j - 1] ** 2 / d if j else 0)
            if d <= 0:
                break
            total += numpy.log(d / b)
        low, high = (low, t) if d > 0 and total > level else (t, high)
    return high


def moduli(particles, dim, young, poisson, lame, mu):
    """lambda and mu of each particle."""
    if young is not None:
        young, nu = numpy.asarray(young, float), numpy.asarray(0 if poisson is None else poisson, float)
        lame, mu = young * nu / ((1 + nu) * (1 - 2 * nu)), young / (2 * (1 + nu))
    lame, mu = (numpy.broadcast_to(numpy.asarray(m, float), (particles,)) for m in (lame, mu))
    bad = numpy.flatnonzero(~((mu >= 0) & (dim * lame + 2 * mu >= 0) & (lame + 2 * mu < numpy.inf)))
    if bad.size:
        raise ValueError(f"particle {bad[0]} has lambda {lame[bad[0]]} and mu {mu[bad[0]]}, which no solid has")
    return lame, mu


def step(x, volume, mass, *, bound="lanczos", scheme="usl", factor=None, sweeps=0, products=20, chance=1e-6, seed=1,
         mode=False, **layout):
    """The largest stable step. layout: the other arguments of Layout; scheme: a key of FACTOR, or give its factor."""
    if scheme == "mls-mpm":
        layout.setdefault("gradient", "mls")
    at = Layout(x, volume, mass, **layout)
    lone = at.lone(walls=scheme != "mls-mpm") if bound == "lone" or scheme == "mls-mpm" else None
    least, particle, found = None, None, None
    if bound == "lone":
        omega2, particle = float(lone.max()), int(lone.argmax())
    elif bound == "particle":
        omega2, particle = at.particle(sweeps)
    elif bound == "lanczos":
        omega2, least, found = at.lanczos(products, chance, seed, mode)
        if found is not None:
            particle = int(at.product(found, energies=True).argmax())
            found = found * at.root
    else:
        raise ValueError(f"bound {bound!r}; it must be lone, particle or lanczos")
    with numpy.errstate(divide="ignore"):
        square = (2 / numpy.float64(omega2) + 2 / lone.max() if scheme == "mls-mpm"
                  else (FACTOR[scheme] if factor is None else factor) / numpy.float64(omega2))
    return Step(float(numpy.sqrt(square)), omega2, least, particle, bound, found)
