"""Attacks by signals at random moments: what is left behind, and whether the run resumes to the last bit."""
import os
import signal
import time

from oracle import DONE, REFUSED, Finding, end_session, judge, require, result

FILES = "-output out.h5 -csv out.csv -json out.json -checkpoint c.h5".split()
OUTPUTS = ("out.h5", "out.xmf", "out.csv", "out.json", "c.h5")
SIGNALS = {"SIGKILL": signal.SIGKILL, "SIGTERM": signal.SIGTERM, "SIGINT": signal.SIGINT}
SCENES = ("-formulation gas2 -cells 400 -courant 0.2 -drift 0.3 -jitter 0.5",
          "-formulation usl -cells 300 -ppc 3 -drift 1/7",
          "-formulation musl -cells 200 -basis quadratic -boundary fixed,free -courant 0.3",
          "-kinematics finite -formulation usl -material neo -basis quadratic -courant auto -cells 200 -initial random "
          "-amplitude 1e-6", "-kinematics finite -formulation musl -transfer apic -basis cubic -dim 2 -cells 12 "
          "-initial random -amplitude 1e-6 -courant 0.4",
          "-formulation gas1 -cells 300 -initial random", "-formulation usavg -transfer xpic -cells 200 -jitter 0.2")
LONG = ("run -cells 300 -steps 100000000 -output o.h5 -csv o.csv -json o.json",
        "map -map_points 300,300 -csv o.csv -output o.h5", "symbol -cells 100000 -csv o.csv -output o.h5",
        "ensemble -jitter 0.4 -layouts 10000 -csv o.csv", "spectrum -cells 400 -jitter 0.3 -output o.h5")
TRIAL, WITHIN = 2000, 60


def children(process):
    """The processes that march: those that mpirun has started, or the process itself."""
    try:
        with open(f"/proc/{process.pid}/task/{process.pid}/children", encoding="ascii") as file:
            return [int(pid) for pid in file.read().split()] or [process.pid]
    except OSError:
        return [process.pid]


def is_alive(pid):
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii") as file:
            return file.read().rpartition(")")[2].split()[0] not in "ZX"
    except OSError:
        return False


def hdf5(name):
    """All datasets of a file, as bytes by their paths."""
    import h5py  # only here: an attack without it can still be run
    found = {}
    with h5py.File(name, "r") as file:
        file.visititems(lambda path, item: found.update({path: item[()].tobytes()}) if hasattr(item, "shape") else None)
    return found


def outcome():
    """What a run has found and written, without its times and what it counts since it was resumed."""
    found = result("out.json")
    run = {key: value for key, value in found["run"].items() if not key.endswith(("_s", "_step", "_change"))}
    with open("out.csv", encoding="ascii") as file:
        rows = file.read()
    return {"json": (run, found["verdict"], found.get("growth")), "csv": rows, "output": hdf5("out.h5"),
            "checkpoint": hdf5("c.h5")}


def compare(whole, parts, done):
    """All is the same to the last bit, but a resumed run's output begins with the step at which it was resumed."""
    for what in ("json", "csv", "checkpoint"):
        require(whole[what] == parts[what], f"another {what} after it was resumed:\n  {done}")
    require(parts["output"], f"an empty output:\n  {done}")
    first, last = min(parts["output"]).split("/")[0], max(whole["output"]).split("/")[0]
    for path, values in whole["output"].items():
        require(path < first or parts["output"].get(path) == values, f"another {path} after it was resumed:\n  {done}")
    more = [path for path in parts["output"] if path not in whole["output"] and not path.startswith(first)]
    require(not more, f"the output has more, {more}:\n  {done}")
    with open("out.xmf", encoding="ascii") as file:
        require(last in file.read(), f"out.xmf does not have the last step:\n  {done}")


def remove_outputs():
    for name in OUTPUTS:
        if os.path.exists(name):
            os.remove(name)


def steps_for(program, scene, ranks, seconds):
    """So many steps that a run, which asks all ranks for signals at each, takes about this long on this machine."""
    judge(program.run([*scene, "-steps", str(TRIAL), "-json", "out.json", "-checkpoint", "c.h5"], ranks), [DONE])
    steps = max(TRIAL, int(TRIAL * seconds / max(result("out.json")["run"]["loop_s"], 1e-3)))
    remove_outputs()
    return steps


def has_begun(process):
    """Whether the run has opened its files. On a signal before all ranks have started Open MPI's mpirun may hang."""
    marching = children(process)
    return any(f"-{pid}-" in name for name in os.listdir(".") for pid in marching)


def send(dice, process, name):
    """Sends a signal to mpirun or, when it is SIGKILL, perhaps to one rank alone. Returns the processes that march."""
    marching = children(process)
    victim = dice.choice([process.pid, *marching]) if name == "SIGKILL" else process.pid
    try:
        os.kill(victim, SIGNALS[name])
    except ProcessLookupError:
        pass
    return marching


def wait_for_end(process, marching, program):
    """What was killed ends soon, with all its ranks."""
    done = program.finish(process, WITHIN)
    end = time.monotonic() + WITHIN
    while any(is_alive(pid) for pid in marching if pid != process.pid):
        if time.monotonic() > end:
            end_session(process)
            raise Finding(f"ranks march on without mpirun:\n  {done}")
        time.sleep(0.02)
    require(done.status is not None, f"it does not end after the signal:\n  {done}")
    require("PETSC" not in done.err and "Traceback" not in done.err, f"a trace after a signal:\n  {done}")
    return done


def one_kill(dice, program, words, ranks, name, seconds):
    """Starts or resumes the run and ends it after so many seconds. Returns whether it was not done by then."""
    restart = ["-restart", "c.h5"] if os.path.exists("c.h5") else []
    process = program.start(program.command([*words, *restart], ranks))
    while ranks > 1 and process.poll() is None and not has_begun(process):
        time.sleep(0.005)
    end = time.monotonic() + seconds
    while time.monotonic() < end and process.poll() is None:
        time.sleep(0.002)
    if process.poll() is not None:
        judge(program.finish(process), [DONE])
        return False
    marching = send(dice, process, name)
    done = wait_for_end(process, marching, program)
    left = [entry for entry in os.listdir(".") if f"-{process.pid}-" in entry]  # others are of those killed before
    require(name == "SIGKILL" or ranks > 1 or not left, f"{name} leaves {left}:\n  {done}")
    if ranks == 1 and done.status != 0:  # with a checkpoint it is asked for first, when the run marches; else it just ends
        require(done.status in (143, -SIGNALS[name]), f"status {done.status} after {name}:\n  {done}")
    return True


def kill_often(dice, program, ranks, times, seconds, names=tuple(SIGNALS)):
    """Kills a run of about so many seconds so many times. Returns how often it was killed before it was done."""
    scene = ["run", *dice.choice(SCENES).split()]
    steps = steps_for(program, scene, ranks, seconds)
    words = [*scene, "-steps", str(steps), "-output_every", str(steps // 8), "-checkpoint_every", str(max(steps // 60, 1)),
             *FILES]
    judge(program.run(words, ranks), [DONE])
    whole = outcome()
    remove_outputs()
    kills = 0
    for _ in range(times):
        after = dice.uniform(0, 0.06 + 0.8 * seconds / times)  # one rank takes 0.06 s to start
        if not one_kill(dice, program, words, ranks, dice.choice(names), after):
            break
        kills += 1
    restart = ["-restart", "c.h5"] if os.path.exists("c.h5") else []
    done = judge(program.run([*words, *restart], ranks), [DONE])
    compare(whole, outcome(), done)
    left = sorted(set(os.listdir(".")) - set(OUTPUTS))
    require(not left, f"left beside a finished run: {left}\n  {done}")
    return kills


def attack_kills(dice, program):
    ranks, times = dice.choice((1, 1, 2)), dice.choice((1, 2, 3))
    kill_often(dice, program, ranks, times, 0.5 + 0.3 * times)


def attack_end(dice, program):
    """A signal in a task without a checkpoint: nothing is left but what was there."""
    words = dice.choice(LONG).split()
    ranks, name = dice.choice((1, 1, 2)), dice.choice(("SIGTERM", "SIGINT", "SIGQUIT"))
    process = program.start(program.command(words, ranks))
    while ranks > 1 and process.poll() is None and len(children(process)) < ranks:
        time.sleep(0.005)
    time.sleep(0.3 * (ranks > 1) + dice.uniform(0, 0.5))
    marching = children(process)
    try:
        os.kill(process.pid if name != "SIGQUIT" else dice.choice(marching), getattr(signal, name))
    except ProcessLookupError:
        pass
    done = wait_for_end(process, marching, program)
    require(done.status != REFUSED, f"no such status:\n  {done}")
    left = os.listdir(".")  # a file that was whole before the signal came has its name
    require(ranks > 1 or not [entry for entry in left if entry not in ("o.csv", "o.h5", "o.xmf", "o.json")],
            f"left behind: {left}\n  {done}")


ATTACKS = {"kills": attack_kills, "ends": attack_end}
