"""Reads the scene that a file is of, describes it in words, and refuses files that are of different scenes.

A scene is a dictionary, from the attributes of an HDF5 file or from a JSON object. With more than one dimension, what
has a value for each direction is a list, in the order x y z.
"""
import math
import re

import picture_files as files

AXES = "xyz"
BOUND = 92  # letters in a line under a picture


def attributes(file):
    """Returns the scene that an HDF5 file holds in its attributes, where NAME_x, NAME_y, ... become the list NAME."""
    scene, lists = {}, {}
    for key, value in file.attrs.items():
        scene[key] = value.decode() if isinstance(value, bytes) else value
    dim = dimension(scene)
    for key in list(scene) if dim > 1 else []:
        found = re.fullmatch(r"(\w+)_([xyz])(_\w+)?", key)
        if found:
            lists.setdefault(found[1] + (found[3] or ""), {})[found[2]] = scene.pop(key)
    for key, values in lists.items():
        if len(values) != dim or any(axis not in values for axis in AXES[:dim]):
            files.refuse(file.filename, f"not {dim} values of '{key}' in its attributes",
                         "a file that mpmstab has written with -output")
        scene[key] = [values[axis] for axis in AXES[:dim]]
    if "safety" in scene:  # of a run that chose its steps there is no Courant number, and no drift
        scene.setdefault("courant", 0.0)
        scene.setdefault("drift", [0.0] * dim if dim > 1 else 0.0)
    missing = [key for key in files.SCENE if key not in scene]
    if missing:
        files.refuse(file.filename, f"no '{missing[0]}' in its attributes",
                     "a file that mpmstab has written with -output")
    return scene


def attributes_or_code(file):
    """Returns the scene of a file, or of a map of a code its command and parameters, which are no scene."""
    if "formulation" in file.attrs or not any(key in file.attrs for key in files.CODE):
        return attributes(file)
    return {key: value.decode() if isinstance(value, bytes) else value for key, value in file.attrs.items()}


def is_code(scene):
    """Says whether this is a code that was probed, in the place of a scene."""
    return "formulation" not in scene


def code_text(scene):
    """Describes a code by its command and the parameters that were set."""
    kind = next(key for key in files.CODE if key in scene)
    given = f", {scene['program_set']}" if scene.get("program_set") else ""
    return wrapped(f"{kind} {scene[kind]}{given}")


def dimension(scene):
    """Returns the number of space dimensions; files that do not say it are of one."""
    dim = int(scene.get("dim", 1))
    return dim if dim in (2, 3) else 1


def each(scene, key, default=None):
    """Returns the values of a key, a list with one for each direction."""
    value = scene.get(key, default)
    return value if isinstance(value, list) else [value] * dimension(scene)


def require_dimension(path, scene, allowed, picture):
    """Refuses scenes of dimensions that have no such picture."""
    if dimension(scene) not in allowed:
        files.refuse(path, f"is of {dimension(scene)} dimensions, where there is no picture of {picture}",
                     f"dim {' or '.join(map(str, allowed))}")


def period(scene):
    """Returns the number of steps after which drifting particles lie in their cells as before."""
    return math.lcm(*(int(str(exact).rsplit("/", maxsplit=1)[-1]) for exact in each(scene, "drift_exact", "0/1")))


def joined(values, form="{:.6g}"):
    """Returns numbers as text with commas between them, or one when all are the same."""
    texts = [form.format(float(value)) for value in values]
    return texts[0] if len(set(texts)) == 1 else ",".join(texts)


def drift_text(scene):
    texts = []
    for value, exact in zip(each(scene, "drift"), each(scene, "drift_exact", "")):
        exact = str(exact)
        texts.append(f"{float(value):.6g}" if exact.endswith("/1") or not exact else exact)
    return texts[0] if set(texts) == {"0"} else ",".join(texts)


def boundary_text(scene):
    ends = scene["boundary"].split(",")
    return scene["boundary"] if len(set(ends)) > 1 or dimension(scene) == 1 else ends[0]


def layout_text(scene):
    layout = [f"offset {joined(each(scene, 'offset', 0.5))}"]
    jitter = float(scene.get("jitter", 0))
    if jitter:
        layout.append(f"jitter {jitter:.6g} (seed {int(scene['seed'])})")
    counts = scene.get("counts", "")
    counts = counts if isinstance(counts, str) else ",".join(str(count) for count in counts)
    if "," in counts:
        layout.append(f"counts {counts}")
    low, high = scene.get("cluster", (scene.get("cluster_from", 0), scene.get("cluster_to", 1)))
    if high - low < 1:
        layout.append(f"cluster {low:.6g},{high:.6g}")
    material = scene.get("material", "uniform")
    kind = material if isinstance(material, str) else material["kind"]
    if kind != "uniform":
        ratios = scene if isinstance(material, str) else material
        given = [f"{name} ratio {ratios[f'{name}_ratio']:.6g}" for name in ("density", "stiffness")
                 if kind in ("two", "graded") or ratios.get(f"{name}_ratio", 1) != 1]
        layout.append(f"material {kind}" + (f" ({', '.join(given)})" if given else ""))
    return ", ".join(layout)


def formulation_text(scene):
    """Names the formulation, and of a scheme as text the beginning of its hash and its parameters."""
    scheme = scene.get("scheme")
    if not scheme:
        return scene["formulation"]
    told = scheme if isinstance(scheme, dict) else {"hash": scheme, "parameters": scene.get("parameters", "")}
    numbers = [f"{name} = {float(value):.6g}" for name, _, value in
               (part.partition("=") for part in told.get("parameters", "").split(",") if part)]
    return f"{scene['formulation']} [{', '.join([told['hash'][:8], *numbers])}]"


def scene_parts(scene):
    """Describes a scene, as texts by key. Poisson's ratio is among them where it counts."""
    basis, transfer = f"{scene['basis']} basis", scene["transfer"]
    if scene.get("gradient", "basis") != "basis":
        basis += f" (gradient {scene['gradient']})"
    for option in ("blend_ratio", "xpic_order"):
        if option in scene:
            transfer += f" ({option} {float(scene[option]):g})"
    parts = {"formulation": formulation_text(scene), "basis": basis, "transfer": transfer,
             "courant": f"k = {float(scene['courant']):.6g}" if "safety" not in scene else "courant auto"}
    if "poisson" in scene:
        parts["poisson"] = f"ν = {float(scene['poisson']):.6g}"
    ppc = [int(count) for count in each(scene, "ppc")]
    return {**parts, "drift": f"drift {drift_text(scene)}",
            "cells": " x ".join(str(int(cells)) for cells in each(scene, "cells")) + " cells",
            "ppc": f"{' x '.join(map(str, ppc))} particle{'s' if max(ppc) > 1 else ''} a cell",
            "layout": layout_text(scene), "boundary": f"ends {boundary_text(scene)}"}


def inclusion_of(scene):
    """Returns the ends of the inclusion, direction by direction."""
    material = scene.get("material", "uniform")
    if material == "two":
        return [end for both in zip(each(scene, "inclusion_from"), each(scene, "inclusion_to")) for end in both]
    inclusion = material.get("inclusion", (0, 0)) if isinstance(material, dict) else (0, 0)
    return [end for one in inclusion for end in (one if isinstance(one, list) else [one])]


def compared(scene):
    """Returns the parts of a scene that must agree in two files. Drift is a number here, as in JSON."""
    ends = ",".join(f"{end:.12g}" for end in inclusion_of(scene))
    return {**scene_parts(scene), "courant": f"k = {float(scene['courant']):.12g}",
            "poisson": f"ν = {float(scene.get('poisson', 0)):.12g}",
            "drift": f"drift {joined(each(scene, 'drift'), '{:.12g}')}",
            "particles": f"{int(scene['particles'])} particles",
            "inclusion": f"inclusion {ends if any(inclusion_of(scene)) else 0}"}


def require_same(path, scene, other_path, other):
    """Refuses two files that are of different scenes, or of different codes."""
    ours, theirs = ({"code": code_text(one)} if is_code(one) else compared(one) for one in (scene, other))
    differs = [f"{ours[key]} and {theirs[key]}" for key in ours if ours[key] != theirs[key]]
    if differs:
        files.refuse(f"{path} and {other_path}", f"of different scenes: {differs[0]}", "files of one scene")


def result_beside(path, scene, result_path, *tasks):
    """Returns a JSON result, which must be of one of these tasks and of the scene of another file.

    The scene is None when that file does not say it.
    """
    result = files.read_json(result_path, bool(scene) and is_code(scene))
    if result["task"] not in tasks:
        files.refuse(f"{path} and {result_path}", f"the second is of the task {result['task']}", " or ".join(tasks))
    if scene:
        require_same(path, scene, result_path, result)
    return result


# What the fields are, and their units, by the formulation's own registers.
GAS = {"u": ("velocity u", "length / time"), "r": ("density r = −(a/ρ0) ρ", "length / time")}
BAR = {"u": ("displacement u", "length"), "w": ("velocity w = v h / c", "length")}
MOMENTUM = {"v": ("velocity v", "length / time"), "s": ("stress s = σ / (ρ0 c)", "length / time"),
            "c": ("affine velocity c", "length / time")}


def quantity(scene, field, between=" "):
    """Names a field of particles with its symbol and, unless between is None, its unit. Of a scheme as text: its symbol."""
    known = {} if scene.get("scheme") else {"gas": GAS, "elastic": BAR}.get(scene["formulation"].rstrip("12"), MOMENTUM)
    name, unit = known.get(field, (field, None))
    return f"{name}{between}({unit})" if unit and between else name


def wrapped(*lines):
    """Returns lines under a picture, each broken after a comma where it is too long."""
    kept = []
    for line in lines:
        first, *others = line.split(", ")
        kept.append(first)
        for part in others:
            if len(kept[-1]) + len(part) + 2 > BOUND:
                kept[-1] += ","
                kept.append(part)
            else:
                kept[-1] += f", {part}"
    return "\n".join(kept)


def scene_text(scene):
    parts = scene_parts(scene)
    first = [parts[key] for key in ("formulation", "basis", "transfer", "courant", "poisson") if key in parts]
    return wrapped(", ".join(first) + f", {parts['drift']} (cells per step)",
                   ", ".join(parts[key] for key in ("cells", "ppc", "layout", "boundary")))
