#!/usr/bin/python3
"""Runs the example notebook of the Python package: it prints what its page says, and shows its pictures.

check_notebook.py MPMSTAB. The status is 77 where nbclient and ipykernel are not installed. Else silent when all is well.
"""
import os
import re
import sys

from checks import ROOT, SCRIPTS, check, text_of

SKIPPED = 77
FOLDER = os.path.join(ROOT, "examples", "notebook")


def main(path):
    try:
        import ipykernel  # noqa: F401 (only to see whether it is there)
        import nbclient
        import nbformat
    except ImportError as error:
        print(f"check_notebook: {error}; scripts/test.sh installs it")
        sys.exit(SKIPPED)
    notebook = nbformat.read(os.path.join(FOLDER, "critical.ipynb"), 4)
    check(not any(cell.get("outputs") for cell in notebook.cells), "the notebook has outputs, which are to be cleared")
    os.environ.update(MPMSTAB=path, PYTHONPATH=os.path.join(SCRIPTS, "python"), PYDEVD_DISABLE_FILE_VALIDATION="1")
    nbclient.NotebookClient(notebook, timeout=120, kernel_name="python3").execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    printed = "".join(output["text"] for output in outputs if output["output_type"] == "stream")
    page = text_of(os.path.join(FOLDER, "README.md")).split("The notebook prints\n\n")[1].split("\n\n")[0]
    check(printed == re.sub("^    ", "", page, flags=re.MULTILINE) + "\n", f"the notebook prints\n{printed}not\n{page}")
    shown = [kind for output in outputs for kind in output.get("data", {})]
    check(shown.count("image/png") == 2 and "text/html" in shown, f"the notebook shows {shown}")


if __name__ == "__main__":
    main(sys.argv[1])
