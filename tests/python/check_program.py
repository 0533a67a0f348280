#!/usr/bin/python3
"""Checks -program against scenes of the same schemes, and that what is wrong with a code is noticed.

check_program.py PART MPIEXEC MPMSTAB, in a folder that may be filled. PART: steps, scenes, mls, calls, faults, strange,
failures, page, map, free, compare, moving, run or asked. Silent when all is well.
"""
import csv
import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import time

import h5py
import numpy
import scipy.sparse

import program_implicit
from checks import check, loaded, on_ranks, text_of

HERE = os.path.dirname(os.path.abspath(__file__))
MPMSTAB = sys.argv[-1]


def program(name, *words):
    return " ".join([sys.executable, os.path.join(HERE, name), *words])


def run(*words, ranks=1, status=0):
    """Runs mpmstab. Returns its JSON, or what it says on standard error if it must fail."""
    done = on_ranks(ranks, MPMSTAB, *words, "-json", "out.json")
    check(done.returncode == status, f"{words}: status {done.returncode}, {done.stdout[-600:]} {done.stderr}")
    run.said = done.stdout
    return loaded("out.json") if status == 0 else done.stderr


def near(what, one, other, within=1e-9):
    check(abs(one - other) <= within, f"{what}: {one!r} and {other!r}")


def check_operator(scheme):
    """The operator of the code is that of the scene: both have v and s of a particle, then those of the next one."""
    scene = ["-formulation", scheme, "-cells", "16", "-courant", "0.5"]
    run("spectrum", *scene, "-measure", "false", "-write_matrix", "scene.npz")
    right = scipy.sparse.load_npz("scene.npz").toarray()
    for ranks in (1, 3) if scheme == "usl" else (1,):
        found = run("spectrum", "-program", program("program_steps.py", scheme), "-write_matrix", "code.npz", ranks=ranks)
        check(found["probing"]["set_apart"] == [0], f"set apart: {found['probing']['set_apart']}")
        near(f"{scheme}, {ranks} ranks",
             abs(scipy.sparse.load_npz("code.npz").toarray() - right).max(), 0)


def blocks_of(*words, ranks=1):
    """The blocks A_d that symbol writes, by d."""
    run("symbol", *words, "-write_blocks", "blocks.npz", ranks=ranks)
    with numpy.load("blocks.npz") as file:
        return {tuple(d): A for d, A in zip(file["d"].reshape(len(file["A"]), -1), file["A"])}


def check_blocks():
    one = blocks_of("-formulation", "usl", "-cells", "16", "-courant", "0.5")
    other = blocks_of("-program", program("program_steps.py", "usl"))
    check(set(one) == set(other), f"blocks reach {sorted(one)} and {sorted(other)}")
    for d, A in one.items():
        near(f"block {d}", abs(A - other[d]).max(), 0)


def check_steps():
    check_blocks()
    for scheme in ("usl", "musl"):
        check_operator(scheme)
    drifts = ["-drift", "1/8", "-offset", "0.625"]
    for words, scene, dt in ((["usl"], [], "0.5"), (["usl"], [], "0.8"), (["musl", "drift=0.125", "32"], drifts, "0.5")):
        right = run("symbol", "-formulation", words[0], "-cells", "16", "-phases", "32", *scene, "-courant", dt)
        for ranks in (1, 2) if dt == "0.8" else (1,):
            found = run("symbol", "-program", program("program_steps.py", *words), "-program_set", f"dt={dt}",
                        "-phases", "32", ranks=ranks)
            near(f"symbol {words} {dt}", found["symbol"]["growth"], right["symbol"]["growth"], 2e-8 if scene else 1e-9)
            check(found["verdict"] == right["verdict"], f"{words} {dt}: {found['verdict']}, {right['verdict']}")
            check(all(one["holds"] for one in found["probing"]["certificates"].values()), f"{words}: {found['probing']}")
    right = run("critical", "-formulation", "usl")["critical"]["critical_courant"]
    near("critical", run("critical", "-program", program("program_steps.py", "usl"))["critical"]["critical_dt"], right, 2e-6)
    single = run("critical", "-program", program("program_steps.py", "usl", "single"))
    check(single["probing"]["single"], "single precision is not noticed")
    rounded = run("symbol", "-program", program("program_steps.py", "usl", "single", "4096"))
    check(rounded["probing"]["certificates"]["two sizes"]["holds"], f"places that are rounded coarsely: {rounded['probing']}")
    near("critical in single precision", single["critical"]["critical_dt"], right, 1e-5)
    check_at()


def check_at():
    """A state that the code comes to by itself: of a linear step the operator stays the same."""
    found = run("spectrum", "-program", program("program_steps.py", "usl"), "-program_set", "dt=0.8", "-at", "0,3")
    check([one["step"] for one in found["states"]] == [0, 3], f"states: {found['states']}")
    near("states", found["states"][0]["growth"], found["states"][1]["growth"], 1e-7)
    near("share of the mode's particles", sum(one["share"] <= 1 for one in found["carriers"]), 3)


def check_scenes():
    """A code that is one function is given the particles of our scenes: its operator is that of usl on the same ones."""
    os.environ["PYTHONPATH"] = os.path.join(HERE, "..", "..", "scripts", "python")
    code = ["-program", program("program_scene.py")]
    for keys, ranks in (("cells=16", 2), ("cells=16,fill=3,9", 1), ("cells=12,jitter=0.3,seed=2", 3), ("cells=12,counts=1,3", 1),
                        ("cells=8,fill=3,4,ppc=1,offset=0.2", 1), ("cells=9,layout=random,seed=4", 2)):
        ours = [word for pair in re.split(r",(?=[a-z])", keys) for word in zip(("-" + pair.partition("=")[0],), (pair.partition("=")[2],))]
        run("spectrum", "-formulation", "usl", "-courant", "0.5", *sum(map(list, ours), []), "-measure", "false", "-write_matrix", "scene.npz")
        right = scipy.sparse.load_npz("scene.npz").toarray()
        found = run("spectrum", *code, "-program_scene", keys, "-write_matrix", "code.npz", ranks=ranks)
        lone = "offset" in keys  # its place is read: the force on one particle depends on it
        theirs = scipy.sparse.load_npz("code.npz").toarray()
        if lone:
            check(len(theirs) > len(right) and found["verdict"] == "stable", f"{keys}: {theirs.shape}, {found['verdict']}")
        else:
            near(f"{keys}, {ranks} ranks", abs(theirs - right).max(), 0, 1e-8)
    heavy = ["-density", "2", "-young", "1"]  # the code has its own stiffness, 1, and takes the masses
    right = run("spectrum", "-formulation", "usl", "-cells", "16", "-cell_width", "0.5", "-dt", "0.6", *heavy, "-measure", "false")["growth"]
    found = run("spectrum", *code, "-program_set", "dt=0.6", "-program_scene", "cells=16,density=2,young=1")["growth"]
    near("growth of heavy particles", found, right, 1e-9)
    check(right > 1.1, f"growth of heavy particles: {right}")
    limits = run("critical", *code)["critical"]["limits"]
    for name, right in (("interior", 4 / 7), ("lone_particle", 3 / 8)):
        near(name, limits[name] / 0.5, right**0.5, 2e-6)
    check(list(run("critical", *code, "-probe", "bloch")["critical"]["limits"]) == ["interior"], "parts are sought with -probe bloch")
    same = run("symbol", *code, "-program_scene", "cells=10,ppc=3", "-compare", "formulation=usl,wave_speed=1")["comparison"]
    check(same["same"], f"compared with ours: {same}")
    run("symbol", "-program", program("program_scene.py", "6"), "-program_scene", "ppc=1")
    for words, said in (([*code, "-program_scene", "cells"], "keys of a scene"), ([*code, "-program_scene", "cells=8,dim=2"], "those of the code"),
                        ([*code, "-program_scene", "cels=8"], "unknown key 'cels'"),
                        (["-program", program("program_scene.py", "6"), "-program_scene", "cells=8"], "allowed: 12 cells"),
                        (["-program", program("program_steps.py", "usl"), "-program_scene", "cells=8"], "the code takes no scenes")):
        for ranks in (1, 2) if said == "keys of a scene" else (1,):
            answer = run("symbol", *words, status=2, ranks=ranks)
            check(said in answer and answer.count("mpmstab:") == 1, f"{words}: {answer}")
    said = run("symbol", "-cells", "8", "-program_scene", "cells=8", status=2)
    check("allowed: only with program or plugin" in said, f"a scene for a scene: {said}")


def check_mls():
    """A fluid on splines in two dimensions has the symbol of our scene, and critical finds the limits of its kind."""
    scene = ["-formulation", "usl", "-transfer", "apic", "-gradient", "mls", "-basis", "quadratic"]
    right = run("symbol", *scene, "-dim", "2", "-poisson", "0.5", "-cells", "8", "-courant", "1.4", "-phases", "8")
    for words, within in ((["2", "8"], 1e-9), (["2", "7", "free"], 1e-9), (["2", "8", "single"], 1e-5)):
        for ranks in (1, 3) if words == ["2", "8"] else (1,):
            found = run("symbol", "-program", program("program_mls.py", *words), "-program_set", "tau=1.4", "-phases", "8",
                        ranks=ranks)
            near(f"symbol {words}", found["symbol"]["growth"], right["symbol"]["growth"], within)
            check(found["verdict"] == "unstable", f"{words}: {found['verdict']}, {found['evidence']}")
            check(all(one["holds"] for one in found["probing"]["certificates"].values()), f"{words}: {found['probing']}")
    for cells in ("5", "6"):  # a step reaches around so short a period, or to both of its sides
        found = run("symbol", "-program", program("program_mls.py", "1", cells), "-phases", "8")
        check(not found["probing"]["certificates"]["reach"]["holds"], f"{cells} cells: {found['probing']}")
        check(found["verdict"] == "undecided", f"{cells} cells: {found['verdict']}")
    found = run("critical", "-program", program("program_mls.py", "1", "8", "free"), "-program_dt", "tau")["critical"]
    near("interior", found["limits"]["interior"], run("critical", *scene)["critical"]["critical_courant"], 2e-6)
    near("lone particle", found["limits"]["lone_particle"], 1, 2e-6)  # docs/limits.md
    near("critical", found["critical_dt"], min(found["limits"].values()), 0)
    check(found["evaluations"] <= 20, f"{found['evaluations']} operators")
    check_most_calls(("critical", "1", "8", "free", 950), ("spectrum", "1", "24", "free", 330))
    check_no_polynomial("1", "8")
    check([one["share"] for one in found["carriers"]] == [1], f"carriers: {found['carriers']}")
    lone = found["carriers"][0]["place"][0] % 1
    check(lone in (0.25, 0.75), f"the lone particle is at {lone}")


def check_calls():
    """In two dimensions, which takes longer: a lattice of 5 ms a step in 20 s, with all its parts in 60 s."""
    check_most_calls(("critical", "2", "8", 1050), ("spectrum", "2", "12", 250), ("spectrum", "2", "4", "free", 2142))
    limits = check_no_polynomial("2", "8", "free")
    check(set(limits) == {"interior", "lone_particle"} and "not sought" in run.said, f"{limits}")  # it would take minutes


def check_most_calls(*cases):
    """So many steps of a code answer."""
    for task, *words, most in cases:
        options = ["-program_dt", "tau"] if task == "critical" else []
        found = run(task, "-program", program("program_mls.py", *words), *options)
        check(found["probing"]["calls"] <= most, f"{task} {words}: {found['probing']['calls']} calls")
        check(found["verdict"] == "stable", f"{task} {words}: {found['verdict']}, {found['evidence']}")
        if task == "critical":
            check(found["critical"]["expected_calls"] >= 0.6 * found["probing"]["calls"], f"{words}: {found['critical']}")


def check_no_polynomial(*words):
    """A step that is no polynomial of dt is probed at each dt that is tried."""
    found = run("critical", "-program", program("program_mls.py", *words, "odd"), "-program_dt", "tau")
    limits = found["critical"]["limits"]
    check(found["probing"]["calls"] < 4000, f"{found['probing']['calls']} calls")
    near("interior", limits["interior"] * (1 + 0.01 * numpy.sin(40 * limits["interior"])), 1.306373, 3e-6)
    return limits


def check_moving():
    """Particles that are set to the places of a period: growth per step is that of our schemes under the same drift."""
    mls = ["-formulation", "usl", "-transfer", "apic", "-gradient", "mls", "-basis", "quadratic", "-dim", "2", "-poisson", "0.5"]
    musl = ["-formulation", "musl", "-offset", "0.5"]
    cases = [(program("program_mls.py", "2", "8"), "tau=0.8", mls, "8", "1/4,1/4"), (program("program_mls.py", "2", "7", "free"), "tau=0.8", mls, "8", "0,1/4"),
             (program("program_steps.py", "musl", "32"), "dt=0.5", musl, "32", "1/8"), (program("program_steps.py", "usl"), "dt=0.5", ["-formulation", "usl"], "32", "3/8")]
    if shutil.which("octave"):
        cases.append((f"octave -q {HERE}/program_musl.m {HERE}/../../examples/your-code", "dt=0.5", musl, "32", "1/8"))
    else:
        print("Octave is not there: its musl is not asked")
    for code, given, scene, phases, drift in cases:
        asked = ["-program", code, "-program_set", given, "-phases", phases, "-drift", drift]
        right = run("symbol", *scene, "-courant", given.partition("=")[2], "-cells", phases, "-phases", phases, "-drift", drift)
        for ranks in (1, 2) if "musl 32" in code else (1,):
            found = run("symbol", *asked, ranks=ranks)
            near(f"growth of {code} at {drift}", found["symbol"]["growth"], right["symbol"]["growth"], 1e-8)
            check(found["verdict"] == right["verdict"], f"{code} at {drift}: {found['verdict']}, {found['evidence']}")
            check(all(one["holds"] for one in found["probing"]["certificates"].values()), f"{code}: {found['probing']}")
    code = ["-program", program("program_steps.py", "musl", "32"), "-phases", "32"]
    found = run("symbol", *code, "-mach", "1/4")
    near("drift of a Mach number", found["motion"]["drift"], 0.125, 0)
    near("Courant number of long waves", found["motion"]["courant"], 0.5, 1e-4)
    check_moving_spectrum()
    check_moving_critical()
    for task, *words, said in (("map", "-map_axes", "dt,c", "-drift", "1/8", "takes the place of a scene"), ("spectrum", "-drift", "1/8", "-at", "3", "without at"),
                               ("critical", "-mach", "1/4", "would change with the time step"), ("symbol", "-drift", "1/8", "-compare", "formulation=musl,courant=0.5", "without compare"),
                               ("symbol", "-drift", "0.1234567", "after more than 128 steps"), ("symbol", "-drift", "a", "a fraction such as 1/8")):
        answer = run(task, *(code if task == "symbol" else code[:2]), *words, status=2)
        check(said in answer and answer.count("mpmstab:") == 1, f"{words}: {answer}")
    answer = run("symbol", "-program", program("program_steps.py", "musl", "drift=0.125", "32"), "-drift", "1/8", status=2)
    check("move by themselves" in answer, f"particles that move: {answer}")


def check_moving_spectrum():
    """Of all particles the operator of a period is the product of those of its steps."""
    musl = ["-formulation", "musl", "-cells", "16", "-courant", "0.5", "-offset", "0.5", "-drift", "1/8"]
    right = run("spectrum", *musl)
    for ranks in (1, 2):
        found = run("spectrum", "-program", program("program_steps.py", "musl", "32"), "-program_set", "dt=0.5", "-drift", "1/8", ranks=ranks)
        near("growth of a moving ring", found["growth"], right["growth"], 1e-8)
        check(found["verdict"] == right["verdict"] and found["spectrum"]["period_steps"] == 8, f"a moving ring: {found['evidence']}")
        near("its drift", found["motion"]["drift"], 0.125, 0)
    free = ["-program", program("program_mls.py", "1", "6", "free"), "-program_set", "tau=0.8"]
    steps = []
    for base in ("x=0", "x=0.5"):
        run("spectrum", *free, "-program_base", base, "-write_matrix", "step.npz")
        steps.append(scipy.sparse.load_npz("step.npz").toarray())
    found = run("spectrum", *free, "-drift", "1/2")
    near("growth of a moving block", found["growth"], abs(numpy.linalg.eigvals(steps[1] @ steps[0])).max()**0.5, 1e-7)
    check(all(one["holds"] for one in found["probing"]["certificates"].values()), f"a moving block: {found['probing']}")
    at_rest = run("spectrum", *free)
    near("by whole cells", run("spectrum", *free, "-drift", "1")["growth"], at_rest["growth"], 1e-9)


def check_moving_critical():
    """The largest time step at which cells do not grow while they move; for ringing the one at which growth is tolerated."""
    mls = ["-formulation", "usl", "-transfer", "apic", "-gradient", "mls", "-basis", "quadratic"]
    for code, name, scene in ((program("program_steps.py", "usl"), "dt", ["-formulation", "usl"]), (program("program_mls.py", "1", "8"), "tau", mls),
                              (program("program_steps.py", "musl", "32"), "dt", ["-formulation", "musl", "-offset", "0.5"])):
        right = run("critical", *scene, "-drift", "1/8")["critical"]["critical_courant"]
        found = run("critical", "-program", code, "-program_dt", name, "-drift", "1/8")
        near(f"limit of {code} at drift 1/8", found["critical"]["critical_dt"], right, 2e-6 * right)
        near("its drift", found["motion"]["drift"], 0.125, 0)
        check(list(found["critical"]["limits"]) == ["interior"], f"{found['critical']['limits']}")


def check_run():
    """Growth by running is that of the operator, within its limits. Codes that keep something are measured as they run."""
    for words, dt, right in (("usl", "0.8", None), ("musl drift=0.125 32", "0.5", None), ("usl single", "0.8", 1.2792), ("usl filters 32", "0.8", None)):
        code = ["-program", program("program_steps.py", *words.split()), "-program_set", f"dt={dt}"]
        found = run("spectrum", *code, "-program_run", "1000", ranks=2 if words == "usl" else 1)
        measured = found["measured"]
        check(found["verdict"] == "unstable" and "measured, not proved" in found["evidence"], f"{words}: {found}")
        right = right or run("spectrum", *code)["growth"]
        check(measured["low"] <= right <= measured["high"] < right + 1e-2, f"{words}: {right}, {measured}")
        check(measured["calls"] < 1000, f"{words}: {measured['calls']} calls")
    for words in ("usl", "usl overstress", "usl trips", "usl half"):
        found = run("spectrum", "-program", program("program_steps.py", *words.split()), "-program_run", "1000")
        check(found["verdict"] == "undecided" and found["measured"]["factor"] < 3, f"{words}: {found}")
    code = ["-program", program("program_steps.py", "usl", "leapfrog"), "-program_set", "dt=0.8"]  # its operator is not that of what runs
    check(run("spectrum", *code, "-program_run", "1000")["measured"]["growth"] < 1.16, "a leap-frog is measured")
    said = run("spectrum", "-cells", "8", "-program_run", "100", status=2)
    check("allowed: only with program or plugin" in said, f"a run of a scene: {said}")


CLAMPED = {"clamp": 7, "weak": 16}  # the particles of program_steps.py that are held


def check_faults():
    """Each fault is caught by the certificate that is made for it, and the verdict follows. The reason is named."""
    for fault, certificate, reason, *words in (
            ("stale", "repeat", "besides its state"), ("memory", "repeat", "besides its state"), ("noise", "repeat", "from one time to the next"),
            ("drops", "additivity", "switches near the base state"), ("clamp", "one side", "the base state is on a switch"),
            ("", "reach", "describe more cells", "3"), ("weak", "one side", "the base state is on a switch"), ("mean", "reach", "more cells"),
            ("moves", "equilibrium", "describe one at rest"), ("half", "one side", "viscosity in compression only"),
            ("solver", "two sizes", "give the solver a tolerance"), ("leapfrog", "two steps", "besides its state")):
        task = "spectrum" if fault == "moves" else "symbol"
        found = run(task, "-program", program("program_steps.py", "usl", fault, *words))
        held = {name: one["holds"] for name, one in found["probing"]["certificates"].items()}
        check(not held[certificate], f"{fault or words}: {found['probing']['certificates']}")
        check(found["verdict"] == "undecided", f"{fault or words}: {found['verdict']}, {found['evidence']}")
        check(reason in found["probing"]["what_can_be_done"], f"{fault or words}: {found['probing']['what_can_be_done']}")
        if fault in CLAMPED:
            near(f"both sides of {fault}", *(found["switch"][side] for side in ("one_side", "other_side")), 1e-4)
            check(found["switch"]["particles"] == 1, f"{fault}: {found['switch']}")
            check(found["probing"]["certificates"][certificate]["particle"] == CLAMPED[fault], f"{fault}: {found['probing']}")


def check_strange():
    """Codes whose single steps look well, and are not what their users run: the verdict is not that of another code."""
    for fault, certificate in (("leapfrog", "two steps"), ("overstress", "two steps"), ("trips", "repeat"), ("half", "one side"),
                               ("trips resets", "additivity")):  # what can be undone is seen as the switch that it is
        for task, dt in (("symbol", "0.5"), ("spectrum", "1.1")):
            found = run(task, "-program", program("program_steps.py", "usl", fault), "-program_set", f"dt={dt}")
            fails = [name for name, one in found["probing"]["certificates"].items() if not one["holds"]]
            check(certificate in fails, f"{fault}, {task} {dt}: {found['probing']['certificates']}")
            if fault == "half":
                check(found["switch"] == {"particles": 32}, f"{found['switch']}")
            if fault != "trips resets":
                check(fails == [certificate] or dt != "0.5", f"{fault}, {task}: {fails} fail")
            if dt == "0.5" or certificate in ("two steps", "repeat"):  # growth by 3.6 is more than half a viscosity can make
                check(found["verdict"] == "undecided", f"{fault}, {task} {dt}: {found['verdict']}, {found['evidence']}")
    check_beside()
    found = run("symbol", "-program", program("program_steps.py", "usl", "tears"))
    check(found["verdict"] == "stable" and "two steps" not in found["probing"]["certificates"], f"{found['probing']}")
    check_filters()


def check_beside():
    """Beside a switch: growth on both sides where one particle has it, and a field that leaves it where all have it."""
    sides = run("symbol", "-program", program("program_steps.py", "usl", "clamp"), "-program_set", "dt=0.8")["switch"]
    free = run("spectrum", "-program", program("program_steps.py", "usl"), "-program_set", "dt=0.8")["growth"]
    near("the free side of a clamp", min(abs(sides[side] - free) for side in ("one_side", "other_side")), 0, 1e-6)
    code = ["-program", program("program_steps.py", "usl", "cut"), "-program_set", "dt=0.8"]
    found = run("spectrum", *code)
    check(found["switch"]["field"] == "s" and found["switch"]["amount"] < 0, f"no tension: {found['switch']}")
    check(not found["probing"]["certificates"]["one side"]["holds"], f"no tension: {found['probing']}")
    beside = run("spectrum", *code, "-program_base", f"s={found['switch']['amount']}")
    check(beside["probing"]["certificates"]["one side"]["holds"] and beside["verdict"] == "unstable", f"{beside['probing']}")
    near("growth beside a switch", beside["growth"], found["switch"]["beside"], 1e-6)
    near("growth under a small stress", beside["growth"], free, 1e-2)
    said = run("spectrum", *code, "-program_base", "q=1", status=2)
    check("no such field" in said and said.count("mpmstab:") == 1, f"a field that is not there: {said}")


def check_filters():
    """Every seventh step has a filter S: growth is that of S A^7, by closed form, on any ranks and however steps are counted."""
    run("spectrum", "-formulation", "usl", "-cells", "32", "-courant", "0.8", "-measure", "false", "-write_matrix", "scene.npz")
    A, unit = scipy.sparse.load_npz("scene.npz").toarray(), numpy.eye(64)
    filters = unit + 0.1 * (numpy.roll(unit, 1, 0) - 2 * unit + numpy.roll(unit, -1, 0))
    S = numpy.kron(filters, numpy.diag([1, 0])) + numpy.kron(unit, numpy.diag([0, 1]))
    right = max(abs(numpy.linalg.eigvals(S @ numpy.linalg.matrix_power(A, 7)))) ** (1 / 7)
    check(abs(right - max(abs(numpy.linalg.eigvals(A)))) > 1e-3, f"the filter does not matter: {right}")
    for words, ranks in (("filters", 1), ("filters unsaid", 2), ("afresh", 3), ("filters", 2)):
        asked = ["-program", program("program_steps.py", "usl", words, "32"), "-program_set", "dt=0.8"]
        found = run("spectrum", *asked, *(["-program_period", "7"] if (words, ranks) == ("filters", 2) else []), ranks=ranks)
        check(found["probing"]["steps"] == 7, f"{words}: {found['probing']}")
        check(all(one["holds"] for one in found["probing"]["certificates"].values()), f"{words}: {found['probing']}")
        near(f"growth, {words}, {ranks} ranks", found["growth"], right, 1e-7)
        check(found["verdict"] == "unstable", f"{words}: {found['verdict']}, {found['evidence']}")
    found = run("spectrum", *asked, "-program_period", "5")
    check(not found["probing"]["certificates"]["two steps"]["holds"], f"another period: {found['probing']}")
    check(found["verdict"] == "undecided", f"another period: {found['verdict']}, {found['evidence']}")
    said = run("spectrum", "-cells", "8", "-program_period", "7", status=2)
    check("allowed: only with program or plugin" in said, f"a period of a scene: {said}")


def runs(pid):
    """Whether a process is there, and not only waits for its parent to notice its end."""
    try:
        with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
            return file.read().rpartition(")")[2].split()[0] not in "ZX"
    except FileNotFoundError:
        return False


def check_ended(pids):
    """No child may be left. The kernel ends it a moment after its parent."""
    with open(pids, encoding="utf-8") as file:
        left = [int(line) for line in file]
    for _ in range(200):
        left = [pid for pid in left if runs(pid)]
        if not left:
            return
        time.sleep(0.05)
    check(False, f"{pids}: processes {left} are left")


def check_failures():
    says = {"dies": "has ended with status 5; it wrote: a last word on standard error", "hangs": "has not answered within 1 s",
            "short": "of 32 bytes of its answer 24 came", "nan": "not finite: v of particle 1",
            "more": "unasked", "error": "particle 1 has left", "prints": "does not describe itself", "protocol": "protocol"}
    for how, words in says.items():
        for ranks in (1, 3) if how in ("dies", "nan") else (1,):
            said = run("spectrum", "-program", program("program_fails.py", how, how), "-program_timeout", "1", ranks=ranks, status=2)
            check(words in said and said.count("mpmstab:") == 1, f"{how}, {ranks} ranks: {said}")
            check_ended(how)
    for words, said in ((["-program", "/nonexistent/code"], "No such file or directory; allowed: a program that can be run"), (["-program", "'open"], "quotation mark"),
                        (["-plugin", "/nonexistent.so"], "No such file or directory; allowed: a shared library"),
                        (["-program", program("program_fails.py", "ok", "set"), "-program_set", "dt=2"], "dt is too large"),
                        (["-program", program("program_fails.py", "ok", "set"), "-program_set", "E=2"], "no parameter E; allowed: dt\n"),
                        (["-program", "a", "-courant", "0.5"], "takes the place of a scene"), (["-at", "3"], "only with program")):
        answer = run("spectrum", *words, status=2)
        check(said in answer and answer.count("mpmstab:") == 1, f"{words}: {answer}")
    said = run("critical", "-program", program("program_fails.py", "ok", "set"), "-program_dt", "step", status=2)
    check("-program_dt step: " in said and "allowed: dt\n" in said, f"a time step of another name: {said}")
    for number in (signal.SIGKILL, signal.SIGTERM, signal.SIGINT):
        pids = f"signal{int(number)}"
        if os.path.exists(pids):  # of an earlier run
            os.remove(pids)
        with subprocess.Popen([MPMSTAB, "spectrum", "-program", program("program_fails.py", "hangs", pids)],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as running:
            while not os.path.exists(pids) or not os.path.getsize(pids):
                time.sleep(0.02)
            running.send_signal(number)
        check_ended(pids)


def check_page():
    """The commands of the page do what it says, and critical finds the limits of its table; two have a closed form."""
    page = os.path.join(os.path.dirname(HERE), "..", "examples", "your-code")
    text = text_of(os.path.join(page, "PROGRAM.md"))
    commands = "".join(re.findall(r"```sh\n(.*?)```", text, re.S)).splitlines()
    check(len(commands) == 12, f"the page has {len(commands)} commands")
    *_, found, same, other, grid, drift, mach, ends, inside, ran = (
        run(*shlex.split(command.replace("python3 line.py", f"{sys.executable} {os.path.join(page, 'line.py')}"))[1:])
        for command in commands)
    check(abs(drift["symbol"]["growth"] - 1) < 1e-9 and mach["motion"]["drift"] == 0.1, f"moving: {drift['symbol']}, {mach['motion']}")
    near("growth of the ends", ends["growth"], float(re.search(r"growth of ([0-9.]+) per step", text).group(1)), 5e-6)
    near("limit in motion", inside["critical"]["critical_dt"], float(re.search(r"which is ([0-9.]+) for the interior", text).group(1)), 5e-9)
    check(ran["measured"]["low"] > 1, f"{ran['measured']}")
    check(same["comparison"]["same"], f"{same['comparison']}")
    by = float(re.search(r"`compare: differs in s from s \(by ([0-9.]+)\)`", text).group(1))
    check({(one["to"], one["from"]) for one in other["comparison"]["differences"]} == {("s", "s")}, f"{other['comparison']}")
    near("difference", other["comparison"]["differences"][0]["difference"], by, 1e-9)
    check(other["comparison"]["same_as"] == [f"formulation=usl,transfer=flip,basis={basis}" for basis in ("linear", "gimp")],
          f"{other['comparison']['same_as']}")
    check(f"growth at {grid['map']['unstable']} of these 25 points" in text, f"{grid['map']['unstable']} points grow")
    limits = found["critical"]["limits"]
    table = dict(re.findall(r"^\| (interior|free block|lone particle):.*\| ([0-9.]+) \|$", text, re.M))
    for name, limit in table.items():
        near(name, limits[name.replace("free ", "").replace(" ", "_")], float(limit), 1e-9)
    near("interior", limits["interior"] * 20 / 0.01, (4 / 7)**0.5, 2e-6)
    near("lone particle", limits["lone_particle"] * 20 / 0.01, (3 / 8)**0.5, 2e-6)
    check(found["critical"]["critical_dt"] == min(limits.values()), f"{found['critical']}")
    share = float(re.search(r"dt is ([0-9.]+)% of what is stable", text).group(1))
    near("share", 100 * found["critical"]["given_dt"] / found["critical"]["critical_dt"], share, 0.005)


def check_map():
    """A code with stiffness E and step dt is the scene of Courant number sqrt(E) dt, at each point and on any ranks."""
    steps = ["-program", program("program_steps.py", "usl")]
    axes = ["-map_axes", "dt,E", "-map_dt", "0.4,0.8", "-map_E", "0.5,2", "-map_points", "3,4"]
    texts = []
    for ranks in (1, 3):
        found = run("map", *steps, *axes, "-csv", "map.csv", "-output", "map.h5", ranks=ranks)
        texts.append(text_of("map.csv"))
    rows = list(csv.DictReader(texts[0].splitlines()))
    for dt, E in {(float(row["dt"]), float(row["E"])) for row in rows[::6]}:
        right = run("symbol", "-formulation", "usl", "-cells", "64", "-courant", repr(E**0.5 * dt))
        row = next(one for one in rows if (float(one["dt"]), float(one["E"])) == (dt, E))
        near(f"dt {dt}, E {E}", float(row["growth"]), right["symbol"]["growth"], 1e-9)
        check(row["verdict"] == right["verdict"] and row["fails"] == "", f"{row}, {right['verdict']}")
    check(len(rows) == 12 and found["map"]["axes"] == ["dt", "E"], f"{found['map']}")
    check(found["map"]["unstable"] == sum(row["verdict"] == "unstable" for row in rows) == 4, f"{found['map']}")
    for other in texts[1:]:
        for one, two in zip(rows, csv.DictReader(other.splitlines())):
            near("growth on more ranks", float(one["growth"]), float(two["growth"]), 1e-9)
    with h5py.File("map.h5") as file:
        growth = numpy.array(file["map/growth"]).ravel()
    near("growth in HDF5", abs(growth - [float(row["growth"]) for row in csv.DictReader(texts[-1].splitlines())]).max(), 0, 0)
    bad = ["-program", program("program_steps.py", "usl", "drops"), *axes[:-1], "2,2"]
    found = run("map", *bad, "-csv", "map.csv")
    verdicts = [(row["verdict"], row["fails"]) for row in csv.DictReader(text_of("map.csv").splitlines())]
    check(verdicts == 3 * [("undecided", "additivity")] + [("unstable", "additivity")], f"{verdicts}")
    check(found["map"]["undecided"] == 3, f"{found['map']}")
    with open("code.yaml", "w", encoding="utf-8") as scene:
        scene.write(f"program: {steps[1]}\n")
    check(run("map", "code.yaml", "-trust_scene", *axes[:-1], "2,2")["map"]["unstable"] == 1, "a map of a code that a file names")
    particles = run("map", *steps, *axes[:-1], "2,2", "-probe", "coloured")["map"]
    check("phases" not in particles and particles["unstable"] == 1, f"{particles}")
    for words, said in ((["dt,F", "-map_dt", "1,2", "-map_F", "1,2"], "no such parameter; allowed: dt, E"),
                        (["dt,E", "-map_dt", "1,2"], "with -map_E lo,hi"), (["dt,dt", "-map_dt", "1,2"], "two different"),
                        (["dt,growth", "-map_dt", "1,2", "-map_growth", "1,2"], "cannot hold"),
                        (["dt,E", "-map_dt", "2,1", "-map_E", "1,2"], "lo < hi"),
                        (["dt,E", "-map_dt", "1,2", "-map_E", "1,2", "-map_drift", "0,1"], "does not name it"),
                        (["dt,E", "-map_dt", "1,2", "-map_E", "1,2", "-probe", "coloured", "-phases", "8"], "has no phases")):
        answer = run("map", *steps, "-map_axes", *words, status=2)
        check(said in answer and answer.count("mpmstab:") == 1, f"{words}: {answer}")


def check_free():
    """The step of an implicit code: its eigenvalues are numpy's. Products alone cannot show that it is stable."""
    for theta, words, ranks in ((0.45, [], (1, 3)), (0.45, ["place"], (1,)), (0.5, [], (1,))):
        left, right = program_implicit.matrices(20, theta, 0.5)
        known = numpy.linalg.eigvals(numpy.linalg.solve(left, right))
        asked = ["-program", program("program_implicit.py", "20", str(theta), *words)]
        for on in ranks:
            found = run("spectrum", *asked, "-csv", "ring.csv", ranks=on)
            values = numpy.loadtxt("ring.csv", delimiter=",", skiprows=1)[:, 1:3] @ [1, 1j]
            check(len(values) == len(known) and found["probing"]["probing"] == "matrix_free", f"{found['probing']}")
            distance = abs(values[:, None] - known)
            near(f"theta {theta}, {on} ranks", max(distance.min(0).max(), distance.min(1).max()), 0, 1e-7)  # a defective pair at 1
            check(found["verdict"] == ("stable" if theta == 0.5 else "unstable"), f"{theta}: {found['verdict']}")
        near("growth", found["growth"], abs(known).max(), 1e-8 if theta == 0.5 else 1e-12)
        left, right = program_implicit.matrices(40, theta, 0.5)
        known = numpy.linalg.eigvals(numpy.linalg.solve(left, right))
        for on in ranks[::2] if not words else ():  # too many unknowns for the solver to find all
            large = ["-program", program("program_implicit.py", "40", str(theta))]
            krylov = run("spectrum", *large, "-tolerance", "1e-4", "-eps_type", "krylovschur", "-output", "ring.h5", ranks=on)
            near("growth by products", krylov["growth"], abs(known).max(), 1e-8)
            check(krylov["verdict"] == ("undecided" if theta == 0.5 else "unstable"), f"{theta}: {krylov['verdict']}")
            check("nonzeros" not in krylov["spectrum"] and "reach" not in krylov["probing"]["certificates"], f"{krylov}")
    found = run("critical", *asked)
    check(found["verdict"] == "stable" and "critical_dt" not in found["critical"], f"of Crank and Nicolson: {found}")
    for words, said in ((["spectrum", "-powers", "8"], "-powers: it needs the matrix"), (["symbol"], "has no symbol"),
                        (["symbol", "-probe", "matrix_free"], "allowed: bloch")):
        answer = run(words[0], *asked, *words[1:], *(["-eps_type", "krylovschur"] if words[0] == "spectrum" else []), status=2)
        check(said in answer and answer.count("mpmstab:") == 1, f"{words}: {answer}")


def in_form(blocks, **form):
    """The command of a code whose step is given by blocks, in a form of its own."""
    return f"{program('program_blocks.py', blocks)} {shlex.quote(json.dumps(form))}"


def check_compare():
    """A code of our own schemes is the same as they are, in whatever units and order it keeps its numbers."""
    bar = ["-program", program("program_steps.py", "usl"), "-program_set", "dt=0.25,E=4"]
    for task, ranks, *words in (("symbol", 1), ("symbol", 2), ("spectrum", 3), ("spectrum", 1, "-probe", "coloured")):
        found = run(task, *bar, *words, "-compare", "formulation=usl,young=4,density=1", ranks=ranks)["comparison"]
        check(found["same"] and found["difference"] < 1e-11 and found["courant"] == 0.5, f"{task}: {found}")
        check(("symbol -compare does the same with 24 calls" in run.said) == bool(words), f"{task}: {run.said}")
        near("factor", abs(found["fields"][1]["factor"]), 2, 1e-9)  # stress over velocity is 2 c of ours
    found = run("symbol", *bar, "-compare", "formulation=musl,courant=0.5")["comparison"]
    check(not found["same"] and "formulation=usl,transfer=flip,basis=linear" in found["same_as"], f"{found}")
    check({(one["to"], one["from"]) for one in found["differences"]} == {("s", "s")}, f"{found['differences']}")
    near("largest difference", found["differences"][0]["difference"], 0.890625 - 0.75, 1e-9)
    moving = ["-program", program("program_steps.py", "musl", "drift=0.125", "32")]
    found = run("symbol", *moving, "-compare", "formulation=musl,wave_speed=1")
    check(found["comparison"]["same"] and found["comparison"]["difference"] < 1e-8, f"moving: {found['comparison']}")
    near("growth of both", found["comparison"]["growth"], found["comparison"]["code_growth"], 1e-8)
    check_compare_plane()
    for text, said in (("formulation=usl", "how far waves go"), ("usl", "keys of a scene"), ("formulation=foo,courant=1", "-compare:1: formulation: foo: allowed: gas1"),
                       ("formulation=usl,courant=0.5,ppc=1", "are not where"), ("formulation=usl,courant=0.5,drift=1/2", "of 2"),
                       ("formulation=usl,courant=0.5,boundary=fixed,free", "boundary fixed,free")):
        for task in ("symbol", "spectrum"):
            answer = run(task, *bar, "-compare", text, status=2)
            check(said in answer and answer.count("mpmstab:") == 1, f"{text}: {answer}")
            check(not run.said, f"{task}, {text}: refused after the code was probed: {run.said}")


def check_compare_plane():
    """In the plane a code keeps stresses with the diagonal first, and the affine part by columns, in units of its own."""
    scheme = "formulation=usl,transfer=apic,courant=0.5,poisson=0.2"
    run("symbol", "-dim", "2", "-cells", "8", "-ppc", "2,1", *(f"-{word}" if i == 0 else word for pair in scheme.split(",")
                                                for i, word in enumerate(pair.split("="))), "-write_blocks", "plane.npz")
    fields = [["stress", [[2, -1e6], [4, -1e6], [3, -1e6]]], ["C", [[5, 40], [7, 40], [6, 40], [8, 40]]], ["v", [[0, 3], [1, 3]]]]
    form = {"cells": 5, "ppc": [2, 1], "fields": fields}
    found = run("symbol", "-program", in_form("plane.npz", **form), "-compare", scheme)["comparison"]
    check(found["same"] and found["difference"] < 1e-10, f"plane: {found}")
    check([(one["ours"], one["yours"]) for one in found["fields"]] == [("v", "v"), ("s", "stress"), ("c", "C")], f"{found['fields']}")
    near("sign of the stress", numpy.sign(found["fields"][1]["factor"]), -1)
    with numpy.load("plane.npz") as file:  # at d = 0, what v_x of the first particle gives to c_xx of it
        here = int(numpy.flatnonzero((file["d"] == 0).all(1))[0])
    found = run("symbol", "-program", in_form("plane.npz", **form, wrong=[here, 5, 0, 0.01]), "-compare", scheme)["comparison"]
    check(not found["same"] and not found["same_as"], f"wrong: {found['difference']}, {found['same_as']}")
    most = found["differences"][0]
    check((most["to"], most["from"], most["d"]) == ("c", "v", [0, 0]) and len(found["differences"]) == 1, f"{found['differences']}")
    near("difference", most["difference"], 0.01, 1e-4)
    found = run("symbol", "-program", in_form("plane.npz", **form), "-compare", scheme.replace("apic", "flip"))["comparison"]
    check(not found["same"] and "C (4)" in found["why_not"], f"without the affine part: {found}")
    check("formulation=usl,transfer=apic,basis=linear" in found["same_as"], f"{found['same_as']}")


def check_asked():
    """What can be asked of an operator is answered for a code as for the scene that it is, on 1, 2 and 3 ranks."""
    ask = ["-powers", "40", "-pseudospectrum", "5", "-modes", "3"]
    right = run("spectrum", "-formulation", "usl", "-cells", "16", "-courant", "0.8", "-measure", "false", *ask, "-output", "scene.h5",
                "-write_matrix", "scene.npz")
    one = blocks_of("-formulation", "usl", "-cells", "16", "-courant", "0.8")
    for ranks in (1, 3):
        code = ["-program", program("program_steps.py", "usl"), "-program_set", "dt=0.8"]
        found = run("spectrum", *code, *ask, "-output", "code.h5", "-write_matrix", "code.npz", ranks=ranks)
        near("matrix", abs(scipy.sparse.load_npz("code.npz") - scipy.sparse.load_npz("scene.npz")).max(), 0)
        with h5py.File("scene.h5") as scene, h5py.File("code.h5") as file:
            for name in ("transient/steps", "transient/norm", "pseudospectrum/re", "pseudospectrum/sigma"):
                near(f"{name}, {ranks} ranks", (abs(file[name][:] - scene[name][:]) / abs(scene[name][:]).max()).max(), 0, 1e-8)
            values, known = (part["spectrum/eigenvalues"][:] @ [1, 1j] for part in (file, scene))
            near(f"eigenvalues, {ranks} ranks", abs(values[:, None] - known).min(1).max(), 0, 1e-7)
            check(len(file["modes"]) == 3, f"modes: {list(file['modes'])}")
            for mode, value in zip(file["modes"].values(), values):
                x = mode["vector_re"][:] + 1j * mode["vector_im"][:]
                near("mode", abs(scipy.sparse.load_npz("code.npz") @ x - value * x).max(), 0, 1e-8)
        for name in ("transient", "pseudospectrum"):
            check(set(found[name]) == set(right[name]), f"{name}: {found[name]}")
    for d, A in blocks_of(*code, ranks=3).items():
        near(f"block {d}", abs(A - one[d]).max(), 0)


{"page": check_page, "scenes": check_scenes, "map": check_map, "free": check_free, "compare": check_compare, "moving": check_moving, "run": check_run, "asked": check_asked, "steps": check_steps, "mls": check_mls, "calls": check_calls, "faults": check_faults, "strange": check_strange, "failures": check_failures}[sys.argv[1]]()
