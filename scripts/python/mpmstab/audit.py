"""Whether the step of your own rule is stable for your particles: mpmstab-audit, or python3 -m mpmstab audit.

    mpmstab-audit particles.csv -scheme mls-mpm -basis quadratic -cell_width 0.01 -young 1e5 -poisson 0.3 -dt "0.4 * h / c"

The columns of the CSV are those of -layout of the program mpmstab: x[,y[,z]] and, where you have them, volume, mass, young,
poisson. vx, vy, vz give the speed v of a rule. Units are those of the columns: with SI units the steps are in seconds.
"""
import argparse
import ast
import csv
import json
import math
import operator
import sys
import time
from collections import namedtuple

import numpy

from . import dt, limits
from .drawing import picture_module

OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
             ast.Pow: operator.pow, ast.USub: operator.neg, ast.UAdd: operator.pos}
FUNCTIONS = {"sqrt": math.sqrt, "min": min, "max": max, "abs": abs}
RANGES = {"volume": (0, math.inf), "mass": (0, math.inf), "young": (0, math.inf), "poisson": (-1e-300, 0.5)}
AXES, SPEEDS = ("x", "y", "z"), ("vx", "vy", "vz")
PLACES = {1: 257, 2: 33, 3: 9}  # of a lone particle in a cell, a direction
BARELY = 1e-6                   # of a cell: as close to them as a lone particle is tried

Row = namedtuple("Row", "name dt evidence particle")
Audit = namedtuple("Audit", "words scheme transfer basis at x rows limit rule names step verdict reason own_steps mode lone_anywhere seconds")


class Refused(ValueError):
    """Bad input; the text names the option or the file, and what is allowed."""


# ---- what is given ----

def rule_value(text, names):
    """The value of a rule such as '0.4 * h / c'. Nothing but numbers, names, arithmetic and FUNCTIONS is taken."""
    def of(node):
        if isinstance(node, ast.Expression):
            return of(node.body)
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return float(node.value)
        if isinstance(node, ast.Name) and node.id in names:
            return names[node.id]
        if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
            return OPERATORS[type(node.op)](of(node.left), of(node.right))
        if isinstance(node, ast.UnaryOp) and type(node.op) in OPERATORS:
            return OPERATORS[type(node.op)](of(node.operand))
        if isinstance(node, ast.Call) and getattr(node.func, "id", None) in FUNCTIONS and not node.keywords:
            return FUNCTIONS[node.func.id](*(of(one) for one in node.args))
        raise Refused(f"dt {text!r}: {ast.unparse(node)!r} is not known; allowed: numbers, + - * / **, "
                      f"{', '.join(FUNCTIONS)}, and {', '.join(names)}")
    try:
        value = float(of(ast.parse(text.strip(), mode="eval")))
    except Refused:
        raise
    except (SyntaxError, ValueError, TypeError, ArithmeticError, MemoryError, RecursionError) as error:
        raise Refused(f"dt {text!r}: {error}; allowed: a number, or an expression such as 0.4 * h / c") from None
    if not 0 < value < math.inf:
        raise Refused(f"dt {text!r} is {value}; allowed: a positive number")
    return value


def header_of(path, line):
    names = [name.strip().lower() for name in line]
    names[0] = names[0].lstrip("#").strip() if names else ""
    used = [name for name in names if name in AXES or name in RANGES or name in SPEEDS]
    if len(used) != len(set(used)):
        raise Refused(f"layout {path}: line 1: a column twice; allowed: each column once")
    dim = sum(name in AXES for name in names)
    if not dim or any(axis not in names for axis in AXES[:dim]):
        raise Refused(f"layout {path}: line 1: the columns are {', '.join(names)}; allowed: a header with x, x,y or x,y,z")
    return names, used, dim


def read_layout(path):
    """The columns of a CSV file by name, its dimension, and the names that are passed over."""
    try:
        with open(path, encoding="utf-8", newline="") as file:
            lines = list(csv.reader(file))
    except OSError as error:
        raise Refused(f"layout {path}: {error.strerror.lower()}; allowed: a CSV file") from None
    except (UnicodeDecodeError, csv.Error):
        raise Refused(f"layout {path}: it is not text; allowed: a CSV file") from None
    while lines and not lines[-1]:
        lines.pop()
    if len(lines) < 2:
        raise Refused(f"layout {path}: no particle; allowed: a header such as x,y,volume and a line for each particle")
    names, used, dim = header_of(path, lines[0])
    at = [names.index(name) for name in used]
    values = numpy.empty((len(used), len(lines) - 1))
    for number, line in enumerate(lines[1:]):
        try:
            if len(line) != len(names):
                raise ValueError(f"{len(line)} numbers where the header has {len(names)} columns")
            values[:, number] = [float(line[i]) for i in at]
        except ValueError as error:
            raise Refused(f"layout {path}: line {number + 2}: {error}; allowed: a number for each column") from None
    for name, column in zip(used, values):
        low, high = RANGES.get(name, (-math.inf, math.inf))
        bad = numpy.flatnonzero(~((column > low) & (column <= high) & (column < math.inf)))
        if bad.size:
            raise Refused(f"layout {path}: line {bad[0] + 2}: {name} {column[bad[0]]}; allowed: "
                          + ("a number" if name not in RANGES else "from 0 to 0.5" if name == "poisson" else "a number above 0"))
    return dict(zip(used, values)), dim, [name for name in names if name not in used]


def per_direction(name, text, dim, kind):
    try:
        parts = [kind(part) for part in str(text).split(",")]
    except ValueError:
        parts = []
    if len(parts) not in (1, dim) or not all(0 < part < math.inf for part in parts):
        raise Refused(f"{name} {text}: allowed: a positive number, or one for each of {dim} directions")
    return numpy.array(parts * (dim if len(parts) == 1 else 1))


def column_of(columns, options, name, otherwise=None):
    """A column of the file, else the option of this name, else another value."""
    value = columns.get(name, getattr(options, name, None))
    value = otherwise if value is None else value
    if value is None:
        raise Refused(f"{name}: neither a column of the file nor an option; allowed: -{name} NUMBER, or a column {name}")
    low, high = RANGES.get(name, (0, math.inf))
    if numpy.isscalar(value) and not low < value <= high:
        raise Refused(f"{name} {value}: allowed: {'from 0 to 0.5' if name == 'poisson' else 'a number above 0'}")
    return value


def scheme_of(options):
    scheme, transfer, gradient = options.scheme, options.transfer, "basis"
    if scheme == "mls-mpm":
        scheme, transfer, gradient = "usl", "apic", "mls"
    if transfer != "flip" and scheme in ("verlet", "rk3", "kg3", "rk4", "kg5") and transfer != "pic":
        raise Refused(f"transfer {transfer} with scheme {scheme}: no bound is known; allowed: flip, pic")
    if transfer == "apic" and options.basis == "hats":
        raise Refused("basis hats with apic: allowed: quadratic, cubic")
    return scheme, transfer, gradient


# ---- what is found ----

def lone_anywhere(at, options, h, gradient):
    """omega^2 of a lone particle at its worst place: that with the largest stiffness over mass."""
    worst = int(numpy.argmax((at.lame + 2 * at.mu) * at.volume / at.mass))
    line = numpy.linspace(0, 1, PLACES[at.dim])  # weights vanish at faces or in the middle, and the worst place may be beside
    line = numpy.concatenate([line[:-1] + BARELY, line[1:] - BARELY])
    x = numpy.stack(numpy.meshgrid(*[line] * at.dim, indexing="ij"), -1).reshape(-1, at.dim) * h
    alone = dt.Layout(x, at.volume[worst], at.mass[worst], h=h, lame=at.lame[worst], mu=at.mu[worst], basis=options.basis,
                      gradient=gradient)
    return math.inf if options.basis == "hats" else float(alone.lone().max())


def judge(step, rows, limit):
    """The verdict on a step, and its reason."""
    if step is None:
        return None, ""
    proved, certified = max(row.dt for row in rows if row.evidence == "proved"), max(row.dt for row in rows)
    if step <= proved:
        return "stable", "proved for these particles at rest"
    if limit and step > limit[1]:
        return "unstable", f"{step / limit[1]:.4g} times the largest step that is stable for these particles"
    if step <= certified or limit and step <= limit[0]:
        return "stable", "certified for these particles at rest, but for the chance above"
    return "undecided", ("between what is certified and the limit" if limit else
                         "above what is certified; the limit is not known for this scheme and transfer")


def find(path, options):
    """The audit of a layout."""
    begin = time.monotonic()
    columns, dim, unused = read_layout(path)
    h = per_direction("cell_width", options.cell_width, dim, float)
    scheme, transfer, gradient = scheme_of(options)
    x = numpy.stack([columns[axis] for axis in AXES[:dim]], -1)
    where = {}
    if options.cells:
        cells = per_direction("cells", options.cells, dim, int)
        where = {"nodes": cells, "origin": 0, "periodic": True}
        bad = numpy.flatnonzero(((x < 0) | (x > cells * h)).any(axis=1))
        if bad.size:
            raise Refused(f"layout {path}: line {bad[0] + 2}: {x[bad[0]]} is outside of the domain; allowed: from 0 to {cells * h}")
    volume = column_of(columns, options, "volume", numpy.prod(cells * h) / len(x) if options.cells else None)
    mass = columns["mass"] if "mass" in columns else column_of({}, options, "density", 1.0 if options.cells else None) * volume
    young = column_of(columns, options, "young")
    poisson = column_of(columns, options, "poisson", 0.0) if dim > 1 else 0.0
    if numpy.max(poisson) >= 0.5:
        raise Refused("poisson 0.5 has no finite stiffness; allowed: below 0.5")
    layout = {"h": h, "young": young, "poisson": poisson, "basis": options.basis, **where}
    at = dt.Layout(x, volume, mass, gradient=gradient, **layout)
    smooth = (at if gradient == "mls" else dt.Layout(x, volume, mass, gradient="mls", **layout)) if transfer == "apic" else None
    words = [f"{len(x)} particles of {path}, {dim}-D; {'periodic' if options.cells else 'a grid without walls'}"]
    words += [f"not used: {', '.join(unused)}"] if unused else []
    return answer(at, smooth, x, columns, options, (scheme, transfer, gradient), words, begin)


def answer(at, smooth, x, columns, options, of, words, begin):
    scheme, transfer, gradient = of
    factor = dt.FACTOR[scheme]

    def step(omega2):
        return math.sqrt(factor / omega2) if omega2 > 0 else math.inf

    lone = at.lone()
    rows = [Row("lone", step(lone.max()), "proved", int(lone.argmax()))]
    split = at.split(numpy.ones(at.n))
    rows.append(Row("particle", step(split.max()), "proved", int(split.argmax())))
    if options.sweeps:
        omega2, deciding = at.particle(options.sweeps)
        rows.append(Row("swept", step(omega2), "proved", deciding))
    most, _, mode = at.lanczos(chance=options.chance, mode=True)
    energy = at.product(mode, energies=True) if mode is not None else numpy.zeros(at.n)
    rows.append(Row("lanczos", step(most), f"certified, but for a chance of {options.chance:g}", int(energy.argmax())))
    worst = lone_anywhere(at, options, at.h, gradient)
    anywhere = step(worst)
    if gradient == "mls":  # dt^2 <= 2 / omega2 + 2 / lone (docs/theory.md, section 4, 'Any layout')
        rows.append(Row("mls-mpm", math.sqrt(4 / lone.max()), "proved", int(lone.argmax())))
        rows.append(Row("mls-mpm*", math.sqrt(2 / most + 2 / lone.max()), rows[-2].evidence, int(energy.argmax())))
        anywhere = math.sqrt(4 / worst)
    found = limits.find(at, scheme, transfer, smooth, options.basis, options.products, options.chance)
    limit = found and (math.sqrt(found[0]), math.sqrt(found[1]))
    speed = numpy.sqrt(sum(columns[name] ** 2 for name in SPEEDS if name in columns)) if "vx" in columns else numpy.zeros(1)
    density = at.mass / at.volume
    names = {"h": float(at.h.min()), "c": float(numpy.sqrt((at.lame + 2 * at.mu) / density).max()), "v": float(speed.max()),
             "rho": float(density.min()), "young": float(numpy.max(columns.get("young", options.young))),
             "dim": at.dim, "pi": math.pi}
    mine = None if options.dt is None else rule_value(options.dt, names)
    verdict, reason = judge(mine, rows, limit)
    share = energy / energy.max() if energy.max() > 0 else energy
    return Audit(words, scheme, transfer, options.basis, at, x, rows, limit, options.dt, names, mine, verdict, reason, numpy.sqrt(factor / split),
                 (mode * at.root if mode is not None else None, share), anywhere, time.monotonic() - begin)


# ---- what is written ----

def text_of(audit):
    """What the terminal shows."""
    form = "  {:<10} {:<12} {}".format
    lines = [*audit.words, f"{audit.scheme}, {audit.basis} basis, {audit.transfer} transfer; at rest; largest steps:", ""]
    for row in audit.rows:
        lines.append(form(row.name, f"{row.dt:.6g}", f"{row.evidence}; particle {row.particle} at "
                          f"{', '.join(f'{a:.6g}' for a in audit.x[row.particle])} decides"))
    if audit.limit:
        lines.append(form("limit", f"{audit.limit[1]:.6g}", "beyond it disturbances grow"))
    lines.append(form("anywhere", f"{audit.lone_anywhere:.6g}", "for a particle that is alone later, at its worst place in a cell"
                      if audit.lone_anywhere else "a particle alone that comes to a node on hats allows no step"))
    lines += ["", f"recommended: {recommended(audit):.6g}, {why(audit)}"]
    if audit.step is not None:
        lines.append(f"your step:   {audit.step:.6g} = {audit.rule}")
        lines.append(f"verdict:     {audit.verdict}, {audit.reason}")
    return "\n".join([*lines, f"time: {audit.seconds:.3g} s"])


def recommended(audit):
    return min(max(row.dt for row in audit.rows), audit.lone_anywhere or math.inf)


def why(audit):
    if audit.lone_anywhere and recommended(audit) == audit.lone_anywhere:
        return "so that a particle that leaves the others is stable, too"
    return "certified for these particles" + ("" if audit.lone_anywhere else "; ask again when they have moved")


def numbers(audit):
    """The keys of the JSON file."""
    found = {"particles": audit.at.n, "dim": audit.at.dim, "scheme": audit.scheme, "transfer": audit.transfer,
             "basis": audit.basis, "bounds": {row.name: row.dt for row in audit.rows},
             "particle": {row.name: row.particle for row in audit.rows}, "lone_anywhere": audit.lone_anywhere,
             "recommended": recommended(audit)}
    if audit.limit:
        found |= {"limit": audit.limit[1], "limit_certified": audit.limit[0]}
    if audit.step is not None:
        found |= {"dt": audit.step, "verdict": audit.verdict, "reason": audit.reason}
    return found


def parser():
    made = argparse.ArgumentParser(prog="mpmstab-audit", formatter_class=argparse.RawDescriptionHelpFormatter,
                                   description=__doc__.split("\n\n", 1)[1], allow_abbrev=False)
    made.add_argument("layout", help="CSV file of particles")

    def option(name, **how):
        made.add_argument(f"-{name}", f"--{name}", **how)

    option("dt", help="your step, a number or a rule of h (cell width), c (largest speed of sound), v, rho, young, dim")
    option("scheme", choices=list(dt.FACTOR), default="usl", help="default: usl. mls-mpm is usl with apic and gradients of least squares")
    option("transfer", choices=["flip", "pic", "apic"], default="flip")
    option("basis", choices=list(dt.WIDTH), default="quadratic")
    option("cell_width", required=True, help="one, or one for each direction with commas")
    option("cells", help="the domain has so many cells from 0 on and is periodic; without it the grid has no walls")
    for name in ("volume", "density", "young", "poisson"):
        option(name, type=float, help="of all particles, where the file has no such column")
    option("sweeps", type=int, default=0, help="sweeps that improve the bound 'particle'")
    option("chance", type=float, default=1e-6, help="with which the certificate may be wrong")
    option("products", type=int, default=400, help="most products with the matrix for the limit")
    option("html", default="audit.html", help="the page; default: audit.html")
    option("json", help="file for the numbers")
    return made


def main(arguments=None):
    options = parser().parse_args(arguments)
    try:
        audit = find(options.layout, options)
        print(text_of(audit))
        write_whole = picture_module("whole_files").write_whole
        from .audit_page import page
        write_whole(options.html, page(audit).encode())
        if options.json:
            write_whole(options.json, json.dumps(numbers(audit), indent=1).encode())
    except (Refused, ValueError, OSError) as error:
        print(f"mpmstab-audit: {error}", file=sys.stderr)
        return 2
    print(f"page: {options.html}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
