#!/usr/bin/python3
"""Checks the pictures of maps, powers and pseudospectra on made-up files whose answer is known.

check_picture_maps.py MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import json
import math
import sys

import h5py
import numpy

from checks import check
import pictures
from check_pictures import SCENES, check_refused, check_written, close, line, mpmstab

MPMSTAB = sys.argv[1]


def made_up(name, source="gas2"):
    """Returns a new HDF5 file with the scene of source, to be filled with made-up data."""
    file = h5py.File(name, "w")
    with h5py.File(f"{source}.h5") as other:
        for key, value in other.attrs.items():
            file.attrs[key] = value
    return file


def check_map():
    """Checks a map whose growth is 1 + k drift - 0.2: its unstable points and its limits."""
    k, drift = numpy.linspace(0, 2, 9), numpy.linspace(0, 1, 5)
    growth = numpy.maximum(1, 1 + numpy.multiply.outer(k, drift) - 0.2)
    growth[8, 4] = numpy.inf
    growth[8, 3] = numpy.nan
    with made_up("map.h5") as file:
        file["map/courant"], file["map/drift"], file["map/growth"] = k, drift, growth
        file["map/beta"] = numpy.zeros_like(growth)
    with open("gas2.json", encoding="utf-8") as file:
        result = json.load(file)
    result["map"] = {"axes": ["courant", "drift"], "published_limit": 0.7071,
                     "unstable": int((growth > 1 + 1e-6).sum()), "corrected_limit": [1.5, None, None, None, None],
                     "courant": list(k), "drift": list(drift)}
    result["task"] = "map"
    with open("map.json", "w", encoding="utf-8") as file:
        json.dump(result, file)
    figure = pictures.growth_map("map.h5", "map.json")
    axes = figure.axes[0]
    mesh = axes.collections[0].get_array().reshape(9, 5)
    unstable = numpy.nan_to_num(growth, nan=1) > 1 + 1e-6
    check((numpy.ma.getmaskarray(mesh) == ~unstable).all(), "what is coloured is not what is unstable")
    finite = unstable & numpy.isfinite(growth)
    close(mesh[finite], growth[finite] - 1, "colours are not growth - 1")
    labels = axes.get_legend_handles_labels()[1]
    check(labels == ["undecided", "published limit at rest: k = 0.7071", "corrected limit: k = 1.5, at rest only"],
          f"{labels}")
    check(list(line(figure, "published")[1]) == [0.7071] * 2, "the published limit is elsewhere")
    x, y = line(figure, "corrected")
    check((x[0], y[0]) == (0, 1.5) and numpy.isnan(y[1:]).all(), "the corrected limit is elsewhere")
    close(numpy.transpose(line(figure, "undecided")), [[drift[3], k[8]]], "undecided points")
    check(f"{100 * unstable.sum() / 45:.1f}% of 45 points" in axes.get_title(), axes.get_title())
    check(len(pictures.growth_map("map.h5").axes[0].lines) == 1, "a limit that no file says")


def check_map_of_code():
    """A map of a code has its parameters as axes and its command under the picture. Another code is refused."""
    growth = numpy.array([[1, 1.5, 2], [1, 1, 1.25]])
    with h5py.File("code.h5", "w") as file:
        file.attrs.update({"program": "python3 mine.py", "program_set": "E=400", "tolerance": 1e-6})
        file["map/dt"], file["map/c"], file["map/growth"] = [0.1, 0.2], [1.0, 2, 3], growth
    for name, program in (("code", "python3 mine.py"), ("another", "python3 other.py")):
        with open(f"{name}.json", "w", encoding="utf-8") as file:
            json.dump({"task": "map", "program": program, "program_set": "E=400", "map": {
                "axes": ["dt", "c"], "dt": [0.1, 0.2], "c": [1, 2, 3], "unstable": 3, "phases": 64}}, file)
    figure = pictures.growth_map("code.h5", "code.json")
    axes, mesh = figure.axes[0], figure.axes[0].collections[0].get_array()
    close(mesh.compressed(), [0.5, 1, 0.25], "colours of a map of a code")
    said = axes.get_xlabel(), axes.get_ylabel(), figure._supxlabel.get_text()
    check(said == ("c (units of the code)", "dt (units of the code)", "program python3 mine.py, E=400"), f"{said}")
    check("50.0% of 6 points\n" in axes.get_title(), axes.get_title())
    check_refused(("map", "code.h5", "another.json"), "program python3 mine.py, E=400 and program python3 other.py, E=400")
    check_refused(("map", "code.h5", "gas2.json"), "gas2.json: is not a result of mpmstab")


def smallest_singular(z):
    """Returns the smallest singular value of z - J, where J is the Jordan block of size 2 at 1/2."""
    size = abs(z - 0.5) ** 2
    return numpy.sqrt((1 + 2 * size - numpy.sqrt(1 + 4 * size)) / 2)


def check_real_map():
    """Checks a map of the program: its undecided points must be marked, and its colours must be its growth."""
    SCENES["map"] = "-formulation gas2"  # the axes of a map take the place of the Courant number
    mpmstab(MPMSTAB, "map", "map", "-map_courant", "0.4,1.6", "-map_points", "7,33", "-output", "real.h5", "-json",
            "real.json", "-csv", "real.csv")
    rows = numpy.genfromtxt("real.csv", delimiter=",", names=True, dtype=None, encoding="utf-8")
    axes = pictures.growth_map("real.h5", "real.json", "real.csv").axes[0]
    with open("real.json", encoding="utf-8") as file:
        found = json.load(file)["map"]
    where = [[row["drift"], row["courant"]] for row in rows if row["verdict"] == "undecided"]
    check(len(where) == found["undecided"] > 0, f"{len(where)} undecided points, so this tests nothing")
    close(numpy.transpose(line(axes.figure, "undecided")), where, "undecided points")
    mesh = axes.collections[0].get_array().ravel()
    close(mesh.compressed(), [row["growth"] - 1 for row in rows if row["growth"] > 1 + 1e-6], "colours of a real map")
    check(f"{100 * found['unstable'] / 231:.1f}% of 231 points, of 16 waves at each" in axes.get_title(), axes.get_title())


def check_jordan():
    """Checks powers and pseudospectrum of the Jordan block of size 2 at 1/2."""
    block = numpy.array([[0.5, 1], [0, 0.5]])
    with open("gas2.json", encoding="utf-8") as file:
        result = json.load(file)
    norm = [float(numpy.linalg.norm(numpy.linalg.matrix_power(block, n), 2)) for n in range(12)]
    result["growth"] = 0.5
    result["transient"] = {"steps": list(range(12)), "norm": norm, "largest": max(norm),
                           "at_step": int(numpy.argmax(norm))}
    with open("jordan.json", "w", encoding="utf-8") as file:
        json.dump(result, file)
    figure = pictures.transient("jordan.json")
    close(line(figure, "norm")[1], norm, "norms")
    close(line(figure, "rho")[1], 0.5 ** numpy.arange(12), "powers of the spectral radius")
    check(f"largest: {max(norm):.4g} at step 1" in figure.axes[0].get_legend_handles_labels()[1], "largest norm")

    real, imaginary = numpy.linspace(-1.5, 1.5, 60), numpy.linspace(-1.4, 1.4, 60)
    sigma = smallest_singular(real[None, :] + 1j * imaginary[:, None])
    with made_up("jordan.h5") as file:
        file["pseudospectrum/re"], file["pseudospectrum/im"], file["pseudospectrum/sigma"] = real, imaginary, sigma
        file["spectrum/eigenvalues"] = numpy.array([[0.5, 0], [0.5, 0]])
    figure = pictures.pseudospectrum("jordan.h5")
    check(figure.axes[0].get_title().startswith("pseudospectrum: σ, the smallest singular value of z − A"), "its title")
    check(not figure.axes[0].texts, "labels in the picture, which may collide")
    z = complex(*(part[0] for part in line(figure, "kreiss")))
    outside = numpy.array([r + 1j * i for r in real for i in imaginary if abs(r + 1j * i) > 1])
    best = max((abs(outside) - 1) / smallest_singular(outside))
    check(math.isclose((abs(z) - 1) / smallest_singular(z), best, rel_tol=1e-12), f"Kreiss point at {z}")
    checked = 0
    for level in figure.axes[0].collections:
        lines = [path.vertices @ [1, 1j] for path in level.get_paths() if not level.get_facecolor().size]
        for z in [z for z in lines if len(z) and abs(z - 0.5).min() > 0.25]:  # nearer to it the logarithm is steep
            values = numpy.log10(smallest_singular(z))
            check(numpy.ptp(values) < 0.01, f"a contour runs from {values.min()} to {values.max()}")
            checked += 1
    check(checked >= 3, f"{checked} contours")
    close(line(figure, "eigenvalues")[0], [0.5, 0.5], "eigenvalues")


def check_real_powers():
    """Checks powers and pseudospectrum of the program. The Kreiss constant of a scheme that grows is infinite."""
    for name, grows in (("gas2", False), ("gas1", True)):
        mpmstab(MPMSTAB, "spectrum", name, "-powers", "60", "-pseudospectrum", "12", "-output",
                "powers.h5", "-json", "powers.json")
        with open("powers.json", encoding="utf-8") as file:
            result = json.load(file)
        figure = pictures.transient("powers.json")
        close(line(figure, "norm"), [result["transient"]["steps"], result["transient"]["norm"]], "norms of the program")
        close(line(figure, "rho")[1], result["growth"] ** line(figure, "rho")[0], "powers of growth")
        figure = pictures.pseudospectrum("powers.h5", "powers.json")
        labels = " ".join(figure.axes[0].get_legend_handles_labels()[1])
        check(("it is infinite" in labels) == grows, f"{name}: {labels}")
        if not grows:
            close([part[0] for part in line(figure, "kreiss")], result["pseudospectrum"]["kreiss_at"], "Kreiss point")


def main():
    mpmstab(MPMSTAB, "spectrum", "gas2", "-output", "gas2.h5", "-json", "gas2.json")
    check_map()
    check_map_of_code()
    check_real_map()
    check_jordan()
    check_real_powers()
    check_written("transient", ("largest:", "time step n"), "jordan.json")
    check_written("pseudospectrum", ("Kreiss point", "gas2, linear basis"), "jordan.h5")
    check_written("map", ("Courant number k = c dt / h", "drift U0 dt / h (cells per step)", "unstable at"), "map.h5", "map.json")
    square = numpy.eye(3)
    with made_up("square.h5") as file:
        file["map/courant"], file["map/drift"], file["map/growth"] = square[0], square[0], square + 1
    turned = {"axes": ["offset", "drift"], "offset": [0.5]}
    with open("map.json", encoding="utf-8") as file:
        result = json.load(file)
    for name, changes in (("shifted.json", {"courant": [0.1, *result["map"]["courant"][1:]]}), ("turned.json", turned)):
        with open(name, "w", encoding="utf-8") as file:
            json.dump({**result, "map": {**result["map"], **changes}}, file)
    for arguments, says in ((("map", "map.h5", "shifted.json"), "map.h5 and shifted.json: of different maps: courant"),
                            (("map", "map.h5", "turned.json"), "map.h5 and turned.json: of different maps: the first "
                                                               "has no axis offset"),
                            (("map", "map.h5", "gas2.json"), "the second is of the task spectrum"),
                            (("map", "gas2.h5"), "no /map/growth in it"), (("map", "square.h5"), "cannot be told"),
                            (("transient", "gas2.json"), "no 'transient' in it"),
                            (("map", "map.h5", "map.json", "real.csv"), "231 points in it"),
                            (("pseudospectrum", "gas2.h5"), "no /pseudospectrum/re in it")):
        check_refused(arguments, says)


if __name__ == "__main__":
    main()
