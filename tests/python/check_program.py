#!/usr/bin/python3
"""Checks -program against scenes of the same schemes, and that what is wrong with a code is noticed.

check_program.py PART MPIEXEC MPMSTAB, in a folder that may be filled. PART: steps, mls, faults, failures or page. Silent when all is
well.
"""
import os
import re
import shlex
import signal
import subprocess
import sys
import time

import numpy
import scipy.sparse

from checks import check, loaded, text_of

HERE = os.path.dirname(os.path.abspath(__file__))
MPIEXEC, MPMSTAB = sys.argv[2:4]


def program(name, *words):
    return " ".join([sys.executable, os.path.join(HERE, name), *words])


def run(*words, ranks=1, status=0):
    """Runs mpmstab. Returns its JSON, or what it says on standard error if it must fail."""
    launch = [MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
    done = subprocess.run([*launch, MPMSTAB, *words, "-json", "out.json"], capture_output=True, text=True, check=False)
    check(done.returncode == status, f"{words}: status {done.returncode}, {done.stdout[-600:]} {done.stderr}")
    return loaded("out.json") if status == 0 else done.stderr


def near(what, one, other, within=1e-9):
    check(abs(one - other) <= within, f"{what}: {one!r} and {other!r}")


def check_operator(scheme):
    """The operator of the code is that of the scene: both have v and s of a particle, then those of the next one."""
    scene = ["-formulation", scheme, "-cells", "16", "-courant", "0.5"]
    run("spectrum", *scene, "-measure", "false", "-write_matrix", "scene.npz")
    right = scipy.sparse.load_npz("scene.npz").toarray()
    for ranks in (1, 2, 3) if scheme == "usl" else (1,):
        found = run("spectrum", "-program", program("program_steps.py", scheme), "-write_matrix", "code.npz", ranks=ranks)
        check(found["probing"]["set_apart"] == [0], f"set apart: {found['probing']['set_apart']}")
        near(f"{scheme}, {ranks} ranks",
             abs(scipy.sparse.load_npz("code.npz").toarray() - right).max(), 0)


def blocks_of(*words):
    """The blocks A_d that symbol writes, by d."""
    run("symbol", *words, "-write_blocks", "blocks.npz")
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
        for ranks in (1, 2):
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


def check_mls():
    """A fluid on splines in two dimensions has the symbol of our scene, and critical finds the limits of its kind."""
    scene = ["-formulation", "usl", "-transfer", "apic", "-gradient", "mls", "-basis", "quadratic"]
    right = run("symbol", *scene, "-dim", "2", "-poisson", "0.5", "-cells", "8", "-courant", "1.4", "-phases", "8")
    for words, within in ((["2", "8"], 1e-9), (["2", "7", "free"], 1e-9), (["2", "8", "single"], 1e-5)):
        for ranks in (1, 2, 3) if words == ["2", "8"] else (1,):
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
    near("lone particle", found["limits"]["lone_particle"], 1, 2e-6)  # LIMITS.md
    near("critical", found["critical_dt"], min(found["limits"].values()), 0)
    check(found["evaluations"] <= 60, f"{found['evaluations']} operators")
    check([one["share"] for one in found["carriers"]] == [1], f"carriers: {found['carriers']}")
    lone = found["carriers"][0]["place"][0] % 1
    check(lone in (0.25, 0.75), f"the lone particle is at {lone}")


CLAMPED = {"clamp": 7, "weak": 16}  # the particles of program_steps.py that are held


def check_faults():
    """Each fault is caught by the certificate that is made for it, and the verdict follows."""
    for fault, certificate, words in (("stale", "repeat", []), ("memory", "repeat", []), ("noise", "repeat", []),
                                      ("drops", "additivity", []), ("clamp", "one side", []), ("", "reach", ["3"]),
                                      ("weak", "one side", []), ("mean", "reach", []), ("moves", "equilibrium", [])):
        task = "spectrum" if fault == "moves" else "symbol"
        found = run(task, "-program", program("program_steps.py", "usl", fault, *words))
        held = {name: one["holds"] for name, one in found["probing"]["certificates"].items()}
        check(not held[certificate], f"{fault or words}: {found['probing']['certificates']}")
        check(found["verdict"] == "undecided", f"{fault or words}: {found['verdict']}, {found['evidence']}")
        if certificate == "one side":
            check(found["probing"]["certificates"][certificate]["particle"] == CLAMPED[fault], f"{fault}: {found['probing']}")


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
        for ranks in (1, 2, 3) if how in ("dies", "nan") else (1,):
            said = run("spectrum", "-program", program("program_fails.py", how, how), "-program_timeout", "1", ranks=ranks, status=2)
            check(words in said and said.count("mpmstab:") == 1, f"{how}, {ranks} ranks: {said}")
            check_ended(how)
    for words, said in ((["-program", "/nonexistent/code"], "No such file or directory"), (["-program", "'open"], "quotation mark"),
                        (["-plugin", "/nonexistent.so"], "cannot be loaded"),
                        (["-program", program("program_fails.py", "ok", "set"), "-program_set", "dt=2"], "dt is too large"),
                        (["-program", program("program_fails.py", "ok", "set"), "-program_set", "E=2"], "no parameter E"),
                        (["-program", "a", "-courant", "0.5"], "takes the place of a scene"), (["-at", "3"], "only with program")):
        answer = run("spectrum", *words, status=2)
        check(said in answer and answer.count("mpmstab:") == 1, f"{words}: {answer}")
    for number in (signal.SIGKILL, signal.SIGTERM, signal.SIGINT):
        pids = f"signal{int(number)}"
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
    commands = re.search(r"```sh\n(.*?)```", text, re.S).group(1).splitlines()
    check(len(commands) == 4, f"the page has {len(commands)} commands")
    for command in commands:
        words = shlex.split(command.replace("python3 line.py", f"{sys.executable} {os.path.join(page, 'line.py')}"))
        found = run(*words[1:])
    limits = found["critical"]["limits"]
    table = dict(re.findall(r"^\| (interior|free block|lone particle):.*\| ([0-9.]+) \|$", text, re.M))
    for name, limit in table.items():
        near(name, limits[name.replace("free ", "").replace(" ", "_")], float(limit), 1e-9)
    near("interior", limits["interior"] * 20 / 0.01, (4 / 7)**0.5, 2e-6)
    near("lone particle", limits["lone_particle"] * 20 / 0.01, (3 / 8)**0.5, 2e-6)
    check(found["critical"]["critical_dt"] == min(limits.values()), f"{found['critical']}")
    share = float(re.search(r"dt is ([0-9.]+)% of what is stable", text).group(1))
    near("share", 100 * found["critical"]["given_dt"] / found["critical"]["critical_dt"], share, 0.005)


{"page": check_page, "steps": check_steps, "mls": check_mls, "faults": check_faults, "failures": check_failures}[sys.argv[1]]()
