"""Finds the program, runs it, and passes its progress on."""
import importlib.metadata
import json
import os
import re
import shutil
import subprocess
import sys
import time
import urllib.parse

from .errors import BadInput, Failed, NotBuilt

HERE = os.path.dirname(os.path.abspath(__file__))
# As scripts/mpi-env.sh: lets Open MPI run as root and with more ranks than cores, with one thread each.
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
       "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_mpi_yield_when_idle": "1", "OMP_NUM_THREADS": "1",
       "OMPI_MCA_pml": "ob1"}
SILENT = 2  # seconds without progress lines, as on a terminal
PATIENCE = 10  # seconds that the program has for ending after Ctrl-C


def sources():
    """Returns the folder of the project: around this file, or where pip says that it has installed from (PEP 610)."""
    around = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
    if os.path.exists(os.path.join(around, "CMakeLists.txt")):
        return around
    try:
        origin = importlib.metadata.distribution("mpmstab").read_text("direct_url.json")
    except importlib.metadata.PackageNotFoundError:
        return None
    url = urllib.parse.urlparse(json.loads(origin)["url"]) if origin else None
    return os.path.dirname(os.path.dirname(urllib.parse.unquote(url.path))) if url and url.scheme == "file" else None


def find():
    """Returns the path of the program: MPMSTAB, or build/ in the project's folder, or what the search path has."""
    named = os.environ.get("MPMSTAB")
    if named:
        if not (os.path.isfile(named) and os.access(named, os.X_OK)):
            raise NotBuilt(f"MPMSTAB {named}: there is no program; allowed: the path of the program mpmstab")
        return os.path.abspath(named)
    folder = sources()
    built = os.path.join(folder, "build", "mpmstab") if folder else None
    if built and os.path.isfile(built):
        return built
    found = shutil.which("mpmstab")
    if not found:
        raise NotBuilt("there is no program mpmstab in build/ of its sources or on the search path; ./scripts/setup.sh "
                       "in its sources builds it, and the environment variable MPMSTAB names one elsewhere")
    return found


def command_of(words, ranks):
    if isinstance(ranks, bool) or not isinstance(ranks, int) or ranks < 1:
        raise BadInput(f"ranks {ranks}: allowed: a whole number from 1 on")
    if ranks > 1 and not shutil.which("mpirun"):
        raise BadInput(f"ranks {ranks}: there is no mpirun on the search path; allowed: 1, or with mpirun installed")
    return [*(["mpirun", "-q", "-n", str(ranks)] if ranks > 1 else []), find(), *words]


def is_watched():
    """Says whether somebody reads standard error: a notebook or a terminal shows it."""
    return "ipykernel" in sys.modules or bool(sys.stderr and sys.stderr.isatty())


class Listener:
    """Takes what the program writes on standard error. Progress lines, which begin with \\r, are shown."""

    def __init__(self, shown, silent):
        self.text, self.shown, self.begins = "", shown, time.monotonic() + silent

    def take(self, text):
        self.text += text
        if self.shown and time.monotonic() >= self.begins:
            lines = [line for line, end in re.findall(r"(\r[^\r\n]*)(\n?)", text) if not end]
            sys.stderr.write("".join(lines))
            sys.stderr.flush()

    def said(self):
        """Returns the lines that are no progress."""
        lines = [line.rsplit("\r", 1)[-1].strip() for line in self.text.split("\n")]
        return [line for line in lines if line]


def finish(process):
    """Ends the program, and with it all its ranks."""
    process.terminate()
    try:
        process.wait(PATIENCE)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


def run(words, ranks, progress, table):
    """Runs the program with these words; what it prints goes to the file table. Returns its status and complaint."""
    wished = is_watched() if progress is None else progress
    listener = Listener(wished, SILENT if progress is None else 0)
    with open(table, "wb") as printed, subprocess.Popen(
            command_of([*words, "-progress", "true" if wished else "false"], ranks), stdin=subprocess.DEVNULL,
            stdout=printed, stderr=subprocess.PIPE, env={**MPI, **os.environ}) as process:
        try:
            while chunk := os.read(process.stderr.fileno(), 65536):
                listener.take(chunk.decode(errors="replace"))
            status = process.wait()
        except BaseException:
            finish(process)
            raise
    said = listener.said()
    own = [line.removeprefix("mpmstab: ") for line in said if line.startswith("mpmstab: ")]
    complaint = "\n".join(own or said)
    if status == 2:
        raise BadInput(complaint)
    if status not in (0, 3):
        raise Failed(f"the program ended with status {status}: {complaint or 'it said nothing'}")
    return status, complaint
