"""The tasks of the program as functions.

All take the path of a scene (or its text), and by keyword the program's options: numbers, texts, True and False,
Fraction(1, 8), and tuples where the program takes commas, such as drift=(Fraction(1, 8), 0). Besides:

  ranks      so many ranks of MPI
  progress   True or False: whether progress lines are shown; without it they are in notebooks and terminals, after 2 s
  scheme     a scheme of your own: the path of its file, or its text
  matrix     a matrix of numpy or scipy, or a file; matrix_blocks a dictionary {d: A_d}, or a file

They return a Result. They raise BadInput with the program's message, Failed when it ends without a result, NotBuilt
when there is no program. A missed expectation (-expect...) is no error: expectation_missed is True.
"""
import os
import shutil
import tempfile

from . import program, words
from .results import Result

# The files that the tasks write besides the table that they print.
FILES = {"critical": ("json", "csv"), "symbol": ("json", "csv", "output"), "spectrum": ("json", "csv", "output"),
         "run": ("json", "csv", "output"), "map": ("json", "csv", "output"), "ensemble": ("json", "csv")}
ENDINGS = {"json": ".json", "csv": ".csv", "output": ".h5"}


def result_files(task, options, folder):
    """Takes the options that name files of results. Returns for each of the files its path in the folder.

    A file that the user names is written there, with a link to it in the folder. False means that it is not written.
    """
    files, written = {}, {}
    for name in FILES[task]:
        named = options.pop(name, None)
        if named is False or (name == "json" and options.get("survey")):
            continue  # a survey has no JSON
        files[name] = os.path.join(folder, f"result{ENDINGS[name]}")
        written[name] = files[name] if named is None else os.path.abspath(os.fspath(named))
        if named is not None:
            os.symlink(written[name], files[name])
    return files, written


def launch(task, scene, ranks, progress, options):
    options = {name: value for name, value in options.items() if value is not None}
    folder = tempfile.mkdtemp(prefix="mpmstab-")
    try:
        files, written = result_files(task, options, folder)
        if "scheme" in options:
            options["scheme"] = words.file_of(options["scheme"], folder, "scheme.yaml")
        if "matrix" in options:
            options["matrix"] = words.matrix_file(options["matrix"], folder)
        if "matrix_blocks" in options:
            options["matrix_blocks"] = words.blocks_file(options["matrix_blocks"], folder)
        given = [] if scene is None else [words.file_of(scene, folder, "scene.yaml")]
        status, complaint = program.run([task, *given, *words.words_of({**options, **written})], ranks, progress,
                                        os.path.join(folder, "table.txt"))
        return Result(task, folder, files, status, complaint)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def critical(scene=None, *, ranks=1, progress=None, **options):
    """Returns the largest stable Courant number, in r.critical. With survey=True a table of all schemes, in r.rows."""
    return launch("critical", scene, ranks, progress, options)


def symbol(scene=None, *, ranks=1, progress=None, **options):
    """Returns the amplification factors of all waves: r.beta, r.factors, and their growth, r.array("symbol/growth")."""
    return launch("symbol", scene, ranks, progress, options)


def spectrum(scene=None, *, ranks=1, progress=None, **options):
    """Returns the eigenvalues of one step, or of a period of steps under drift: r.eigenvalues, r.residuals, r.beta."""
    return launch("spectrum", scene, ranks, progress, options)


def run(scene=None, *, ranks=1, progress=None, **options):
    """Marches a scene: r.rows over time, fields at output steps by r.array(PATH). output=False leaves fields out."""
    return launch("run", scene, ranks, progress, options)


def map(scene=None, *, ranks=1, progress=None, **options):
    """Returns growth over two axes: r.table, with the numbers along the axes in r.map, such as r.map.courant."""
    return launch("map", scene, ranks, progress, options)


def ensemble(scene=None, *, ranks=1, progress=None, **options):
    """Returns how many random layouts grow, in r.ensemble, and the growth of each, in r.rows."""
    return launch("ensemble", scene, ranks, progress, options)
