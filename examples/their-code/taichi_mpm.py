#!/usr/bin/python3
"""Taichi's own examples for 'mpmstab -program': taichi_mpm.py FILE [f64] [MATERIAL] [WHAT].

FILE: mpm88, mpm99 or mpm3d of taichi/examples/simulation, as pip has installed it. f64: in double precision; they are
written for single precision. MATERIAL, of mpm99: liquid, jelly or snow. mpmstab chooses the particles, and they are put in the
middle of the grid, at rest. WHAT is another state: demo is the scene that the file begins with, and demo N has N of its particles.
smooth: Taichi's svd keeps shears below 1e-5, which it drops otherwise.

The file is run as it is, without its window, but for this: dt is a number that a kernel reads, so that a new one needs no
compilation; and without demo nothing has weight, because a block that falls is not in equilibrium.
"""
import ast
import contextlib
import importlib.util
import inspect
import linecache
import pathlib
import sys

import numpy

from mpmstab.adapter import serve

with contextlib.redirect_stdout(sys.stderr):  # Taichi prints what it is; standard output is for answers
    import taichi as ti

    ti.init(arch=ti.cpu, default_fp=ti.f64 if "f64" in sys.argv else ti.f32, cpu_max_num_threads=1)
FILE = pathlib.Path(importlib.util.find_spec("taichi").origin).parent / "examples/simulation" / f"{sys.argv[1]}.py"
DEMO, MATERIALS = "demo" in sys.argv, ("liquid", "jelly", "snow")
LOADED = {}


class Changes(ast.NodeTransformer):
    """What is changed in their functions."""

    def visit_Name(self, node):
        return ast.parse("dt[None]", mode="eval").body if node.id == "dt" else node

    def visit_AugAssign(self, node):
        weight = isinstance(node.op, ast.Sub) and "dt *" in ast.unparse(node.value)  # velocity -= dt * gravity
        return ast.Pass() if weight and not DEMO else self.generic_visit(node)


def keep_shears():
    """Takes the switch out of Taichi's svd of 2 x 2 matrices, which is compiled from the text of its function."""
    functions = sys.modules["taichi._funcs"]
    text, switch = inspect.getsource(functions._svd2d), "abs(S[0, 1]) < 1e-5"
    if text.count(switch) != 1:
        sys.exit(f"smooth: svd of this Taichi has no '{switch}'; allowed: Taichi 1.7.4")
    text = text.replace(switch, "S[0, 1] == 0")
    linecache.cache["smooth svd"] = (len(text), None, text.splitlines(True), "smooth svd")
    exec(compile(text, "smooth svd", "exec"), vars(functions))


def load(**constants):
    """What the file defines before it opens a window, with these values of its constants."""
    body = [node for node in ast.parse(FILE.read_text(encoding="utf-8")).body if not isinstance(node, ast.Expr)]
    window = next((i for i, node in enumerate(body) if isinstance(node, ast.Assign) and "GUI" in ast.dump(node)), None)
    body = [Changes().visit(node) if isinstance(node, ast.FunctionDef) else node for node in body[:window]]
    text = ast.unparse(ast.fix_missing_locations(ast.Module(body, [])))
    linecache.cache[str(FILE)] = (len(text), None, text.splitlines(True), str(FILE))  # kernels are compiled from there
    theirs = {"__name__": FILE.stem}
    for node in ast.parse(text).body:
        exec(compile(ast.Module([node], []), str(FILE), "exec"), theirs)
        theirs.update({name: value for name, value in constants.items() if name in theirs})
    fields = {name: theirs.get(name, theirs.get(f"F_{name}")) for name in ("x", "v", "C", "F", "J", "Jp")}
    theirs["fields"] = {name: field for name, field in fields.items() if field is not None}
    theirs["given"], theirs["dt"] = theirs["dt"], ti.field(float, ())
    for name in set(MATERIALS).intersection(sys.argv):
        theirs["material"].fill(MATERIALS.index(name))
    return theirs


def step(state, dt, **constants):
    """A step of theirs. Other constants or another number of particles need fields of their own."""
    key = (len(state["x"]), *constants.values())
    if key not in LOADED:
        LOADED[key] = load(n_particles=key[0], **constants)
    theirs = LOADED[key]
    for name, field in theirs["fields"].items():
        field.from_numpy(state[name])
    theirs["dt"][None] = dt
    theirs["substep"]()
    return {name: field.to_numpy() for name, field in theirs["fields"].items()}


if "smooth" in sys.argv:
    keep_shears()
first = load(**{"n_particles": int(word) for word in sys.argv if word.isdigit()})
h, c = first["dx"], first["E"] ** 0.5
if DEMO:
    first.get("init", first.get("initialize"))()
state = {name: field.to_numpy() for name, field in first["fields"].items()}


def arrange(grid, place, *_):
    """Particles at rest at these places, by so many whole cells on that they are in the middle. All of theirs have one volume and mass."""
    dim, kind = place.shape[1], state["x"].dtype
    rest = {"x": place + h * (first["n_grid"] // 2 - (place.max(0) / h / 2).astype(int)), "F": numpy.eye(dim), "J": 1, "Jp": 1}
    return {name: (numpy.zeros((len(place), *a.shape[1:])) + rest.get(name, 0)).astype(kind) for name, a in state.items()}


says = {"x": {"place": True}, "v": {"scale": c}, "C": {"scale": c / h}, "F": {"scale": 1}, "J": {"scale": 1}, "Jp": {"scale": 1}}
parameters = {"dt": first["given"], **{name: first[name] for name in ("E", "gravity") if name in first}}
serve(step, state, cell_width=h, periodic=[None] * state["x"].shape[1], fields={name: says[name] for name in state}, parameters=parameters,
      name=" ".join(sys.argv[1:]), scenes=None if DEMO else arrange, any_count=DEMO)
