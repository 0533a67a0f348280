"""What the scripts share: they run mpmstab, refuse bad input in one line, write whole files and name the machine.

The environment variable MPMSTAB names the program (by default build/mpmstab). Scripts import this module first: from
then on Ctrl-C ends them in one line, and the modules in scripts/report are found.
"""
import argparse
import concurrent.futures
import json
import os
import platform
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.path.append(os.path.join(ROOT, "scripts", "report"))

from whole_files import fault_of, fault_of_outputs, write_whole  # noqa: E402,F401 (found by that line)

if "MPMSTAB_FORKS" in os.environ:  # a test says where forks.py is, with which short commands start sooner
    sys.path.append(os.environ["MPMSTAB_FORKS"])
    from forks import run as run_command
else:
    run_command = subprocess.run

PROGRAM = os.path.abspath(os.environ.get("MPMSTAB", os.path.join(ROOT, "build", "mpmstab")))


def say(message):
    """Prints one line on standard error. Letters that would break the line, as in a file's name, become spaces."""
    line = f"{os.path.basename(sys.argv[0])}: {message}"
    print("".join(letter if letter.isprintable() else " " for letter in line), file=sys.stderr)


def refuse(message):
    """Says why the input is bad and ends the script with status 2, as the program does."""
    say(message)
    sys.exit(2)


class Parser(argparse.ArgumentParser):
    """A parser of options that prints the script's docstring for --help and refuses bad options in one line."""

    def __init__(self, description):
        super().__init__(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)

    def error(self, message):
        refuse(f"{message}; allowed: what --help says")


def uncaught(kind, error, trace):
    """Ends the script in one line after Ctrl-C. Faults of the script are shown with their trace, as usual."""
    if not issubclass(kind, KeyboardInterrupt):
        sys.__excepthook__(kind, error, trace)
        return
    say("interrupted")
    sys.exit(130)


sys.excepthook = uncaught


def end_in_one_line(main):
    """Runs main. A file that cannot be written or a full standard output is one line; a closed pipe ends silently."""
    try:
        main()
        if sys.stdout:
            sys.stdout.flush()
    except OSError as error:
        if error.filename:
            refuse(f"{error.filename}: {error.strerror}; allowed: a place that can be read and written")
        if not isinstance(error, BrokenPipeError):
            say(f"standard output cannot be written: {error.strerror}")
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # else the interpreter complains once more
        sys.exit(1)


def require_program():
    if not os.path.exists(PROGRAM):
        refuse(f"there is no {PROGRAM}; ./scripts/setup.sh builds it, MPMSTAB names another")
    if not (os.path.isfile(PROGRAM) and os.access(PROGRAM, os.X_OK)):
        refuse(f"{PROGRAM} cannot be run; allowed: mpmstab itself (MPMSTAB names it)")


def command_of(words, ranks=1):
    return [*(["mpirun", "-q", "-n", str(ranks)] if ranks > 1 else []), PROGRAM, *words]


def result_of(path):
    """Returns the JSON that the program has written, or {} when there is no file."""
    if not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def side_by_side(jobs):
    """Returns so many workers, each for one command at a time. The linear algebra of a command gets one thread.

    With as many threads as there are cores these wait for those of the other commands. A search for limits in three
    dimensions then took five times the processor time.
    """
    os.environ["OMP_NUM_THREADS"] = "1"
    return concurrent.futures.ThreadPoolExecutor(jobs)


def launch(task, scene=None, options=(), ranks=1):
    """Runs a task and returns its status, its JSON ({} when it wrote none) and its standard error.

    The options are a list of words, or a dictionary of values by name.
    """
    if isinstance(options, dict):
        options = [word for name, value in options.items() for word in (f"-{name}", str(value))]
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out.json")
        done = run_command(command_of([task, *([scene] if scene else []), *options, "-json", out], ranks),
                           capture_output=True, text=True, check=False)
        return done.returncode, result_of(out), done.stderr.strip()


def require_input(path, allowed):
    """Refuses a file that cannot be read whole."""
    fault = fault_of(path)
    if fault:
        refuse(f"{path}: {fault}; allowed: {allowed}")


def require_outputs(outputs, inputs=()):
    """Refuses to write a file that is also read, and what is not a regular file."""
    fault = fault_of_outputs(outputs, inputs)
    if fault:
        refuse(fault)


def print_or_check(description, compute, lines_of, check, draw=None):
    """The main of a script that prints tables of a page, draws them with -o NAME, and compares a page with --check FILE.

    compute() returns what lines_of and draw take. check(path, lines, whole) refuses the lines of a page; without --all it
    computes a part of the tables.
    """
    parser = Parser(description)
    parser.add_argument("--check", metavar="FILE", help="the page whose tables are checked")
    parser.add_argument("--all", action="store_true", help="check all of its numbers")
    if draw:
        parser.add_argument("-o", "--output", metavar="NAME", help="the pictures that are written")
    parser.set_defaults(output=None)
    arguments = parser.parse_args()
    require_program()
    if arguments.check:
        require_input(arguments.check, "a page with the tables")
        with open(arguments.check, encoding="utf-8") as file:
            check(arguments.check, file.read().split("\n"), arguments.all)
        return
    if arguments.output:
        from picture_style import names_of, save
        require_outputs(names_of(arguments.output))
    found = compute()
    for line in lines_of(found):
        print(line, flush=True)
    if arguments.output:
        save(draw(found), arguments.output)


def cells_of(line):
    """Returns the cells of a row of a table in Markdown."""
    return [cell.strip() for cell in line.strip("|\n").split("|")]


def processor():
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            return next(line.split(":", 1)[1].strip() for line in file if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or "not known"
