"""Runs the program for a report of one scene and keeps its answers. No failure of a run ends the report."""
import os
import re
import shlex
import subprocess
import sys

from program import PROGRAM, ROOT, command_of, result_of

SMALL = 256  # powers and the pseudospectrum are computed up to so many unknowns
MOST_OUTPUT = 120  # about so many output steps of a run at most
PATIENCE = 600  # seconds for one command
MAP_IN_THE_PLANE = ["-map_points", "12,9", "-phases", "16"]  # points and phases of a map in two dimensions
ENDINGS = (".json", ".h5", ".csv", ".jsonl", ".png", ".svg", ".xmf")  # of the files that the runs write
COLUMNS = ("published", "corrected", "symbol", "spectrum", "measured")


class Answer:
    """The outcome of a command: the command as typed, status, JSON ({} when none), standard output, and complaint."""

    def __init__(self, command, status, result, table, complaint):
        self.command, self.status, self.result, self.table, self.complaint = command, status, result, table, complaint
        self.done = status in (0, 3) and bool(result)  # 3: an expectation is missed


def shown(path):
    """Returns a path relative to the project's folder when it lies inside."""
    inside = os.path.relpath(path, ROOT)
    return path if inside.startswith("..") else inside


def typed(words):
    """Returns a command as one would type it in the project's folder, with paths relative to it."""
    return shlex.join(shown(word) if os.path.isabs(word) else word for word in words)


def progress(text):
    print(f"report: {text}", file=sys.stderr, flush=True)


def complaint_of(done):
    """Returns the line that the program said, without those of mpirun."""
    lines = done.stderr.strip().splitlines() or [f"ended with status {done.returncode}"]
    own = [line.removeprefix("mpmstab: ") for line in lines if line.startswith("mpmstab: ")]
    return own[0] if own else lines[-1]


class Asker:
    """Runs tasks on one scene. Each task has files of its own in the scene's folder."""

    def __init__(self, scene, folder, ranks, where=ROOT):
        self.scene, self.folder, self.ranks, self.where = scene, folder, ranks, where

    def path(self, name):
        return os.path.join(self.folder, name)

    def ask(self, task, name=None, options=(), files=("json",)):
        """Runs the task, which writes NAME.json, NAME.h5 and NAME.csv, those of them that files names."""
        name = name or task
        words = [task, self.scene, *options]
        for kind in files:
            path = self.path(f"{name}.{kind}")
            if os.path.exists(path):
                os.remove(path)
            words += [{"json": "-json", "csv": "-csv", "h5": "-output"}[kind], path]
        progress(f"{shown(self.scene)}: {name}")
        command = command_of(words, self.ranks)
        try:
            done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=PATIENCE,
                                  cwd=self.where)
        except subprocess.TimeoutExpired:
            return Answer(typed(command), None, {}, "", f"stopped after {PATIENCE} s")
        result = result_of(self.path(f"{name}.json"))
        return Answer(typed(command), done.returncode, result, done.stdout, complaint_of(done))


def options_known():
    """Returns the names of the options that this build of the program has."""
    done = subprocess.run([PROGRAM, "list", "options"], capture_output=True, text=True, check=False)
    return set(re.findall(r"^  (\w+) ", done.stdout, flags=re.MULTILINE))


def every(steps):
    return max(1, -(-steps // MOST_OUTPUT))


def each(value):
    """Returns what a result has for each direction as a list."""
    return value if isinstance(value, list) else [value]


def dimension(result):
    return result.get("dim", 1)


def ask_for_output(asker, result):
    """Asks for the fields of a run: over time in one dimension, in more at its beginning and end."""
    often = ["-output_every", str(every(result["run"]["steps"]))] if dimension(result) == 1 else []
    return asker.ask("run", "output", often, ("json", "h5"))


def left_out(answers):
    """Says in sentences what is not asked of a scene of more than one dimension, and why."""
    scene = next((answer.result for answer in answers.values() if answer.done), {})
    dim, said = dimension(scene), []
    if dim > 1 and "output" in answers:
        said.append("No picture over place and time: that is for one dimension. The end of the run is shown instead.")
    if dim > 1 and answers["spectrum"].done and "transient" not in answers:
        said.append(f"No norms of powers and no pseudospectrum: the operator has more than {SMALL} unknowns.")
    if dim == 2 and "map" in answers:
        said.append(f"The map has {MAP_IN_THE_PLANE[1].replace(',', ' x ')} points and {MAP_IN_THE_PLANE[3]} phases in "
                    "each direction, fewer than in one dimension, because each takes longer.")
    if dim == 3:
        said.append("No map: in three dimensions the symbol of all its points takes too long.")
    return said


def ask_all(scene, folder, ranks, known):
    """Runs all tasks on a scene. Returns the asker and the answers by name."""
    asker = Asker(os.path.abspath(scene), folder, ranks)
    answers = {"spectrum": asker.ask("spectrum", files=("json", "h5", "csv")),
               "symbol": asker.ask("symbol", files=("json", "h5", "csv"))}
    spectrum, symbol = answers["spectrum"], answers["symbol"]
    if symbol.done and any(each(symbol.result["drift"])):
        answers["at rest"] = asker.ask("symbol", "at-rest", ["-drift", "0"])
    if symbol.done and "damping" in known:
        answers["damping"] = asker.ask("symbol", "damping", ["-damping", "true"], ("json", "h5"))
    answers["critical"] = asker.ask("critical")
    answers["run"] = asker.ask("run", files=("json", "csv"))
    if answers["run"].done:
        answers["output"] = ask_for_output(asker, answers["run"].result)
    small = spectrum.done and spectrum.result["spectrum"].get("unknowns", SMALL + 1) <= SMALL
    if small and {"powers", "pseudospectrum"} <= known:
        more = ["-measure", "false", "-powers", "400", "-pseudospectrum", "48", "-modes", str(SMALL)]
        answers["transient"] = asker.ask("spectrum", "transient", more, ("json", "h5"))
    if symbol.done and "map_axes" in known and dimension(symbol.result) < 3:
        fewer = MAP_IN_THE_PLANE if dimension(symbol.result) == 2 else []
        answers["map"] = asker.ask("map", options=["-map_axes", "courant,drift", *fewer], files=("json", "h5", "csv"))
    return asker, answers


def work_precision(scene, asker, result):
    """Measures error against run time on half, once and twice the scene's cells, with work_precision.py.

    In three dimensions twice the cells are left out, which would take sixteen times as long.
    """
    own = each(result["cells"])
    cells, halves = own[0], all(count % 2 == 0 for count in own)
    script = os.path.join(ROOT, "scripts", "work_precision.py")
    name = asker.path("work-precision")
    grids = [max(2, cells // 2)] if len(own) == 1 or halves else []
    grids = ",".join(map(str, [*grids, cells, *([2 * cells] if len(own) < 3 else [])]))
    words = [script, os.path.abspath(scene), "--cells", grids, "--courant", str(result["courant"]),
             "--repeats", "3", "--most", "3", "-o", name]
    progress(f"{shown(scene)}: error against run time")
    if os.path.exists(f"{name}.runs.jsonl"):
        os.remove(f"{name}.runs.jsonl")  # it may be of another build or scene
    command = typed(words)
    try:
        done = subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False, timeout=PATIENCE,
                              cwd=ROOT)
    except subprocess.TimeoutExpired:
        return Answer(command, None, {}, "", f"stopped after {PATIENCE} s")
    made = {"done": True} if done.returncode == 0 else {}
    return Answer(command, done.returncode, made, done.stdout, complaint_of(done))


def explanations(table):
    """Returns the words of the program's own table beside each of the five growths."""
    said = {}
    for name in COLUMNS:
        found = re.search(rf"^  {name} +(?:off range|\S+) +(.*)$", table, flags=re.MULTILINE)
        if found:
            said[name] = found.group(1).strip()
    return said


def why_published_differs(table):
    """Returns the program's words on how far the published abs(G) is off, as one line."""
    lines = table.splitlines()
    for number, line in enumerate(lines):
        if line.startswith("the published abs(G)"):
            more = []
            for following in lines[number + 1:]:
                if not following.startswith("  "):
                    break
                more.append(following.strip())
            return " ".join([line, *more])
    return None


def growths(answers):
    """Returns the five growths per step, None for one that is not covered or not computed."""
    spectrum, symbol = answers["spectrum"], answers["symbol"]
    source = spectrum.result if spectrum.done else symbol.result if symbol.done else answers["run"].result
    predicted = source.get("predicted", {})
    found = {name: predicted.get(name) for name in COLUMNS[:3]}
    found["spectrum"] = spectrum.result.get("spectrum", {}).get("growth")
    run = spectrum.result.get("run") or answers["run"].result.get("run", {})
    found["measured"] = run.get("growth_measured")
    return found
