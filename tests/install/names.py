#!/usr/bin/python3
"""Compares the pages for developers with the tree: every path that they name exists, and they name every layer.

names.py ROOT. A path is a word of the page, outside of code, that ends with a slash or as a file does. It starts at
ROOT, or at a folder of HERE. Files that a page itself adds, whose text follows as a block of C, need not exist. Each
function of a walk of architecture.md is in the file that stands beside it.
"""
import pathlib
import re
import sys

HERE = ["", "src", "src/scheme", "include", "docs", "docs/dev"]
PATH = re.compile(r"(?<![\w./-])[A-Za-z][\w.-]*(?:/[\w.-]+)*(?:/|\.(?:h|c|py|sh|md|txt|json|supp))(?![\w/])")


def paths_of(page):
    """The paths that a page names, without those of files that it adds."""
    added = set(re.findall(r"`(\S+)`:\n\n```c$", page, re.M))
    page = re.sub(r"^```\w+$.*?^```$", "", page, flags=re.M | re.S)  # pictures have no language, and stay
    return set(PATH.findall(page)) - added


def find_walk_faults(root):
    """The lines of tables '| `function` | `file` | what |', in three walks of at most ten functions."""
    page = (root / "docs/dev/architecture.md").read_text(encoding="utf-8")
    walks = [re.findall(r"^\| `(Mpm\w+)` \| `(src/\S+)` \|", part, re.M) for part in page.split("\n`mpmstab ")[1:]]
    faults = [f"has {len(walk)} functions in walk {number}" for number, walk in enumerate(walks) if not 8 <= len(walk) <= 10]
    faults += [] if len(walks) == 3 else [f"has {len(walks)} walks"]
    for name, file in (line for walk in walks for line in walk):
        text = (root / file).read_text(encoding="utf-8") if (root / file).exists() else ""
        if not re.search(rf"^Mpm\w+ {name}\(|^Petsc\w+ {name}\(", text, re.M):
            faults.append(f"says that {name} is in {file}")
    return [f"architecture.md {fault}" for fault in faults]


def main():
    root = pathlib.Path(sys.argv[1])
    pages = [root / "CONTRIBUTING.md", *sorted((root / "docs/dev").glob("*.md"))]
    paths = set().union(*(paths_of(page.read_text(encoding="utf-8")) for page in pages if page.name != "speed.md"))
    faults = find_walk_faults(root)
    faults += [f"the pages name {path}, which does not exist" for path in sorted(paths)
               if not any((root / folder / path).exists() for folder in HERE)]
    layers = {path.name + "/" for path in (root / "src").iterdir() if path.is_dir()}
    faults += [f"no page names the layer src/{layer}" for layer in sorted(layers - paths)]
    tests = {f"tests/{path.name}/" for path in (root / "tests").iterdir() if path.is_dir()}
    faults += [f"no page names {folder}" for folder in sorted(tests - paths)]
    if len(paths) < 30:
        faults.append(f"the pages name {len(paths)} paths only: is it still read rightly?")
    for fault in faults:
        print(f"names.py: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
