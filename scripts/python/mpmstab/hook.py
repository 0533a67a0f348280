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
    of order 1 means (without it: the cell width for the place; other scales are found from a few steps).
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


def connected(pattern):
    """Which reach which through others (Warshall 1962)."""
    reach = pattern.copy()
    for k in range(len(reach)):
        reach |= numpy.outer(reach[:, k], reach[k])
    return reach


class Scales:
    """What a change of order 1 of each field is. include/mpmstab_scales.h says how it is found; names are those of its struct."""

    def __init__(self, value, given, place, cell, size, epsilon):
        self.n, self.place, self.cell, self.size, self.unsettled = len(value), place, cell, size, 0.0
        self.value, self.least = numpy.array(value, dtype=float), 100 * numpy.array(epsilon) * value
        self.given = numpy.array([number > 0 for number in given])
        self.scale = numpy.where(self.given, given, numpy.where(self.value > 0, self.value, 1e-12))
        if place is not None and not self.given[place]:
            self.given[place], self.scale[place] = True, cell
        self.known, self.at = self.given | (self.value > 0), numpy.zeros(self.n)
        self.couples, self.lost = numpy.zeros((2, self.n, self.n))
        self.set_of = numpy.eye(self.n, dtype=bool)
        self.places = numpy.arange(self.n) == (-1 if place is None else place)

    def connect(self):
        """The sets of fields that feel one another. Places are an anchor, and in no set."""
        others = ~self.places
        feels = connected((self.couples > 0) & others & others[:, None] | numpy.eye(self.n, dtype=bool))
        self.set_of = feels & feels.T

    def balance(self, members):
        for _ in range(100):
            for i in members:
                others = members[members != i]
                gets = self.couples[i, others] @ self.scale[others]
                gives = (self.couples[others, i] / self.scale[others]).sum()
                if not self.given[i] and gets > 0 and gives > 0:
                    self.scale[i] = (gets / gives) ** 0.5

    def factor(self, members, old, known):
        if self.given[members].any():
            return 1.0
        scale, apart = self.scale[members], known & ~numpy.isin(numpy.arange(self.n), members)
        inward = max((self.value[members] / scale).max(),
                     ((self.couples[numpy.ix_(members, apart)] * old[apart]).T / scale).max(initial=0))
        far = apart & ~self.places
        out = ((self.couples[numpy.ix_(far, members)] * scale).T / old[far]).max(initial=0)
        moves = 0 if self.place is None else (self.couples[self.place, members] * scale).max() / self.cell
        factor = min(max(inward, 1e-3 / moves), 1 / moves) if moves > 0 else inward or (1 / out if out else 0)
        mean, more = numpy.exp(numpy.log(scale).mean()), len(members) > 1
        if factor > 0 or known[members[0]] or mean >= (1e10 if more else 1):
            self.known[members] = True
            return factor or 1 / mean
        factor = 1e8 if self.size < 1e-3 else 1e3
        return factor if more else min(factor, 1 / mean)

    def find(self):
        """Finds scales from the couplings that are known. Returns whether any has changed."""
        old, known = self.scale.copy(), self.known.copy()
        self.connect()
        for f in range(self.n):
            members = numpy.flatnonzero(self.set_of[f])
            if members[0] == f and not self.places[f]:
                self.balance(members)
                factor = self.factor(members, old, known)
                self.scale[members] *= numpy.where(self.given[members], 1, factor)
        gets = numpy.where(numpy.eye(self.n, dtype=bool), 0, self.couples * self.scale).max(axis=1)
        limit = numpy.maximum(self.value, 1e3 * gets)
        self.scale = numpy.where(~self.given & self.known & (limit > 0), numpy.minimum(self.scale, limit), self.scale)
        return (self.known != known).any() or (abs(numpy.log(self.scale / old)) > 0.01).any()

    def far(self):
        with numpy.errstate(divide="ignore"):
            return abs(numpy.log2(self.scale / self.at))

    def search(self, measure):
        """measure(f, amount) gives the largest change of each field when numbers of field f change by up to amount."""
        for _ in range(61):
            while (self.far() > 1).any():
                f = int(numpy.argmax(self.far() > 1))
                self.at[f] = self.scale[f]
                change = yield from measure(f, self.size * self.at[f])
                lost, amount = (change < self.least) & (numpy.arange(self.n) != f), self.size * self.at[f]
                self.lost[:, f] = lost * numpy.maximum(change, self.least / 100) / amount
                self.couples[:, f] = numpy.where(change < self.least, self.couples[:, f], change / amount)
            if not self.find():
                self.unsettled = numpy.inf if (self.lost * self.couples.T > 1e-3).any() else self.far().max()
                self.scale = numpy.where(self.given, self.scale, 2.0 ** numpy.rint(numpy.log2(self.scale)))
                return
        self.unsettled = numpy.inf

    def fail(self):
        self.scale = numpy.where(self.given, self.scale, numpy.where(self.value > 0, self.value, 1))
        self.unsettled = numpy.inf


def numbers_of(values):
    return " ".join(f"{value:.17g}" for value in values)


class NotFinite(Exception):
    """The code's answer is no state."""


class Hook:
    """What is known of a loop: the state at the first call, what was asked, what came back."""

    def __init__(self, path, cell_width, state, place, periodic, scales):
        kinds = {of: numbers(array) for of, array in state.items()}
        sizes = {of: a.size // len(a) for of, a in kinds.items()}
        self.path, self.base, self.calls, self.width, self.where = path, gather(state), 0, cell_width, None
        self.fields = [f" {of} {size}{' place' if of == place else ''}" for of, size in sizes.items()]
        self.float = numpy.concatenate([numpy.full(sizes[of], a.dtype == numpy.float32) for of, a in kinds.items()])
        self.size = 2.0**-5 if self.float.any() else 2.0**-17
        self.names, self.field_of = list(kinds), numpy.repeat(range(len(kinds)), list(sizes.values()))
        self.declared = [of in scales for of in kinds]
        self.epsilon = numpy.where(self.float, 2.0**-23, 2.0**-52)
        self.scales = Scales([float(numpy.abs(a).max()) for a in kinds.values()], [scales.get(of, 0) for of in kinds],
                             self.names.index(place) if place and cell_width > 0 else None, cell_width, self.size,
                             [2.0**-23 if a.dtype == numpy.float32 else 2.0**-52 for a in kinds.values()])
        self.apart = numpy.zeros(self.base.shape[1], dtype=bool)
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
            self.asked = self.asking.send(gather(state) if self.calls else None)
        except StopIteration:
            self.asking, self.asked = None, self.base
        except NotFinite:
            print(f"probe: the state after a step has a number that is not finite; {self.path} is not written", file=sys.stderr)
            self.asking, self.asked = None, self.base
        if self.asked is not None:  # else the loop goes on from where it is
            scatter(state, self.asked)
        return self.asking is not None

    def ask(self, amount):
        """Asks for a step from base + amount scales. Gives the perturbation as the code's numbers round it, and the answer."""
        asked = self.base + amount * self.scale
        asked = numpy.where(self.float, asked.astype(numpy.float32).astype(float), asked)
        answer = yield from self.step(asked)
        return asked - self.base, answer

    def step(self, state):
        """Lets the loop do a step from a state, or from where it is (None)."""
        self.calls += 1
        answer = yield state
        if not numpy.isfinite(answer).all():
            raise NotFinite
        return answer

    def minus(self, one, other):
        """one - other; a particle that has crossed a period is where it would be without."""
        d, periodic = one - other, numpy.isfinite(self.period)
        period = numpy.where(periodic, self.period, 1)
        return d - numpy.where(periodic, period * numpy.round(d / period), 0)

    @property
    def scale(self):
        return self.scales.scale[self.field_of]

    def largest(self, d):
        """The largest number of a difference of states, over the scales, of numbers that are not set apart."""
        return float(numpy.max((numpy.abs(d) / self.scale)[:, ~self.apart]))

    def measure(self, f, amount):
        """How much each field changes when one is perturbed at random."""
        given = numpy.random.default_rng(2).uniform(-amount, amount, self.base.shape) * (self.field_of == f) / self.scale
        _, one = yield from self.ask(given)
        _, other = yield from self.ask(-given)
        change = numpy.abs(self.minus(one, other)).max(axis=0) / 2
        return numpy.array([change[self.field_of == g].max() for g in range(self.scales.n)])

    def steps(self):
        """Asks all that is to be asked, and writes the matrix."""
        still, single = numpy.zeros_like(self.base), self.float.any()
        rest = (yield from self.ask(still))[1]
        if not self.scales.given.all():
            try:
                yield from self.scales.search(self.measure)
            except NotFinite:
                self.scales.fail()
        given = numpy.random.default_rng(3).uniform(-self.size, self.size, self.base.shape)
        first = (yield from self.ask(given))[1]
        on = yield from self.step(None)
        if (on == first).all() and (first != self.base).any():
            raise RuntimeError(f"probe: no field moved in {self.calls} steps: is a copy registered?")
        again = (yield from self.ask(still))[1]
        anew = yield from self.step(first)
        two_steps = self.largest(self.minus(on, anew))
        if self.bins:
            yield from self.find_reach(rest, self.largest(self.minus(rest, again)))
        certificates, matrix, leaks = yield from self.columns(rest, self.bins)
        additivity = yield from self.check(matrix)
        if self.bins and (leaks > (1e-3 if single else 1e-6) or additivity > (0.05 if single else 1e-3)):
            certificates, matrix, leaks = yield from self.columns(rest, None)  # some particle reaches further than was seen
            additivity = yield from self.check(matrix)
        last = (yield from self.ask(given))[1]
        repeat = max(self.largest(self.minus(rest, again)), self.largest(self.minus(first, last)))
        self.write(matrix, {"moved": self.largest(self.minus(rest, self.base)), "repeat": repeat, "two_steps": two_steps, **certificates,
                            "additivity": additivity})

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
        entries, leaks = [], 0.0
        couples, kinks, sizes = numpy.zeros((3, width, width))
        own = numpy.zeros(width)
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
                b = self.minus(f[2], f[3])[due] / (d[2] - d[3])
                near, far = self.minus(f[0], rest)[due] / d[0] - a, self.minus(f[2], rest)[due] / d[2] - b
                rounding = 4 * self.epsilon * numpy.abs(self.base[due]) / self.scale / self.size  # of a difference quotient
                kinks[:, number] = numpy.maximum(kinks[:, number], (numpy.abs(2 * near - far) * unit - rounding).max(axis=0))
                sizes[:, number] += (((b - a) * unit) ** 2).sum(axis=0)
                entry, itself = numpy.abs(a) * unit, numpy.flatnonzero(due) == owner[due]
                own[number] = max(own[number], entry[itself, number].max(initial=0))
                entry[itself, number] = 0
                couples[:, number] = numpy.maximum(couples[:, number], entry.max(axis=0))
                row, of = numpy.nonzero(a)
                entries.append((numpy.flatnonzero(due)[row] * width + of, owner[due][row] * width + number, a[row, of]))
        matrix = [numpy.concatenate(part) for part in zip(*entries)]
        self.set_apart(couples, own)
        kept = numpy.ix_(~self.apart, ~self.apart)
        return {"one_sided": kinks[kept].max(), "two_sizes": sizes[kept].sum() ** 0.5}, matrix, leaks

    def set_apart(self, couples, own):
        """Numbers that do not reach themselves through others, and whose own eigenvalue does not grow; none, if all were."""
        noise = 1e-5 if self.float.any() else 1e-8
        self.apart = ~(connected(couples > noise).diagonal() | (own > 1 + noise))
        if self.apart.all():
            self.apart[:] = False

    def check(self, matrix):
        """The response to a random perturbation against the matrix times it, relative to the larger."""
        row, column, value = matrix
        random = numpy.random.default_rng(1).uniform(-self.size, self.size, self.base.shape) * ~self.apart
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
        found = "found" if self.scales.unsettled <= 1 else "guessed"
        known += [f"field_scale: {scale:.17g} {'declared' if said else 'cell_width' if given else found} {name}"
                  for scale, said, given, name in zip(self.scales.scale, self.declared, self.scales.given, self.names)]
        if not self.scales.given.all():
            known.append(f"unsettled: {self.scales.unsettled:.3g}")
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
