"""Runs short commands of mpmstab without loading its libraries for each: see forks.c.

run() takes the place of subprocess.run. What forks.c cannot do (ranks, other programs, limits of a process, a build that
has no such program) subprocess.run does.
"""
import atexit
import contextlib
import json
import os
import select
import subprocess
import sys
import tempfile
import threading

KNOWN = {"cwd", "capture_output", "stdout", "stderr", "text", "check", "timeout", "errors", "stdin", "env"}
LOADED = ("LD_", "OMP_", "OPENBLAS_")  # variables that count when libraries are loaded
_own = threading.local()  # a thread has a waiting program of its own


class Waiting:
    """A program that waits for commands, and the folder of what they say."""

    def __init__(self, path):
        self.path, self.environment, self.folder = path, dict(os.environ), tempfile.TemporaryDirectory()
        self.count = 0
        self.process = subprocess.Popen([path], stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0)
        atexit.register(self.end)

    def end(self):
        self.process.stdin.close()
        self.process.wait()
        self.process.stdout.close()
        self.folder.cleanup()

    def run(self, words, cwd, environment, timeout):
        """Returns the status, as subprocess gives it, the processor time in seconds, and what the command wrote, as bytes."""
        self.count += 1  # what outlives a command does not write into what the next one says
        out, err = (os.path.join(self.folder.name, f"{name}.{self.count}") for name in ("out", "err"))
        changed = {name: environment.get(name) for name in {*environment, *self.environment}
                   if environment.get(name) != self.environment.get(name)}
        request = {"folder": os.path.abspath(cwd or "."), "out": out, "err": err, "words": words, "environment": changed}
        self.process.stdin.write(json.dumps(request).encode() + b"\n")
        child = int(self.process.stdout.readline().split()[0])
        late = not select.select([self.process.stdout], [], [], timeout)[0]
        if late:
            with contextlib.suppress(ProcessLookupError):  # the command ends just now
                os.kill(child, 9)
        status, time = map(int, self.process.stdout.readline().split())
        if late:
            raise subprocess.TimeoutExpired(words, timeout)
        said = []
        for path in (out, err):
            with open(path, "rb") as file:
                said.append(file.read())
            os.remove(path)
        return os.waitstatus_to_exitcode(status), time / 1000, *said


def program_of(words, how):
    """The program that waits beside mpmstab in its build folder, or None where it cannot run these words."""
    folder, name = os.path.split(words[0])
    path = os.path.join(os.path.abspath(folder), "tests", "mpmstab_forks")
    files = {how.get("stdout", subprocess.PIPE), how.get("stderr", subprocess.PIPE), how.get("stdin", subprocess.DEVNULL)}
    environment = os.environ if how.get("env") is None else how["env"]
    started = _own.waiting.environment if getattr(_own, "waiting", None) else os.environ
    texts = [*words, *environment.values()]
    if (name != "mpmstab" or len(words) == 1 or set(how) - KNOWN or files - {subprocess.PIPE, subprocess.DEVNULL}
            or any("\0" in text or not text.isprintable() and text != text.encode(errors="ignore").decode() for text in texts)):
        return None
    loaded, here = ({name: one[name] for name in one if name.startswith(LOADED)} for one in (environment, started))
    return path if loaded == here and os.path.exists(words[0]) and os.path.exists(path) else None


def run(words, **how):
    """subprocess.run, sooner. One rank needs no launcher."""
    words = [str(word) for word in words]
    if os.path.basename(words[0]) in ("mpiexec", "mpirun") and "-n" in words[1:3]:
        at = words.index("-n")
        words = words[at + 2:] if words[at + 1] == "1" else words
    path = program_of(words, how)
    if not path:
        return subprocess.run(words, **how)
    if getattr(_own, "waiting", None) is None or _own.waiting.path != path:
        _own.waiting = Waiting(path)
    status, seconds, *said = _own.waiting.run(words[1:], how.get("cwd"), os.environ if how.get("env") is None else how["env"],
                                     how.get("timeout"))
    if how.get("text"):
        said = [text.decode(errors=how.get("errors", "strict")).replace("\r\n", "\n").replace("\r", "\n") for text in said]
    if said[1] and not how.get("capture_output") and "stderr" not in how:
        print(said[1], file=sys.stderr)
    done = subprocess.CompletedProcess(words, status, *said)
    done.seconds = seconds
    if how.get("check"):
        done.check_returncode()
    return done
