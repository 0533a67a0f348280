#!/usr/bin/python3
"""Checks codes in any units that declare no scales, switches, and fields that nothing reads, by every way in.

check_scales.py PART CC MPIEXEC MPMSTAB, in a folder that may be filled. PART: programs, hooks or languages. Growth is that of
our own table at the same Courant number, or a closed form: forward Euler grows by sqrt(1 + k^2) with a particle in the middle
of each cell.
"""
import json
import os
import pathlib
import shutil
import sys

import numpy

import checks
from checks import check, forks, loaded

ROOT = pathlib.Path(checks.ROOT)
PART, CC, MPIEXEC, MPMSTAB = sys.argv[1:]
CODE, INCLUDE = ROOT / "examples/your-code", f"-I{ROOT / 'include'}"
BAR = [sys.executable, str(ROOT / "tests/python/program_units.py")]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT / "scripts/python"), "PYTHONDONTWRITEBYTECODE": "1"}
UNITS = {"SI": "", "mm, t, s": "E=2e5 rho=7.8e-9 h=10", "soft": "E=1e-6 rho=1e-3 h=1e3", "um": "E=1e12 rho=1e-12 h=1e-6"}
EULER, K = "euler k=0.57735026919", 3**-0.5


def run(*words, ranks=1):
    """Runs a command; returns what mpmstab writes as JSON."""
    launch = [MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
    words = [str(word) for word in words] + (["-json", "out.json"] if words[0] == MPMSTAB else [])
    done = forks.run([*launch, *words], capture_output=True, text=True, check=False, env=ENVIRONMENT)
    check(done.returncode == 0, f"{words}: status {done.returncode}, {done.stdout[-600:]} {done.stderr[-600:]}")
    return loaded("out.json") if words[0] == MPMSTAB else None


def growth(found):
    return (found["refined"] if "refined" in found else found["spectrum"])["growth"]


def expect(what, found, verdict, right, within):
    certificates = found["certificates"] if "certificates" in found else found["probing"]["certificates"]
    check(found["verdict"] == verdict, f"{what}: {found['verdict']}, {found['evidence']}, {certificates}")
    check(abs(growth(found) - right) <= within * right, f"{what}: growth {growth(found)}, expected {right}")
    scales = found.get("scales") or found["probing"]["scales"]
    check(scales[0]["from"] == "cell_width" and all(one["from"] == "found" for one in scales[1:]), f"{what}: {scales}")
    check(certificates["scales"]["holds"] and certificates["scales"]["value"] <= 1, f"{what}: {certificates}")


def own(formulation, k, ppc=1):
    found = run(MPMSTAB, "symbol", "-formulation", formulation, "-cells", 16, "-ppc", ppc, "-courant", k)
    return found["symbol"]["growth"]


def program(task, words, ranks=1):
    return run(MPMSTAB, task, "-program", " ".join([*BAR, words]), ranks=ranks)


def hooked(task, words):
    run(*BAR, *words.split(), "hook=A.mtx")
    return run(MPMSTAB, task, "-matrix_blocks" if task == "symbol" else "-matrix", "A.mtx")


def check_units(way):
    """Steps that are stable and that are not, in several units, precisions and states."""
    schemes = [("usl k=0.5", "stable", 1), ("usl k=1.2", "unstable", own("usl", 1.2)), ("musl k=0.9", "stable", own("musl", 0.9)),
               (EULER, "unstable", (1 + K**2) ** 0.5), ("euler k=0.3", "unstable", 1.09**0.5)]
    for i, (name, units) in enumerate(UNITS.items()):
        for precision, within in (("", 1e-8), ("single", 1e-5)):
            for j, (scheme, verdict, right) in enumerate(schemes):
                if way is hooked and (i + j + len(precision)) % 2:
                    continue  # programs have them all, at night
                base = ("", "jacobian", "stress=1e9" if name == "SI" else "")[(i + j) % 3]
                words = f"{scheme} {units} {precision} {base}"
                expect(f"{way.__name__}, {name}: {words}", way("symbol", words), verdict, right, within)
        expect(f"{way.__name__}, {name}, spectrum", way("spectrum", f"{EULER} {units}"), "unstable", (1 + K**2) ** 0.5, 1e-8)
    for words, right in (("usl k=1e-4", 1), ("usl k=1e-4 jacobian", 1), ("euler k=0.01 stress=1e9", 1.0001**0.5)):
        expect(f"{way.__name__}: {words}", way("symbol", words), "stable" if right == 1 else "unstable", right, 1e-8)


def check_faults(way):
    """A viscosity in compression only is a switch; outputs that nothing reads are none; a scale may not be found."""
    for task in ("symbol", "spectrum"):
        for words, bound in (("usl k=0.5 damped", 1e-5), ("usl k=0.5 kinked", 1e-5), ("usl k=0.5 kinked single", 1e-3)):
            found = way(task, words)
            certificates = found["certificates"] if "certificates" in found else found["probing"]["certificates"]
            check(found["verdict"] == "undecided" and certificates["one side"]["bound"] == bound
                  and not certificates["one side"]["holds"], f"{way.__name__}: {found['verdict']}, {certificates}")
        expect(f"{way.__name__}: outputs", way(task, "euler k=0.3 outputs"), "unstable", 1.09**0.5, 1e-8)
        expect(f"{way.__name__}: outputs", way(task, "usl k=0.5 outputs"), "stable", 1, 1e-8)
        found = way(task, "usl k=0.3 lost stress=1e9")
        certificates = found["certificates"] if "certificates" in found else found["probing"]["certificates"]
        check(found["verdict"] == "undecided" and certificates["scales"]["value"] is None and not certificates["scales"]["holds"],
              f"{way.__name__}: {found['verdict']}, {certificates}")
        scales = found.get("scales") or found["probing"]["scales"]
        check([one["from"] for one in scales] == ["cell_width", "declared", "guessed"], f"{way.__name__}: {scales}")


def check_kinked():
    """The run with this kink grows, so that stable would be wrong: a bar that moves backward as a whole."""
    sys.path.insert(0, str(ROOT / "tests/python"))
    from program_units import Bar
    bar = Bar(["usl", "k=0.5", "kinked", "v=-1e-9"])
    for _ in range(100):
        bar.advance()
    check(abs(bar.state["v"] / (-1e-9 * 1.005**100) - 1).max() < 1e-9, f"v is {bar.state['v']}")


def edited(name, *changes):
    """An example with other words."""
    text = (CODE / name).read_text(encoding="utf-8")
    for old, new in changes:
        check(old in text, f"{name} does not have {old}")
        text = text.replace(old, new)
    pathlib.Path(name).write_text(text, encoding="utf-8")


def languages():
    """The examples of all languages as a bar of steel, at Courant numbers 0.5 and 1.1: the option of its hook or plugin."""
    c = (2e11 / 7800) ** 0.5
    for k in (0.5, 1.1):
        edited("bar.h", ("dt = COURANT / CELLS", f"dt = {k / 16 / c!r}"), ("p[i].stress / h", "p[i].stress / (7800 * h)"),
               ("step * (vb - va) / h", "2e11 * step * (vb - va) / h"))
        edited("hook.c", (", PARTICLES, 1)", ", PARTICLES, 0)"))
        edited("plugin.c", (', \\"scale\\": 1', ""))
        run(CC, "-O2", INCLUDE, "-o", "hook_c", "hook.c", "-lm")
        yield f"C, {k}", k, ["./hook_c"]
        run(CC, "-O2", "-fPIC", "-shared", INCLUDE, "-o", f"./libbar_{k}.so", "plugin.c", "-lm")
        yield f"plugin, {k}", k, ["-plugin", f"./libbar_{k}.so"]
        if shutil.which("c++"):
            run("c++", "-x", "c++", "-std=c++11", "-Wall", "-Wextra", "-Werror", INCLUDE, "-o", "hook_cpp", "hook.c", "-lm")
            yield f"C++, {k}", k, ["./hook_cpp"]
        if shutil.which("gfortran"):
            edited("bar.f90", ("dt = 0.5d0/cells", f"dt = {k / 16 / c:.17e}".replace("e", "d")), ("volume*stress(i)/h", "volume*stress(i)/(7800*h)"),
                   ("+ dt*(velocity(b)", "+ 2d11*dt*(velocity(b)"))
            edited("hook.f90", (", scale=1d0", ""))
            run(CC, "-x", "c", "-DMPMSTAB_PROBE_API=", "-c", ROOT / "include/mpmstab_probe.h", "-o", "mpmstab_probe.o")
            run("gfortran", "-o", "hook_f", "bar.f90", CODE / "mpmstab_hook.f90", "hook.f90", "mpmstab_probe.o", "-lm")
            yield f"Fortran, {k}", k, ["./hook_f"]
        if shutil.which("octave-cli"):
            edited("advance.m", ("volume * stress / h, -volume * stress / h", "volume * stress / (7800 * h), -volume * stress / (7800 * h)"),
                   ("dt * (velocity(right)", "2e11 * dt * (velocity(right)"))
            edited("hook.m", ("dt = h / 2;", f"dt = {k / 16 / c!r};"))
            yield f"Octave, {k}", k, ["octave-cli", "-q", "--path", CODE, "--path", ".", "hook.m"]


def check_switches():
    """In C and in Octave: an output that nothing reads may have a kink, the velocity may not."""
    most = ("p[i].x -= floor(p[i].x);", "p[i].x -= floor(p[i].x); most[i] = fmax(most[i], p[i].stress); KINK")
    edited("bar.h", ("static Particle p[PARTICLES];", "static Particle p[PARTICLES]; static double most[PARTICLES];"), most)
    edited("hook.c", (", PARTICLES, 1)", ", PARTICLES, 0)"),
           ("  if (argc < 3)", '  mpmstab_field(&hook, "most", most, MPMSTAB_DOUBLE, 1, sizeof *most, PARTICLES, 0);\n  if (argc < 3)'))
    edited("advance.m")
    for kink, in_c, in_octave in ((False, "", ""), (True, "p[i].v *= p[i].v < 0 ? 1.005 : 0.985;", "v = v .* (0.985 + 0.02 * (v < 0));")):
        edited("hook.m", ("stress = zeros(32, 1);", "stress = zeros(32, 1); most = stress;"), ("[x, v, stress, busy]", "[x, v, stress, most, busy]"),
               ("x, v, stress);\n", "x, v, stress, most);\n"),
               ("advance(x, v, stress, h, dt); end\nend", f"advance(x, v, stress, h, dt); most = max(most, stress); {in_octave} end\nend"))
        run(CC, "-O2", INCLUDE, f"-DKINK={in_c}", "-o", "hook_c", "hook.c", "-lm")
        for command in (["./hook_c"], ["octave-cli", "-q", "--path", CODE, "--path", ".", "hook.m"]):
            if not shutil.which(command[0]):
                continue
            run(*command)
            found = run(MPMSTAB, "spectrum", "-matrix", "A.mtx")
            check(found["verdict"] == ("undecided" if kink else "stable") and found["certificates"]["one side"]["holds"] != kink,
                  f"{command[0]}, kink {kink}: {found['verdict']}, {found['certificates']}")


def check_languages():
    right = {0.5: 1, 1.1: own("usl", 1.1, 2)}
    for what, k, words in languages():
        for task in ("symbol", "spectrum"):
            if words[0] != "-plugin":
                run(*words)
            option = words if words[0] == "-plugin" else ["-matrix_blocks" if task == "symbol" else "-matrix", "A.mtx"]
            expect(f"{what}, {task}", run(MPMSTAB, task, *option), "stable" if k == 0.5 else "unstable", right[k], 1e-8)


def check_ranks():
    """All ranks take the scales of the first one."""
    one, two = program("symbol", EULER), program("symbol", EULER, ranks=2)
    check(json.dumps(one["probing"]["scales"]) == json.dumps(two["probing"]["scales"]), f"{two['probing']['scales']}")
    expect("2 ranks", two, "unstable", (1 + K**2) ** 0.5, 1e-8)


if PART == "programs":
    check_units(program)
    check_faults(program)
    check_ranks()
elif PART == "hooks":
    check_units(hooked)
    check_faults(hooked)
    check_kinked()
else:
    check_languages()
    check_switches()
