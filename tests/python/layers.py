#!/usr/bin/python3
"""Reads the #include lines of src/ and include/ and fails when a layer includes a later one, or units form a circle.

layers.py [--root FOLDER]: FOLDER holds src/ and include/ (this project).

LAYERS names the layers, which are the folders of src/, from the first to the last. A file may include headers of its
own layer and of those before it. A public header, include/mpmstab/NAME.h, belongs to the layer whose folder has NAME.c,
or to the one that PUBLIC names. A unit is a header and the .c file of the same name in the same folder. Silent when all is
well.
"""
import argparse
import pathlib
import re
import sys

LAYERS = ["base", "linalg", "scheme", "scene", "program", "march", "operator", "symbol", "analysis", "probe", "io",
          "report", "task"]
PUBLIC = {"compat": "base", "boundary": "scheme", "collider": "scheme", "formulation": "scheme", "transfer": "scheme",
          "basis": "scheme", "scheme": "scheme", "material": "scheme", "plugin": "probe", "mpmstab": "task"}
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(?:"([^"]+)"|<(mpmstab/[^>]+)>)', re.M)
ROOT = pathlib.Path(__file__).resolve().parents[2]


def read(root):
    """Returns layer and included names of each file, by its name: its path within src/, or mpmstab/NAME.h."""
    texts = {str(path.relative_to(root / "src")): path for path in root.glob("src/*/**/*.[ch]")}
    public = {f"mpmstab/{path.name}": path for path in root.glob("include/mpmstab/*.h")}
    owners = {}
    for name in texts:
        layer, *rest = name.split("/")
        if len(rest) == 1 and name.endswith(".c"):
            owners.setdefault(rest[0][:-2], set()).add(layer)
    layers = {name: name.split("/")[0] for name in texts}
    for name, path in public.items():
        found = owners.get(path.stem, set())
        layers[name] = PUBLIC.get(path.stem) or (found.pop() if len(found) == 1 else None)
    return {name: (layers[name], [own or other for own, other in INCLUDE.findall(path.read_text(encoding="utf-8"))])
            for name, path in sorted({**texts, **public}.items())}


def find_faults(files):
    """Returns a line for each fault."""
    faults = [f"{name}: belongs to no layer; allowed: a folder of {', '.join(LAYERS)}, or a line in PUBLIC of layers.py"
              for name, (layer, _) in files.items() if layer not in LAYERS]
    for name, (layer, includes) in files.items():
        for other in includes:
            if other not in files:
                faults.append(f"{name} includes {other}, which does not exist")
            elif layer in LAYERS and files[other][0] in LAYERS[LAYERS.index(layer) + 1:]:
                faults.append(f"{name} ({layer}) includes {other} ({files[other][0]}), which is of a later layer")
    return faults + [f"circle: {' -> '.join(circle)}" for circle in find_circles(units_of(files))]


def units_of(files):
    """Returns what each unit includes: other units, and itself where a header does."""
    units = {}
    for name, (layer, includes) in files.items():
        unit = name[:-2]
        others = {other[:-2] for other in includes if other in files}
        units.setdefault(unit, (layer, set()))[1].update(
            others if name.endswith(".h") else others - {unit})
    return {unit: (layer, sorted(others)) for unit, (layer, others) in units.items()}


def find_circles(files):
    """Returns the circles of #include lines, each as the units along it."""
    circles, done = [], set()

    def follow(name, way):
        if name in way:
            circles.append(way[way.index(name):] + [name])
        elif name in files and name not in done:
            for other in files[name][1]:
                follow(other, way + [name])
            done.add(name)

    for name in files:
        follow(name, [])
    return circles


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--root", type=pathlib.Path, default=ROOT)
    root = parser.parse_args().root
    files = read(root)
    faults = find_faults(files) if files else [f"no C files in {root}/src"]
    for fault in faults:
        print(f"layers.py: {fault}", file=sys.stderr)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
