#!/usr/bin/python3
"""Runs a notebook of examples/notebook: it prints what its page says and the numbers that are bold in its text, and shows its pictures.

check_notebook.py MPMSTAB NAME. The status is 77 where nbclient and ipykernel are not installed. Else silent when all is well.
"""
import os
import re
import sys

from checks import ROOT, SCRIPTS, check, text_of

SKIPPED = 77
FOLDER = os.path.join(ROOT, "examples", "notebook")
PICTURES = {"critical": 2, "lecture": 3, "lecture-answers": 0}
SECONDS = 240  # of a cell, on a busy machine


def executed(name):
    """The notebook with its outputs. Its folder is where it runs, as in Jupyter."""
    import nbclient
    import nbformat
    notebook = nbformat.read(os.path.join(FOLDER, f"{name}.ipynb"), 4)
    check(not any(cell.get("outputs") for cell in notebook.cells), "the notebook has outputs, which are to be cleared")
    nbclient.NotebookClient(notebook, timeout=SECONDS, kernel_name="python3",
                            resources={"metadata": {"path": FOLDER}}).execute()
    return notebook


def main(path, name):
    try:
        import ipykernel  # noqa: F401 (only to see whether it is there)
        import nbclient  # noqa: F401
    except ImportError as error:
        print(f"check_notebook: {error}; scripts/test.sh installs it")
        sys.exit(SKIPPED)
    os.environ.update(MPMSTAB=os.path.abspath(path), PYTHONPATH=os.path.join(SCRIPTS, "python"), PYDEVD_DISABLE_FILE_VALIDATION="1")
    notebook = executed(name)
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    printed = "".join(output["text"] for output in outputs if output.get("name") == "stdout")
    page = text_of(os.path.join(FOLDER, "README.md")).split(f"`{name}.ipynb` prints\n\n")[1].split("\n\n")[0]
    check(printed == re.sub("^    ", "", page, flags=re.MULTILINE).rstrip("\n") + "\n",
          f"the notebook prints\n{printed}not\n{page}")
    for cell in notebook.cells:
        if cell["cell_type"] == "markdown":
            for number in re.findall(r"\*\*(\d[\d.]*%?)\*\*", cell["source"]):
                check(number in printed, f"the text says {number}, and no cell prints it")
    shown = [kind for output in outputs for kind in output.get("data", {})]
    check(shown.count("image/png") == PICTURES[name] and ("text/html" in shown) == (name == "critical"),
          f"the notebook shows {shown}")


if __name__ == "__main__":
    main(*sys.argv[1:])
