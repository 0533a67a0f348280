#!/usr/bin/python3
"""Compares CONTRIBUTING.md with the tree: every path that the page names exists, and it names every layer.

names.py ROOT. A path is a word of the page, outside of code, that ends with a slash or as a file does. It starts at
ROOT, or at a folder of HERE. Files that the page itself adds, whose text follows as a block of C, need not exist.
"""
import pathlib
import re
import sys

HERE = ["", "src", "src/scheme", "include"]
PATH = re.compile(r"(?<![\w./-])[A-Za-z][\w.-]*(?:/[\w.-]+)*(?:/|\.(?:h|c|py|sh|md|txt|json|supp))(?![\w/])")


def paths_of(page):
    """The paths that a page names, without those of files that it adds."""
    added = set(re.findall(r"`(\S+)`:\n\n```c$", page, re.M))
    page = re.sub(r"^```\w+$.*?^```$", "", page, flags=re.M | re.S)  # pictures have no language, and stay
    return set(PATH.findall(page)) - added


def main():
    root = pathlib.Path(sys.argv[1])
    page = (root / "CONTRIBUTING.md").read_text(encoding="utf-8")
    paths = paths_of(page)
    faults = [f"names {path}, which does not exist" for path in sorted(paths)
              if not any((root / folder / path).exists() for folder in HERE)]
    layers = {path.name + "/" for path in (root / "src").iterdir() if path.is_dir()}
    faults += [f"does not name the layer src/{layer}" for layer in sorted(layers - paths)]
    tests = {f"tests/{path.name}/" for path in (root / "tests").iterdir() if path.is_dir()}
    faults += [f"does not name {folder}" for folder in sorted(tests - paths)]
    if len(paths) < 30:
        faults.append(f"names {len(paths)} paths only: is it still read rightly?")
    for fault in faults:
        print(f"names.py: CONTRIBUTING.md {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
