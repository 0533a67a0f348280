"""The hook: one call in a time loop perturbs its state, reads the answers and writes the matrix of its step."""
import itertools
import sys

import numpy


def numbers(array):
    """The values of an array of any library, as they are."""
    for call in ("to_numpy", "detach", "numpy"):
        if hasattr(array, call):
            array = getattr(array, call)()
            array = array.cpu().numpy() if call == "detach" else array
            break
    return numpy.asarray(array)


def put(array, values):
    """Gives an array of any library new values."""
    values = numpy.ascontiguousarray(values, dtype=numbers(array).dtype)
    if hasattr(array, "from_numpy"):
        array.from_numpy(values)
    elif hasattr(array, "assign"):
        array.assign(values)
    elif hasattr(array, "new_tensor"):
        array.data.copy_(array.new_tensor(values))
    else:
        array[...] = values


def gather(state):
    """All values as doubles: particles x numbers."""
    values = [numbers(array) for array in state.values()]
    return numpy.hstack([v.reshape(len(v), -1).astype(float) for v in values])


def scatter(state, values):
    """Puts what gather gives back into the arrays."""
    first = 0
    for array in state.values():
        shape = numbers(array).shape
        size = int(numpy.prod(shape[1:]))
        put(array, values[:, first : first + size].reshape(shape))
        first += size


HOOKS = {}


def probe(path, cell_width, state, *, place="x", periodic=None, scale=None):
    """One call in your own time loop: while probe("A.mtx", h, {"x": x, "v": v}): step().

    Each call keeps the answer to the last perturbation, restores the state and perturbs other unknowns. The last one writes
    the matrix to path (Matrix Market), restores the state to the last bit and returns False, as do all later ones. All
    that a step changes and a later step reads has to be in the state; arrays and particles have to stay the same ones.

    place: the name of the place, or None. periodic: a period or None for each direction. scale: {"v": 20}, what a change
    of order 1 means (without it: the cell width for the place, else the largest absolute value, else 1).
    mpmstab reads the matrix, and where all cells are alike also its blocks: 'symbol -matrix_blocks A.mtx' looks at all waves.
    To probe again, give another path. include/mpmstab_probe.h says what the comments in the file mean.
    """
    if path not in HOOKS:
        HOOKS[path] = Hook(path, cell_width, state, place, periodic, scale or {})
    return HOOKS[path].call(state)


class Bins:
    """Particles in bins as wide as cells. A particle reaches 'reach' bins; None: it is not known, and all are apart."""

    def __init__(self, x, width, periods):
        low, extent = x.min(axis=0), numpy.ptp(x, axis=0)
        self.periodic = numpy.isfinite(periods)
        self.n = numpy.where(self.periodic, numpy.ceil(numpy.where(self.periodic, periods, 0) / width - 1e-6),
                             numpy.floor(extent / width) + 1).astype(int)
        inside = numpy.where(self.periodic, numpy.mod(x, periods), x - low)
        self.at = numpy.minimum((inside / width).astype(int), self.n - 1)
        self.middle = int(numpy.argmin(numpy.abs(x - low - extent / 2).sum(axis=1)))
        self.reach = 0

    def apart(self, i):
        """The largest distance of all particles from one, in bins."""
        d = numpy.abs(self.at - self.at[i])
        return numpy.where(self.periodic, numpy.minimum(d, self.n - d), d).max(axis=1)

    def colours(self):
        """A colour for each particle: those of one colour share no bin that they reach."""
        colour, apart = numpy.zeros(len(self.at), dtype=int), 2 * self.reach + 1
        for a, n in enumerate(self.n):
            best = min(range(apart, n + 1), key=lambda m, n=n: m + n % m, default=n) if self.periodic[a] else min(apart, n)
            whole = n // best * best if self.periodic[a] else n
            lines = best + n % best if self.periodic[a] else best
            b = self.at[:, a]
            colour = colour * lines + numpy.where(b < whole, b % best, best + b - whole)
        bin_of = numpy.ravel_multi_index(tuple(self.at.T), self.n)
        order = numpy.argsort(bin_of, kind="stable")
        first = numpy.searchsorted(bin_of[order], bin_of[order])
        rank = numpy.empty_like(order)
        rank[order] = numpy.arange(len(order)) - first
        return numpy.unique(colour * (rank.max() + 1) + rank, return_inverse=True)[1]

    def owners(self, perturbed):
        """The perturbed particle that each particle's answer is due to, or -1."""
        mark, around = numpy.full(self.n, -1), range(-self.reach, self.reach + 1)
        for step in itertools.product(around, repeat=len(self.n)):
            at = numpy.where(self.periodic, numpy.mod(self.at[perturbed] + step, self.n), self.at[perturbed] + step)
            inside = numpy.all((at >= 0) & (at < self.n), axis=1)
            mark[tuple(at[inside].T)] = perturbed[inside]
        return mark[tuple(self.at.T)]


def numbers_of(values):
    return " ".join(f"{value:.17g}" for value in values)


class NotFinite(Exception):
    """The code's answer is no state."""


class Hook:
    """What is known of a loop: the state at the first call, what was asked, what came back."""

    def __init__(self, path, cell_width, state, place, periodic, scales):
        kinds = {of: numbers(array) for of, array in state.items()}
        sizes = {of: a.size // len(a) for of, a in kinds.items()}
        largest = {of: float(numpy.abs(a).max()) or 1.0 for of, a in kinds.items()}
        if place and cell_width > 0:
            largest[place] = cell_width
        self.path, self.base, self.calls, self.width, self.where = path, gather(state), 0, cell_width, None
        self.fields = [f" {of} {size}{' place' if of == place else ''}" for of, size in sizes.items()]
        self.float = numpy.concatenate([numpy.full(sizes[of], a.dtype == numpy.float32) for of, a in kinds.items()])
        self.size = 2.0**-5 if self.float.any() else 2.0**-17
        self.scale = numpy.concatenate([numpy.full(sizes[of], scales.get(of, largest[of]), dtype=float) for of in kinds])
        self.period, self.bins = numpy.full(self.base.shape[1], numpy.inf), None
        if place:
            first = sum(sizes[of] for of in itertools.takewhile(lambda of: of != place, kinds))
            self.where = where = slice(first, first + sizes[place])
            self.period[where] = [p or numpy.inf for p in periodic or [None] * sizes[place]]
            self.bins = Bins(self.base[:, where], cell_width, self.period[where]) if cell_width > 0 else None
        self.asking = self.steps()
        self.asked = None

    def call(self, state):
        """Takes the state after a step, and perturbs it anew. False: there is nothing more to ask."""
        if self.asking is None:
            return False
        try:
            self.asked = self.asking.send(None if self.asked is None else gather(state))
        except StopIteration:
            self.asking, self.asked = None, self.base
        except NotFinite:
            print(f"probe: the state after a step has a number that is not finite; {self.path} is not written", file=sys.stderr)
            self.asking, self.asked = None, self.base
        scatter(state, self.asked)
        return self.asking is not None

    def ask(self, amount):
        """Asks for a step from base + amount scales. Gives the perturbation as the code's numbers round it, and the answer."""
        asked = self.base + amount * self.scale
        asked = numpy.where(self.float, asked.astype(numpy.float32).astype(float), asked)
        self.calls += 1
        answer = yield asked
        if not numpy.isfinite(answer).all():
            raise NotFinite
        return asked - self.base, answer

    def minus(self, one, other):
        """one - other; a particle that has crossed a period is where it would be without."""
        d, periodic = one - other, numpy.isfinite(self.period)
        period = numpy.where(periodic, self.period, 1)
        return d - numpy.where(periodic, period * numpy.round(d / period), 0)

    def largest(self, d):
        """The largest number of a difference of states, over the scales."""
        return float(numpy.max(numpy.abs(d) / self.scale))

    def steps(self):
        """Asks all that is to be asked, and writes the matrix."""
        still, single = numpy.zeros_like(self.base), self.float.any()
        rest = (yield from self.ask(still))[1]
        again = (yield from self.ask(still))[1]
        repeat = self.largest(self.minus(rest, again))
        if self.bins:
            yield from self.find_reach(rest, repeat)
        certificates, matrix, leaks = yield from self.columns(rest, self.bins)
        additivity = yield from self.check(matrix)
        if self.bins and (leaks > (1e-3 if single else 1e-6) or additivity > (0.05 if single else 1e-3)):
            certificates, matrix, leaks = yield from self.columns(rest, None)  # some particle reaches further than was seen
            additivity = yield from self.check(matrix)
        moved = self.largest(self.minus(rest, self.base))
        self.write(matrix, {"moved": moved, "repeat": repeat, **certificates, "additivity": additivity})

    def find_reach(self, rest, repeat):
        """Perturbs the particle in the middle, number by number, and looks how far the answers come from."""
        for number in range(self.base.shape[1]):
            amount = numpy.zeros_like(self.base)
            amount[self.bins.middle, number] = self.size
            _, answer = yield from self.ask(amount)
            touched = (numpy.abs(self.minus(answer, rest)) / self.scale > 10 * repeat).any(axis=1)
            self.bins.reach = max(self.bins.reach, self.bins.apart(self.bins.middle)[touched].max(initial=0))
        self.bins.reach += 1  # particles elsewhere in a cell may reach one further

    def columns(self, rest, bins):
        """All columns, as rows, columns and values. Without bins each has steps of its own."""
        n, width = self.base.shape
        colour = bins.colours() if bins else numpy.arange(n)
        entries, one_sided, two_sizes, leaks = [], 0.0, 0.0, 0.0
        for c in range(colour.max() + 1):
            perturbed = numpy.flatnonzero(colour == c)
            owner = bins.owners(perturbed) if bins else numpy.full(n, c)
            due = owner >= 0
            for number in range(width):
                d, f = [], []
                for sign in (1, -1, 2, -2):
                    amount = numpy.zeros_like(self.base)
                    amount[perturbed, number] = sign * self.size
                    moved, answer = yield from self.ask(amount)
                    d.append(moved[owner[due], number][:, None])
                    f.append(answer)
                both, unit = self.minus(f[0], f[1]), self.scale[number] / self.scale
                leaks = max(leaks, numpy.max(numpy.abs(both[~due]) / self.scale, initial=0) / (2 * self.size))
                a = both[due] / (d[0] - d[1])
                ahead = self.minus(f[0], rest)[due] / d[0]
                larger = self.minus(f[2], f[3])[due] / (d[2] - d[3])
                one_sided = max(one_sided, numpy.max(numpy.abs(ahead - a) * unit))
                two_sizes += numpy.sum(((larger - a) * unit) ** 2)
                row, of = numpy.nonzero(a)
                entries.append((numpy.flatnonzero(due)[row] * width + of, owner[due][row] * width + number, a[row, of]))
        matrix = [numpy.concatenate(part) for part in zip(*entries)]
        return {"one_sided": one_sided, "two_sizes": two_sizes**0.5}, matrix, leaks

    def check(self, matrix):
        """The response to a random perturbation against the matrix times it, relative to the larger."""
        row, column, value = matrix
        random = numpy.random.default_rng(1).uniform(-self.size, self.size, self.base.shape)
        ahead, one = yield from self.ask(random)
        behind, other = yield from self.ask(-random)
        expected = numpy.bincount(row, value * (ahead - behind).ravel()[column], self.base.size).reshape(self.base.shape)
        response = self.minus(one, other)
        return self.largest(response - expected) / (max(self.largest(response), self.largest(expected)) or 1.0)

    def write(self, matrix, certificates):
        """Matrix Market; unknowns particle by particle, fields in the order of the state."""
        says = [f"{name}: {value:.3g}" for name, value in certificates.items()]
        known = [f"size: {self.size:.3g}", f"single: {int(self.float.any())}", f"numbers: {self.base.shape[1]}",
                 *(f"scale: {scale:.17g}" for scale in self.scale)]
        if self.bins:
            periods = numpy.where(self.bins.periodic, self.period[self.where], 0)
            known += [f"cell_width: {self.width:.17g}", f"period: {numbers_of(periods)}",
                      *(f"at: {numbers_of(x)}" for x in self.base[:, self.where])]
        with open(self.path, "w", encoding="ascii") as file:
            file.write(f"%%MatrixMarket matrix coordinate real general\n% steps: 1\n% fields:{''.join(self.fields)}\n")
            file.writelines(f"% {line}\n" for line in [f"calls: {self.calls}", *says, *known])
            file.write(f"{self.base.size} {self.base.size} {len(matrix[0])}\n")
            file.writelines(f"{i + 1} {j + 1} {value:.17g}\n" for i, j, value in zip(*matrix))
        print(f"probe: {self.path} has the matrix of your step, of order {self.base.size}, from {self.calls} steps: "
              f"{', '.join(says)}", file=sys.stderr)
