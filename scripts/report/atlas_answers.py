"""Runs the commands of the atlas and keeps each answer in a file of its own, so that a run that was ended goes on."""
import contextlib
import csv
import hashlib
import json
import os
import resource
import shlex
import signal
import subprocess
import tempfile
import threading
import time

from program import PROGRAM, result_of, side_by_side, write_whole

PATIENCE = 100  # seconds of a core for one command, however busy the machine is
LASTING = (0, 2, None)  # the statuses that would come again: done, refused, stopped


class Ended(Exception):
    """The script is being ended, and asks nothing more."""


def program_hash():
    """Returns what the answers depend on besides their command: the program itself."""
    with open(PROGRAM, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


def typed(words):
    return shlex.join(["mpmstab", *words])


def points_of(path):
    """Returns growth - 1 and the verdict of each point of a map, from its CSV; None where growth is not known."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {"excess": [float(row["growth"]) - 1 if row["growth"] else None for row in rows],
            "verdict": [row["verdict"] for row in rows]}


class Answers:
    """A folder of answers. An answer of another build of the program is not one of these."""

    def __init__(self, folder):
        self.folder, self.program = folder, program_hash()
        self.running, self.ended, self.lock = set(), False, threading.Lock()

    def path(self, words):
        name = hashlib.sha256(f"{self.program} {typed(words)}".encode()).hexdigest()[:24]
        return os.path.join(self.folder, f"{name}.json")

    def kept(self, words):
        """Returns the answer to a command, or None when it has not been asked or its file is damaged."""
        try:
            with open(self.path(words), encoding="utf-8") as file:
                found = json.load(file)
            return found if found["command"] == typed(words) else None
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def ask(self, words):
        """Returns the answer, which is kept: the command, its status (None: stopped), its result and what it said."""
        found = self.kept(words)
        if found is None:
            found = self.run(words)
            if found["status"] in LASTING:
                write_whole(self.path(words), json.dumps(found))
        return found

    def run(self, words):
        begin = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            out, table = os.path.join(folder, "out.json"), os.path.join(folder, "out.csv")
            more = ["-csv", table] if words[0] == "map" else []
            status, said = self.launch([PROGRAM, *words, "-json", out, *more])
            result = result_of(out) if status == 0 else {}
            if more and result:
                result["map"].update(points_of(table))
        return {"command": typed(words), "status": status, "said": said, "result": result,
                "seconds": round(time.monotonic() - begin, 3)}

    def launch(self, command):
        """Runs a command. Returns its status, None when it took too long, and the last line that it said."""
        with self.lock:
            if self.ended:
                raise Ended
            process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            self.running.add(process)
        with contextlib.suppress(ProcessLookupError):  # it has ended already
            resource.prlimit(process.pid, resource.RLIMIT_CPU, (PATIENCE, PATIENCE))
        said, status = process.communicate()[1].strip().splitlines(), process.returncode
        with self.lock:
            self.running.discard(process)
        if status in (-signal.SIGKILL, -signal.SIGXCPU):
            status, said = None, [f"stopped after {PATIENCE} s of a core"]
        if self.ended:
            raise Ended
        return status, said[-1].removeprefix("mpmstab: ") if said else ""

    def end(self):
        """Ends the commands that run, and lets no other begin."""
        with self.lock:
            self.ended = True
            for process in self.running:
                process.kill()


def ask_row(answers, row, told):
    """Asks the questions of a row, and tells after each. Where its first is refused there is no such scheme."""
    found = {}
    for name, words in row.questions().items():
        refused = bool(found) and found["limits"]["status"] == 2
        if not refused:
            found[name] = answers.ask(words)
        told(row, name, refused)
    return found


def ask_all(answers, rows, jobs, told):
    """Asks all rows, so many at a time, and returns what was found of each."""
    with side_by_side(jobs) as pool:
        try:
            return list(pool.map(lambda row: ask_row(answers, row, told), rows))
        except BaseException:
            answers.end()
            pool.shutdown(wait=False, cancel_futures=True)
            raise
