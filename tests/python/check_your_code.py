#!/usr/bin/python3
"""Checks examples/your-code: the hook and the adapters of every language give the operator of our own table.

check_your_code.py CC MPMSTAB, in a folder that may be filled. What it prints is what the hook says, and which
languages are not there.
"""
import ctypes
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

import numpy
import scipy.io

import checks
from checks import check, forks

ROOT = pathlib.Path(checks.ROOT)
CC, MPMSTAB = sys.argv[1:]
CODE, INCLUDE = ROOT / "examples/your-code", f"-I{ROOT / 'include'}"
PARTICLES, FIELDS = 32, 3
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT / "scripts/python"), "PYTHONDONTWRITEBYTECODE": "1"}
sys.path.insert(0, str(ROOT / "scripts/python"))
sys.dont_write_bytecode = True


def run(*words):
    """Runs a command, and returns what it prints."""
    done = forks.run([str(word) for word in words], capture_output=True, text=True, check=False, env=ENVIRONMENT)
    check(done.returncode == 0, f"{' '.join(map(str, words))}: {done.stderr[-1000:]}")
    return done.stdout


def own():
    """The operator of the table that the bar of the example is: for each particle v and s."""
    run(MPMSTAB, "spectrum", "-formulation", "usl", "-cells", 16, "-courant", 0.5, "-write_matrix", "own.mtx")
    return scipy.io.mmread("own.mtx").toarray()


def near(found, expected, tolerance, what):
    check(found.shape == expected.shape, f"{what}: {found.shape}, expected {expected.shape}")
    apart = numpy.max(numpy.abs(found - expected))
    check(apart <= tolerance, f"{what}: apart by {apart:.2g}, allowed {tolerance:.2g}")


def certificates(path="A.mtx"):
    """The numbers in the comments of a file."""
    with open(path, encoding="ascii") as file:
        words = [line[1:].split(":") for line in file if line.startswith("% ") and ":" in line]
    return {name.strip(): float(value) for name, value in words if name.strip() not in ("fields", "period", "at", "field_scale")}


def blocks_of(*words):
    """The blocks that 'symbol' writes, by the distance in cells."""
    run(MPMSTAB, "symbol", *words, "-write_blocks", "blocks.npz", "-json", "out.json")
    with numpy.load("blocks.npz") as file:
        return {int(d): A for d, A in zip(file["d"].ravel(), file["A"])}


def check_blocks_of_hook(language):
    """All cells are alike in the hook's matrix, and its blocks are those of the table."""
    expected = blocks_of("-formulation", "usl", "-cells", 16, "-courant", 0.5)
    blocks = blocks_of("-matrix_blocks", "A.mtx")
    check(set(blocks) == set(expected), f"{language}: blocks {sorted(blocks)}, expected {sorted(expected)}")
    rest = [1, 2, 4, 5]  # of x, v, stress at two sites
    for d, block in blocks.items():
        near(block[numpy.ix_(rest, rest)], expected[d], 1e-9, f"{language}: block {d}")
    found = checks.loaded("out.json")
    sought = {"scales"} if language == "Octave" else set()  # it has no way to declare them
    check(set(found["certificates"]) == {"repeat", "two steps", "two sizes", "additivity", "one side", "equilibrium"} | sought and all(one["holds"] for one in found["certificates"].values()), f"{language}: {found['certificates']}")
    check(found["lattice"]["blocks"] == 3 and found["lattice"]["unknowns"] == 6, f"{language}: {found['lattice']}")


def check_hook(language, *command):
    """The matrix that the hook writes for the bar at rest; a run with the hook is one without, to the last bit."""
    run(*command)
    found = scipy.io.mmread("A.mtx").toarray()
    places = numpy.arange(0, FIELDS * PARTICLES, FIELDS)
    rest = numpy.setdiff1d(numpy.arange(FIELDS * PARTICLES), places)
    near(found[numpy.ix_(rest, rest)], OWN, 1e-9, f"{language}: matrix")
    near(found[:, places], numpy.eye(FIELDS * PARTICLES)[:, places], 1e-9, f"{language}: columns of places at rest")
    check_blocks_of_hook(language)
    says = certificates()
    sought = 14 if language == "Octave" else 0  # steps to find scales
    check(says["calls"] == 1 + sought + 4 + 3 + 12 * 3 * 4 + 2 + 1, f"{language}: {says['calls']} calls, expected 12 colours of 3 numbers")
    check(says["moved"] == 0 and says["repeat"] == says["two_steps"] == 0 and says["additivity"] < 1e-8, f"{language}: {says}")
    with_hook, without = run(*command, 0.1), run(*command, 0.1, "no")
    check(with_hook == without and len(set(without.split())) > PARTICLES, f"{language}: the run is not what it is without")
    check(certificates()["moved"] > 1e-3, f"{language}: a bar that moves has moved by {certificates()['moved']}")
    run(MPMSTAB, "spectrum", "-matrix", "A.mtx", "-json", "out.json", "-expect", "undecided")
    check("the base state moves" in checks.loaded("out.json")["evidence"], f"{language}: {checks.loaded('out.json')['evidence']}")


def shared(name, compiler, *sources, flags=()):
    run(compiler, "-O2", "-fPIC", "-shared", INCLUDE, *flags, "-o", name, *sources, "-lm")


MODULES = ["bar.o", "mpmstab_hook.o", "mpmstab_probe.o", "-lm"]  # of Fortran, which languages() compiles


def check_fortran_refuses():
    """A part of structures as a whole, of which compilers give a copy or a wrong address, what is no target, and copies."""
    text = checks.text_of(CODE / "hook_structures.f90")
    build = ["gfortran", "-o", "wrong", "wrong.f90", *MODULES]
    for says, *changes in (("stress: it is a part of structures; needed: p(1)%stress", ("p(1)%stress, p(2)%stress, particles", "p%stress")),
                           ("x: the second particle does not come after the first", ("p(1)%x, p(2)%x", "p(2)%x, p(1)%x")),
                           ("no field moved in 5 steps: is a copy registered?", ("p(particles)", "p(particles), q(particles)"),
                            ("integer :: k", "integer :: k\n    associate (p => q)"),
                            ("    end do\n  end subroutine", "    end do\n    end associate\n  end subroutine")),
                           ("is it a copy that has gone?", ("[v(i)], stress(i)", "[v(i)], transfer(-1_8, 1d0)"))):
        pathlib.Path("wrong.f90").write_text(replaced(text, changes), encoding="ascii")
        run(*build)
        pathlib.Path("A.mtx").unlink(missing_ok=True)
        done = subprocess.run(["./wrong"], capture_output=True, text=True, check=False)
        check(done.returncode == 2 and says in done.stderr and not os.path.exists("A.mtx"), f"{says}: {done.returncode}, {done.stderr}")
    pathlib.Path("wrong.f90").write_text(replaced(text, [("target :: p", ":: p")]), encoding="ascii")
    done = subprocess.run([str(word) for word in build], capture_output=True, text=True, check=False)
    check(done.returncode != 0 and "mpmstab_field" in done.stderr, f"what is no target is taken: {done.stderr}")


def replaced(text, changes):
    """A text with other words; each of them must be there."""
    for old, new in changes:
        check(old in text, f"there is no {old}")
        text = text.replace(old, new, 1)
    return text


def languages():
    """The command of the hook for each language that is there."""
    run(CC, "-std=c11", "-Wall", "-Wextra", "-Werror", "-O2", INCLUDE, "-o", "hook_c", CODE / "hook.c", "-lm")
    found = {"C": ["./hook_c"], "Python": [sys.executable, CODE / "hook.py"]}
    if shutil.which("c++"):
        run("c++", "-x", "c++", "-std=c++11", "-Wall", "-Wextra", "-Werror", INCLUDE, "-o", "hook_cpp", CODE / "hook.c", "-lm")
        found["C++"] = ["./hook_cpp"]
    if shutil.which("octave-cli"):
        found["Octave"] = ["octave-cli", "-q", "--path", CODE, CODE / "hook.m"]
    if shutil.which("gfortran"):
        run(CC, "-x", "c", "-DMPMSTAB_PROBE_API=", "-c", ROOT / "include/mpmstab_probe.h", "-o", "mpmstab_probe.o")
        run("gfortran", "-Wall", "-Werror", "-c", CODE / "bar.f90", CODE / "mpmstab_hook.f90")
        run("gfortran", "-Wall", "-Werror", "-o", "hook_f", CODE / "hook.f90", *MODULES)
        found["Fortran"] = ["./hook_f"]
        run("gfortran", "-Wall", "-Werror", "-o", "hook_s", CODE / "hook_structures.f90", *MODULES)
        found["Fortran, structures"] = ["./hook_s"]
        check_fortran_refuses()
    missing = {"C++", "Octave", "Fortran"} - set(found)
    if missing:
        print(f"not installed, and so not checked: {', '.join(sorted(missing))}")
    return found


# ---- adapters: a step that is asked from outside ----


class Program:
    """A child that speaks the protocol of programs."""

    def __init__(self, *words):
        self.option = ["-program", " ".join(str(w) for w in words)]
        self.child = subprocess.Popen([str(w) for w in words], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=ENVIRONMENT)
        self.description = self.ask({"do": "describe"})
        self.base = self.take()

    def ask(self, message, state=b""):
        self.child.stdin.write(json.dumps(message).encode() + b"\n" + state)
        self.child.stdin.flush()
        return json.loads(self.child.stdout.readline())

    def take(self):
        return numpy.frombuffer(self.child.stdout.read(8 * FIELDS * PARTICLES))

    def set(self, name, value):
        return "error" not in self.ask({"do": "set", name: value})

    def step(self, state, steps=1):
        answer = self.ask({"do": "step", "steps": steps}, state.tobytes())
        check(answer == {}, f"{self.child.args}: a step is answered by {answer}")
        return self.take()

    def end(self):
        self.child.stdin.write(b'{"do":"quit"}\n')
        self.child.stdin.close()
        check(self.child.wait(30) == 0 and self.child.stdout.read() == b"", f"{self.child.args}: does not end as it is told")


class Plugin:
    """A shared library with the functions of mpmstab/plugin.h."""

    def __init__(self, path):
        self.option = ["-plugin", path]
        self.library, self.state = ctypes.CDLL(path), ctypes.POINTER(ctypes.c_double)()
        self.library.mpmstab_describe.restype = ctypes.c_char_p
        self.description = json.loads(self.library.mpmstab_describe(ctypes.byref(self.state)))
        self.base = numpy.array(self.state[: FIELDS * PARTICLES])

    def set(self, name, value):
        return self.library.mpmstab_set(name.encode(), ctypes.c_double(value)) == 0

    def step(self, state, steps=1):
        after = state.copy()
        at = after.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        check(self.library.mpmstab_step(steps, ctypes.c_int64(PARTICLES), at) == 0, "a step of a plugin fails")
        check(self.library.mpmstab_step(steps, ctypes.c_int64(PARTICLES + 1), at) != 0, "a plugin takes a particle more")
        return after

    def end(self):
        pass


def adapters():
    """The adapters of each language that is there."""
    shared("./libbar_c.so", CC, CODE / "plugin.c", flags=["-std=c11", "-Wall", "-Wextra", "-Werror"])
    if shutil.which("c++"):
        shared("./libbar_cpp.so", "c++", CODE / "plugin.cpp", flags=["-std=c++11", "-Wall", "-Wextra", "-Werror"])
        yield "C++", Plugin("./libbar_cpp.so")
    yield "C", Plugin("./libbar_c.so")
    if shutil.which("gfortran"):
        shared("./libbar_f.so", "gfortran", CODE / "bar.f90", CODE / "plugin.f90", flags=["-Wall", "-Werror"])
        yield "Fortran", Plugin("./libbar_f.so")
    yield "Python", Program(sys.executable, CODE / "serve.py")
    if shutil.which("octave-cli"):
        yield "Octave", Program("octave-cli", "-q", "--path", CODE, CODE / "serve.m")


def check_adapter(language, code):
    """Columns of the step, which is linear in v and stress; a parameter is set; two steps are two times one."""
    names = [(f["name"], f["size"], f.get("place", False)) for f in code.description["fields"]]
    check(names == [("x", 1, True), ("v", 1, False), ("stress", 1, False)], f"{language}: fields {names}")
    check([code.description[k] for k in ("protocol", "dim", "particles", "steps", "periodic", "cell_width", "parameters")] ==
          [1, 1, PARTICLES, 1, [1.0], 1 / 16, {"dt": 1 / 32}], f"{language}: {code.description}")
    rest = [i for i in range(FIELDS * PARTICLES) if i % FIELDS]
    unit = numpy.eye(FIELDS * PARTICLES)
    small = 2.0**-20  # no particle crosses a node
    found = numpy.array([(code.step(code.base + small * unit[j]) - code.base)[rest] / small for j in rest]).T
    near(found, OWN, 1e-9, f"{language}: matrix of the adapter")
    state = code.base + 0.01 * numpy.sin(numpy.arange(FIELDS * PARTICLES))
    near(code.step(state, 2), code.step(code.step(state)), 0, f"{language}: two steps")
    check(code.set("dt", 0.0), f"{language}: dt is not taken")
    near(code.step(state), state, 0, f"{language}: a step with dt = 0")
    code.end()
    run(MPMSTAB, "spectrum", *code.option, "-write_matrix", "probed.mtx", "-expect", "stable")
    near(scipy.io.mmread("probed.mtx").toarray(), OWN, 1e-9, f"{language}: matrix that {code.option[0]} gives")
    if language == "C":
        run(MPMSTAB, "symbol", *code.option, "-compare", "formulation=usl,wave_speed=1", "-json", "compared.json")
        with open("compared.json", encoding="utf-8") as file:
            check(json.load(file)["comparison"]["same"], "the bar as a plugin is not the scheme that it is")


# ---- the hook itself, on a step whose matrix is known ----


class Loop:
    """A linear step between particles near one another, and what makes it another: 'twist' changes the state after it."""

    def __init__(self, dim, kind, periodic, far=False, twist=None):
        random = numpy.random.default_rng(dim)
        n, self.h, self.period, self.calls = 60, [0.1, 0.05, 0.25][dim - 1], [1.0, 0.0, 0.0] if periodic else [0.0] * 3, 0
        types = [("x", "f8", (dim,)), ("v", kind, (2,)), ("J", kind)]
        self.p = numpy.zeros(n, dtype=numpy.dtype({"names": [t[0] for t in types], "formats": [t[1:] if t[2:] else t[1] for t in types],
                                                   "itemsize": 64, "offsets": [0, 24, 48]}))
        self.p["x"], self.p["J"] = random.uniform(0, 1, (n, dim)), 1
        apart = numpy.abs(self.p["x"][:, None] - self.p["x"][None])
        apart[..., 0] = numpy.minimum(apart[..., 0], 1 - apart[..., 0]) if periodic else apart[..., 0]
        near_by = numpy.all(apart < 0.99 * self.h, axis=2)
        width = dim + 3
        self.matrix = numpy.kron(near_by, numpy.ones((width, width))) * random.uniform(-1, 1, (n * width, n * width))
        if far:
            self.matrix[dim, numpy.argmax(apart[0, :, 0]) * width + dim] = 1
        self.twist, self.base = twist, self.flat().copy()

    def flat(self):
        columns = [self.p["x"], self.p["v"], self.p["J"][:, None]]
        return numpy.hstack([c.astype(float) for c in columns]).ravel()

    def advance(self):
        self.calls += 1
        d = self.flat() - self.base
        after = self.base + self.matrix @ (self.twist(d, self.calls) if self.twist else d)
        after = after.reshape(len(self.p), -1)
        dim = self.p["x"].shape[1]
        self.p["x"] = after[:, :dim] + (numpy.eye(dim)[0] if self.period[0] and self.calls % 2 else 0)  # through a period
        self.p["v"], self.p["J"] = after[:, dim:-1], after[:, -1]


class CLoop(ctypes.Structure):
    """mpmstab_hook"""
    _fields_ = [("period", ctypes.c_double * 3), ("work", ctypes.c_void_p)]


def hook_in_c(loop, told):
    hook = CLoop((ctypes.c_double * 3)(*(loop.period if told else [0] * 3)), None)
    names = {}
    for name in loop.p.dtype.names:
        kind, offset = loop.p.dtype.fields[name]
        names[name] = name.encode()
        words = [ctypes.byref(hook), names[name], ctypes.c_void_p(loop.p.ctypes.data + offset), kind.base.itemsize,
                 int(numpy.prod(kind.shape)), ctypes.c_size_t(loop.p.itemsize), ctypes.c_long(len(loop.p))]
        if name == "x":
            C.mpmstab_place(*words)
        else:
            C.mpmstab_field(*words, ctypes.c_double(1))
    while not C.mpmstab_probe(ctypes.byref(hook), b"loop.mtx", ctypes.c_double(loop.h)):
        loop.advance()
    check(C.mpmstab_probe(ctypes.byref(hook), b"loop.mtx", ctypes.c_double(loop.h)) == 1, "the hook begins again")


def hook_in_python(loop, told):
    state = {name: loop.p[name] for name in loop.p.dtype.names}
    dim = loop.p["x"].shape[1]
    periodic = [p or None for p in loop.period[:dim]] if told else None
    asking = hook.Hook("loop.mtx", loop.h, state, "x", periodic, {"v": 1, "J": 1})
    while asking.call(state):
        loop.advance()
    check(not asking.call(state), "the hook begins again")


def probed(way, loop, told=True):
    """What the hook makes of a loop: matrix and certificates."""
    before = loop.p.tobytes()
    if os.path.exists("loop.mtx"):
        os.remove("loop.mtx")
    way(loop, told)
    check(loop.p.tobytes() == before, f"{way.__name__}: the state after it is not the one before")
    return scipy.io.mmread("loop.mtx").toarray(), certificates("loop.mtx")


def remembers():
    """Adds a tenth of what the step before has got."""
    last = [0]

    def twist(d, calls):
        last.append(d)
        return d + 0.1 * last[-2]
    return twist


def check_loops(way):
    """Known matrices in 1 to 3 dimensions, in double and single precision, with and without periods."""
    for dim in (1, 2, 3):
        for kind, tolerance in (("f8", 1e-8), ("f4", 1e-4)):
            loop = Loop(dim, kind, periodic=dim != 2)
            found, says = probed(way, loop)
            near(found, loop.matrix, tolerance, f"{way.__name__}, {dim}-D, {kind}")
            check(says["additivity"] < tolerance and says["repeat"] < 1e-12, f"{way.__name__}, {dim}-D, {kind}: {says}")
            check(dim == 3 or says["calls"] < 0.8 * loop.matrix.shape[0] * 4, f"{way.__name__}, {dim}-D: {says['calls']} calls")
    order = 60 * 4
    for what, loop, told in (("a period that is not told", Loop(1, "f8", True), False),
                             ("a particle that reaches far", Loop(1, "f8", True, far=True), True)):
        found, says = probed(way, loop, told)
        if told:
            near(found, loop.matrix, 1e-8, what)
            check(says["calls"] >= 4 * order, f"{way.__name__}, {what}: {says['calls']} calls, each column needs 4")
        else:  # particles go round the period: without it they seem to jump
            check(says["repeat"] > 1, f"{way.__name__}, {what}: repeat {says['repeat']}")
    for name, above, twist in (("repeat", 0.01, lambda d, calls: d + 0.1 * calls),
                               ("two_steps", 1e-7, remembers()), ("repeat", 1e-7, remembers()),
                               ("repeat", 1e-7, lambda d, calls: d * (1 if calls < 500 else 0.9)),  # a switch that stays
                               ("one_sided", 0.1, lambda d, calls: numpy.abs(d)),
                               ("two_sizes", 1e-4, lambda d, calls: d + 1e6 * d**3),
                               ("additivity", 0.1, lambda d, calls: d * (numpy.count_nonzero(d) < len(d) / 2))):
        _, says = probed(way, Loop(1, "f8", False, twist=twist))
        check(says[name] > above, f"{way.__name__}: {name} is {says[name]}, expected above {above}")
    loop = Loop(1, "f8", False, twist=lambda d, calls: d * (numpy.nan if calls > 30 else 1))
    before = loop.p.tobytes()
    os.remove("loop.mtx")
    way(loop, True)
    check(loop.calls == 31 and loop.p.tobytes() == before and not os.path.exists("loop.mtx"),
          f"{way.__name__}: a state that is not finite ends it without a file")


def check_page():
    """The growth on the page is what its commands print."""
    run(CC, "-DCOURANT=1.1", INCLUDE, "-o", "hook_too_fast", CODE / "hook.c", "-lm")
    run("./hook_too_fast")
    run(MPMSTAB, "spectrum", "-matrix", "A.mtx", "-json", "out.json", "-expect", "unstable")
    check_carried("A.mtx")
    growth = checks.loaded("out.json")["spectrum"]["growth"]
    run(MPMSTAB, "symbol", "-matrix_blocks", "A.mtx", "-json", "out.json", "-expect", "unstable")
    near(numpy.array(checks.loaded("out.json")["symbol"]["growth"]), numpy.array(growth), 1e-9, "growth by the blocks")
    check(f"{growth:.5f} per step" in checks.text_of(CODE / "README.md"), f"the page does not have the growth {growth:.5f}")


def edited(path, *changes):
    """A file with other words; each of them must be there."""
    with open("edited.mtx", "w", encoding="ascii") as file:
        file.write(replaced(checks.text_of(path), changes))
    return "edited.mtx"


def check_carried(path):
    """Certificates that fail make the verdict undecided. Growth stays unstable when the fault cannot make it."""
    says = re.search("% two_sizes: .*\n", checks.text_of(path))[0]
    repeat = re.search("% repeat: .*\n", checks.text_of(path))[0]
    for verdict, *changes in (("unstable", (says, "% two_sizes: 1e-4\n")), ("undecided", (says, "% two_sizes: 10\n")),
                              ("undecided", (repeat, "% repeat: 1e-3\n")), ("unstable", (repeat, "% repeat: 1e-9\n"))):
        for task, option in (("spectrum", "-matrix"), ("symbol", "-matrix_blocks")):
            run(MPMSTAB, task, option, edited(path, *changes), "-expect", verdict)


def check_blocks_refused(path):
    """Where cells are not alike, or where it is not known, there are no blocks, and a message says why."""
    lines = checks.text_of(path).splitlines()
    places = [line for line in lines if line.startswith("% at:")]
    last, sizes = lines[-1].split(), next(line for line in lines if line[0] != "%")
    far = (sizes, f"96 96 {int(sizes.split()[2]) + 1}"), (lines[-1], f"{lines[-1]}\n1 50 1")  # the middle is felt at the edge
    for says, *changes in (
            ("it does not say where its particles are", ("% period:", "% no period:")),
            ("it does not say where its particles are", ("% cell_width: 0.0625", "% cell_width: 0")),
            ("32 particles with 2 numbers, and order 96", ("% numbers: 3", "% numbers: 2")),
            ("31 particles with 3 numbers, and order 96", (places[3] + "\n", "")),
            ("line 2: % steps: -2; allowed", ("% steps: 1", "% steps: -2")),
            ("other places in them", (places[3], "% at: 0.11")),
            ("different numbers of particles", (places[3], "% at: 0.13")),
            ("some cells have none", ("% period: 1", "% period: 3")),
            ("% at: inf; allowed: finite numbers", (places[3], "% at: inf")),
            ("its cells differ by", (lines[-1], f"{last[0]} {last[1]} {float(last[2]) + 1e-4}")),
            ("no cell away from its edges", *far)):
        done = forks.run([MPMSTAB, "symbol", "-matrix_blocks", edited(path, *changes)], capture_output=True, text=True,
                         check=False)
        check(done.returncode == 2 and says in done.stderr and len(done.stderr.splitlines()) == 1, f"{says}: {done.stderr}")


class Foreign:
    """An array of another library: how it gives and takes values is all that it shares with numpy's."""

    def __init__(self, values, give, take):
        self.values = numpy.array(values, dtype=numpy.float32)
        setattr(self, give, lambda: self if give == "detach" else self.values.copy())
        setattr(self, take, (lambda given: numpy.array(given)) if take == "new_tensor" else self.accept)

    def accept(self, given):
        check(given.dtype == numpy.float32, f"an array of single precision gets {given.dtype}")
        self.values = numpy.array(given)

    def cpu(self):
        return self

    def numpy(self):
        return self.values.copy()

    @property
    def data(self):
        return self

    copy_ = accept


def check_foreign():
    """Taichi's fields, Warp's arrays and torch's tensors are read and written in their own ways."""
    for ways in (("to_numpy", "from_numpy"), ("numpy", "assign"), ("detach", "new_tensor")):
        array = Foreign([[1, 2], [3, 4]], *ways)
        state = {"a": array, "b": numpy.zeros((2, 2, 2))}
        hook.scatter(state, numpy.arange(12.0).reshape(2, 6))
        check(array.values.tolist() == [[0, 1], [6, 7]] and state["b"][1].tolist() == [[8, 9], [10, 11]], f"{ways}: {array.values}")
        near(hook.gather(state), numpy.arange(12.0).reshape(2, 6), 0, f"{ways}")


def check_serve():
    """What a step prints stays out of the answers; what it raises is the answer; any number of particles, new arrays."""
    code = Program(sys.executable, "-c", """
import numpy
from mpmstab.adapter import serve
def step(state, dt):
    print("a line that is no answer")
    if dt < 0: raise ValueError("dt is below 0")
    return {"x": state["x"] + dt * len(state["x"]), "v": 2 * state["v"], "stress": state["stress"]}
x = numpy.zeros((32, 1), dtype=numpy.float32)
serve(step, {"x": x, "v": x, "stress": x}, cell_width=1, fields={"x": {"place": True}}, parameters={"dt": 1}, any_count=True,
      reset=lambda: print("forgets", flush=True))
""")
    check(code.description["any_count"] and code.description["periodic"] == [None], f"serve: {code.description}")
    near(code.step(code.base + 1), numpy.tile([33.0, 2, 1], 32), 0, "serve: 32 particles")
    check(code.ask({"do": "step", "steps": 2, "particles": 1}, numpy.ones(3).tobytes()) == {}, "serve: a particle")
    near(numpy.frombuffer(code.child.stdout.read(24)), numpy.array([3.0, 4, 1]), 0, "serve: a particle")
    pathlib.Path("prints.py").write_text(f"""import os, sys
sys.path.append({str(CODE)!r})
from mpmstab.adapter import serve
print("a library says what it is", flush=True)
os.system("echo and what it starts does so, too")
{checks.text_of(CODE / 'serve.py')}""", encoding="utf-8")
    run(MPMSTAB, "spectrum", "-program", f"{sys.executable} prints.py", "-expect", "stable")
    code.set("dt", -1)
    check("dt is below 0" in code.ask({"do": "step", "steps": 1}, code.base.tobytes())["error"], "serve: an error")
    code.end()


def check_crash():
    """A plugin that crashes is named."""
    pathlib.Path("crash.c").write_text(f'''#include <signal.h>
#define mpmstab_step kept_step
#include "{CODE / 'plugin.c'}"
#undef mpmstab_step
int mpmstab_step(int steps, int64_t particles, double state[]) {{ return raise(SIGABRT); }}
''', encoding="utf-8")
    shared("./libcrash.so", CC, "crash.c")
    done = forks.run([MPMSTAB, "spectrum", "-plugin", "./libcrash.so"], capture_output=True, text=True, check=False)
    check(done.returncode == 2 and done.stderr == "mpmstab: plugin ./libcrash.so: the library was ended by signal 6 (Aborted)\n",
          f"crash: status {done.returncode}, {done.stderr}")


OWN = own()
for spoken, words in languages().items():
    check_hook(spoken, *words)
    if spoken == "C":
        run(*words)
        check_blocks_refused("A.mtx")
for spoken, adapter in adapters():
    check_adapter(spoken, adapter)
# New memory is full of numbers that are not finite, so that nothing is read before it is set.
pathlib.Path("filled.h").write_text("""#include <stdlib.h>
#include <string.h>
static inline void *filled(void *old, size_t bytes)
{
  void *room = realloc(old, bytes);
  return room && !old ? memset(room, 0xff, bytes) : room;
}
#define realloc filled
""", encoding="ascii")
shared("./libprobe.so", CC, "-include", "./filled.h", "-x", "c", ROOT / "include/mpmstab_probe.h", flags=["-DMPMSTAB_PROBE_API="])
C = ctypes.CDLL("./libprobe.so")
from mpmstab import hook  # noqa: E402

check_page()
check_foreign()
check_serve()
check_crash()
for of in (hook_in_c, hook_in_python):
    check_loops(of)
