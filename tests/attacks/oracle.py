"""What every attack is judged by: how the program ends, what it says and what it leaves."""
import collections
import contextlib
import json
import os
import re
import resource
import signal
import subprocess

DONE, FAILED, REFUSED, MISSED = range(4)
TRACES = ("PETSC ERROR", "Traceback", "Segmentation", "MPI_ABORT", "buffer overflow", "Open MPI", "ORTE", "HDF5-DIAG",
          "terminate called", "Sanitizer", "BLAS", "malloc")
NO_NUMBER = re.compile(r"(?<![\w.])[-+]?(nan|inf)(?![\w.])")
MPIRUN = "[warn] Epoll"  # what mpirun itself may say when it ends the ranks
SECONDS = 60  # a task of an attack takes a few


class Finding(Exception):
    """Something that an attack has brought to light."""


def require(condition, message):
    if not condition:
        raise Finding(message)


class Done:
    """How a program has ended; status None: it had to be ended."""

    def __init__(self, words, status, out, err):
        self.words, self.status, self.out = words, status, out
        self.err = "".join(line for line in err.splitlines(True) if not line.startswith(MPIRUN))

    def __str__(self):
        words = " ".join(repr(word) if re.search(r"[^\w./,=:-]", word) or not word else word for word in self.words)
        return f"{words[-1500:]}\n  status {self.status}\n  stderr: {self.err[-800:]}\n  stdout: {self.out[-400:]}"


def before(limits):
    """What the new process does first. A shell's background jobs would ignore SIGINT and SIGQUIT until it handles them."""
    def limit():
        for number in (signal.SIGINT, signal.SIGQUIT):
            signal.signal(number, signal.SIG_DFL)
        for which, size in limits.items():
            resource.setrlimit(which, (size, size))
    return limit


class Program:
    """Runs mpmstab and the scripts in the current folder."""

    def __init__(self, mpiexec, path):
        self.mpiexec, self.path = mpiexec, path
        self.ended = collections.Counter()  # by status

    def command(self, words, ranks=1):
        return [*([self.mpiexec, "-q", "-n", str(ranks)] if ranks > 1 else []), self.path, *words]

    def start(self, command, limits=None, **how):
        """Starts a command in a session of its own, so that all its processes can be ended."""
        return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                start_new_session=True, preexec_fn=before(limits or {}), **how)

    def finish(self, process, seconds=SECONDS):
        try:
            out, err = process.communicate(timeout=seconds)
            status = process.returncode
        except subprocess.TimeoutExpired:
            end_session(process)
            out, err = process.communicate()
            status = None
        self.ended[status] += 1
        return Done(process.args, status, out.decode(errors="replace"), err.decode(errors="replace"))

    def run(self, words, ranks=1, limits=None, **how):
        return self.finish(self.start(self.command(words, ranks), limits, **how))

    def script(self, command):
        return self.finish(self.start(command))


def end_session(process):
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)


def judge(done, allowed=(DONE, REFUSED, MISSED), name="mpmstab"):
    """Raises a Finding unless the program has ended as it should: in time, with one clear message where it refuses."""
    said = done.err.splitlines()
    require(done.status is not None, f"it does not end:\n  {done}")
    require(done.status in allowed, f"status {done.status} is not one of {allowed}:\n  {done}")
    for trace in TRACES:
        require(trace not in done.err, f"'{trace}' on standard error:\n  {done}")
    if done.status == DONE:
        require(not said, f"words on standard error though all went well:\n  {done}")
    elif done.status == MISSED:
        require(said and all(line.startswith(f"{name}: expected ") for line in said), f"other words:\n  {done}")
    else:
        require(len(said) == 1 and said[0].startswith(f"{name}: ") and len(said[0]) > len(name) + 10,
                f"not one clear message:\n  {done}")
    require(done.status == REFUSED or not NO_NUMBER.search(done.out), f"a number that was not computed:\n  {done}")
    return done


def result(path):
    """The JSON of a task, in which every number is one."""
    def no_number(word):
        raise Finding(f"{path} has {word}")
    with open(path, encoding="utf-8") as file:
        return json.load(file, parse_constant=no_number)


class Beside:
    """Sees to it that a program leaves no files but those it was asked for, and changes none that it was not to."""

    def __init__(self):
        self.before = contents()

    def check(self, done, asked):
        after = contents()
        for name in sorted(after.keys() | self.before.keys()):
            if name in asked and (done.status != REFUSED or "its files are written" in done.err):
                continue
            require(name in after, f"{name} is gone:\n  {done}")
            require(name in self.before, f"{name} is left beside:\n  {done}")
            require(after[name] == self.before[name], f"{name} has changed:\n  {done}")


def contents():
    """The names in this folder, with the bytes of regular files and where links lead."""
    found = {}
    for entry in os.scandir("."):
        if entry.is_symlink():
            found[entry.name] = os.readlink(entry.name)
        elif entry.is_file(follow_symlinks=False):
            with open(entry.name, "rb") as file:
                found[entry.name] = file.read()
        else:
            found[entry.name] = entry.stat(follow_symlinks=False).st_mode
    return found
