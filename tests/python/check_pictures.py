#!/usr/bin/python3
"""Checks that pictures show what the files hold: drawn data against closed forms and files, and the words of SVGs.

check_pictures.py MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import math
import os
import subprocess
import sys

import h5py
import numpy
from PIL import Image
from matplotlib.backends.backend_agg import FigureCanvasAgg

from checks import check, check_one_line, loaded, run_script, text_of
import moving
import pictures
from picture_files import steps_of
from picture_moving import TITLES
from picture_runs import frame, predicted_of, through
from picture_scenes import attributes
from picture_spectra import published_factors
from picture_style import new_figure, plain_powers

SCENES = {"gas1": "-formulation gas1 -courant 0.5", "gas2": "-formulation gas2 -courant 0.5",
          "elastic": "-formulation elastic -courant 1", "drift": "-formulation gas2 -courant 0.1 -drift 1/8",
          "jitter": "-formulation gas2 -courant 0.5 -jitter 0.4 -seed 3", "pic": "-formulation gas2 -transfer pic"}


def close(one, other, message, tolerance=1e-9):
    one, other = numpy.asarray(one), numpy.asarray(other)
    check(one.shape == other.shape and numpy.allclose(one, other, rtol=tolerance, atol=tolerance), message)


def distance(one, other):
    return max(abs(other - value).min() for value in one)


def mpmstab(program, task, name, *options):
    cells = () if "-cells" in options else ("-cells", "16")
    command = [program, task, *SCENES[name].split(), *cells, *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    check(done.returncode == 0, f"{' '.join(command)}: {done.stderr}")


def line(figure, gid):
    """Returns the points of all lines with this name."""
    found = [drawn for axes in figure.axes for drawn in axes.lines if drawn.get_gid() == gid]
    check(len(found) > 0, f"nothing is drawn as {gid}")
    return [numpy.asarray(numpy.concatenate([drawn.get_data()[part] for drawn in found]), float) for part in (0, 1)]


def make(program):
    for name in SCENES:
        mpmstab(program, "spectrum", name, "-output", f"{name}.h5", "-json", f"{name}.json")
    for name in ("gas1", "drift"):
        mpmstab(program, "symbol", name, "-output", f"{name}-symbol.h5", "-csv", f"{name}-symbol.csv")
        start = ["-initial", "random"] if name == "drift" else ["-initial", "mode", "-mode", "4"]
        mpmstab(program, "run", name, *start, "-steps", "120", "-output", f"{name}-run.h5", "-output_every", "40",
                "-json", f"{name}-run.json", "-csv", f"{name}-run.csv")


def check_spectrum():
    """Checks that eigenvalues, symbol and published factors are drawn where file and formula say."""
    for name in SCENES:
        figure = pictures.spectrum(f"{name}.h5", f"{name}.json")
        real, imaginary = line(figure, "eigenvalues")
        values = real + 1j * imaginary
        with h5py.File(f"{name}.h5") as file:
            close(values, file["spectrum/eigenvalues"][:] @ [1, 1j], f"{name}: drawn eigenvalues are not the file's")
            published = file["symbol/published"][:] if "symbol" in file else numpy.array([numpy.nan])
            beta, k = file["symbol/beta"][:] if "symbol" in file else None, file.attrs["courant"]
        clouds = figure.axes[0].collections
        check(len(clouds) == (name != "jitter"), f"{name}: {len(clouds)} clouds")
        if clouds:
            factors = clouds[0].get_offsets() @ [1, 1j]
            apart = max(distance(values, factors), distance(factors, values))
            check(apart < 1e-6, f"{name}: symbol and eigenvalues are {apart} apart")
        if name == "gas2":
            check(abs(abs(values) - 1).max() < 1e-6, "eigenvalues of gas2 leave the unit circle")
        covered = numpy.isfinite(published).any()
        check(covered == (name in ("gas1", "gas2", "elastic")), f"{name}: published formula")
        drawn = [d for d in figure.axes[0].lines if d.get_gid() == "published"]
        check(len(drawn) == 2 * covered, f"{name}: {len(drawn)} published curves")
        if covered:
            close(abs(published_factors(name, k, beta)).max(axis=0), published, f"{name}: the published factor", 1e-7)
        growth = f"growth {loaded(f'{name}.json')['growth']:.9g} per step"
        title = figure.axes[0].get_title()
        check(growth in title and ("a period of 8 steps" in title) == (name == "drift"), f"{name}: {title}")


def check_symbol():
    k = 0.5
    for path in ("gas1-symbol.h5", "gas1-symbol.csv"):
        figure = pictures.symbol(path, "gas1.json", "gas1.h5")
        for column, factor in (("published", 4), ("corrected", 1), ("symbol", 1)):
            beta, size = line(figure, column)
            close(size, numpy.sqrt(1 + factor * (k * numpy.sin(beta)) ** 2), f"{path}: {column}", 1e-7)
    measured = [d.get_ydata()[0] for d in figure.axes[0].lines if str(d.get_label()).startswith("measured")]
    check(measured == [loaded("gas1.json")["run"]["growth_measured"]], f"measured growth {measured}")
    beta, size = line(figure, "eigenvalues")
    with h5py.File("gas1.h5") as file:
        check(len(beta) == numpy.isfinite(file["spectrum/beta"][:]).sum() > 10, f"{len(beta)} eigenvalues by phase")
    close([size.min(), size.max()], [1, math.sqrt(1.25)], "eigenvalues by phase", 1e-6)
    seen = numpy.genfromtxt("gas1-symbol.csv", delimiter=",", names=True)
    check(len(seen["growth_seen"]) == 9, "growth of nodal values is not in the CSV: this tests nothing")
    close(line(pictures.symbol("gas1-symbol.h5"), "growth_seen"), [seen["beta"], seen["growth_seen"]], "nodal values")
    _, size = line(pictures.symbol("drift-symbol.h5", None, "drift.h5"), "eigenvalues")
    check(math.isclose(size.max(), loaded("drift.json")["growth"], rel_tol=1e-9), "growth of a period is not per step")


def hashed(seed, particle):
    """Returns the random number of a particle by splitmix64, as in docs/theory.md."""
    word = 2**64 - 1
    z = (seed + (particle + 1) * 0x9E3779B97F4A7C15) & word
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & word
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & word
    return ((z ^ (z >> 31)) >> 11) * 2.0**-53


def check_modes():
    """Checks places by the formula of the layout, values by the file, and the growth in the title."""
    places = [(g // 2 + (g % 2 + 0.5 + 0.4 * (hashed(3, g) - 0.5)) / 2) / 16 for g in range(32)]
    figure = pictures.modes("jitter.h5", 2)
    with h5py.File("jitter.h5") as file:
        close(file["modes/coordinates"][:], places, "places of a jittered layout", 1e-14)
        for field in "ur":
            for what in ("re", "im"):
                x, values = line(figure, f"0001/{field}_{what}")
                order = numpy.argsort(places)
                close(x, numpy.array(places)[order], "places under a mode")
                close(values, file[f"modes/0001/{field}_{what}"][:][order], f"{field}_{what} of mode 1")
        growth = file["modes/0001"].attrs["growth"]
        pair = file["modes/0001"].attrs["im"] != 0
    check(f"mode 1\ngrowth {growth:.9g}\n" in figure.axes[0].get_title(), figure.axes[0].get_title())
    check(figure.axes[1].get_title().startswith(f"mode {3 if pair else 2}\n"), "of a pair both are shown, or none")


def check_idle():
    """In a stable scene the modes that oscillate are drawn, the longest wave first, and idle ones where they are asked for."""
    mpmstab(sys.argv[1], "spectrum", "gas2", "-modes", "64", "-measure", "false", "-output", "all.h5")
    with h5py.File("all.h5") as file:
        values, beta = file["spectrum/eigenvalues"][:] @ [1, 1j], file["spectrum/beta"][:]
    check(abs(values[0] - 1) < 1e-6, "the first mode is not idle: this tests nothing")
    titles = [axes.get_title() for axes in pictures.modes("all.h5", 2).axes[:2]]
    drawn = [int(title.split()[1]) - 1 for title in titles]
    check(all(abs(values[one] - 1) > 0.1 and abs(beta[one] - math.pi / 8) < 1e-9 for one in drawn), f"{titles}")
    check(pictures.modes("all.h5", 1, True).axes[0].get_title().startswith("mode 1\n"), "an idle mode is left out")


def check_plain_ticks():
    """A logarithmic axis over less than a decade must have plain numbers, small ones powers of ten, and none has both."""
    for low, high, wanted, other in ((1, 1.03, "1.0", "10^"), (1e-7, 1e-2, "10^{-5}", "0.0"),
                                     (0.2, 2e5, "10^{4}", "10000"), (0.2, 2e4, "10000", "10^")):
        figure = new_figure(3, "")
        axes = figure.add_subplot(yscale="log", ylim=(low, high))
        plain_powers(axes.yaxis)
        figure.draw(FigureCanvasAgg(figure).get_renderer())
        texts = [text.get_text() for which in ("major", "minor") for text in axes.get_yticklabels(which=which)]
        check(any(wanted in text for text in texts) and not any(other in text for text in texts), f"{texts}")


def check_moving():
    """The picture says that a scheme without a point does not grow: each of its schemes must be on all of its panels."""
    named = {scheme[:2] for scheme in moving.SMALLER}
    check({(*name, basis) for name in named for basis in TITLES} == set(moving.SMALLER), "a panel lacks a scheme")


def check_room():
    """The titles of four modes must not overlap, and their columns must stand at equal distances."""
    figure = pictures.modes("drift.h5", 4)
    renderer = FigureCanvasAgg(figure).get_renderer()
    figure.draw(renderer)
    top = figure.axes[:4]
    titles = [axes.title.get_window_extent(renderer) for axes in top]
    check(all(one.x1 < other.x0 for one, other in zip(titles, titles[1:])), "titles of modes meet")
    left = [axes.get_position().x0 for axes in top]
    close(numpy.diff(left), numpy.full(3, left[1] - left[0]), "columns of modes stand apart by chance", 1e-3)


def check_growth():
    """Sizes must be those of the CSV. The predicted slope is the corrected growth, under drift that of the spectrum."""
    figure = pictures.growth(["gas1-run.json", "drift-run.json", "drift.json"])
    for number, growth in ((0, math.sqrt(1.25)), (1, None)):
        if growth is None:
            growth = loaded("drift.json")["growth"]
        steps, predicted = line(figure, f"predicted{number}")
        slope = numpy.log(predicted[1:] / predicted[:-1]) / numpy.diff(steps)
        close(slope, numpy.full(len(steps) - 1, math.log(growth)), f"predicted slope of run {number}", 1e-9)
    rows = numpy.genfromtxt("gas1-run.csv", delimiter=",", names=True)
    steps, size = line(figure, "run0")
    close(steps, rows["step"], "steps")
    close(size, numpy.sqrt(rows["energy"] / rows["energy"][0]), "sizes")
    check(figure.axes[0].get_yscale() == "log", "growth on a linear axis")
    late = 3 * 1.1 ** numpy.arange(10, 20)
    close(through(numpy.arange(20), numpy.append(numpy.ones(10), late), 1.1)[10:], late, "late steps are not met")
    run, same, other = map(loaded, ("drift-run.json", "drift.json", "jitter.json"))
    check(predicted_of(run, [other, same]) == same["spectrum"]["growth"], "predicted by another scene's spectrum")
    check(predicted_of(run, [other]) is None, "predicted by another scene's spectrum")


def check_spacetime():
    """The value of each particle must be drawn over an interval that it lies in, also when it drifts."""
    figure = pictures.spacetime("drift-run.h5", "u")
    picture = figure.axes[0].collections[0]
    boxes = numpy.array([path.vertices[:4] for path in picture.get_paths()])
    with h5py.File("drift-run.h5") as file:
        steps = sorted(name for name in file if name.startswith("step_"))
        x = numpy.concatenate([file[step]["particles/coordinates"][:, 0] for step in steps])
        values = numpy.concatenate([file[step]["particles/u"][:] for step in steps])
        times = numpy.repeat([float(file[step].attrs["step"]) for step in steps], 32)
    close(picture.get_array(), values, "colours are not the values")
    check((boxes[:, 0, 0] <= x).all() and (x <= boxes[:, 1, 0]).all(), "particles are not where they are drawn")
    check(figure.axes[1].get_ylabel() == "velocity u (length / time)", "colours are not said to be the values")
    check((boxes[:, 0, 1] <= times).all() and (times <= boxes[:, 2, 1]).all(), "steps are not where they are drawn")
    close((boxes[:, 1, 0] - boxes[:, 0, 0]).reshape(len(steps), -1).sum(axis=1), numpy.ones(len(steps)), "gaps in x")


def check_own_scale():
    """A run that grows by orders of magnitude must be drawn relative to the largest value of each step."""
    figure = pictures.spacetime("gas1-run.h5", "u")
    values = numpy.reshape(figure.axes[0].collections[0].get_array(), (4, 32))
    close(abs(values).max(axis=1), numpy.ones(4), "steps have one scale")
    with h5py.File("gas1-run.h5") as file:
        last = steps_of(file)[-1][1]["particles/u"][:]
    close(values[-1], last / abs(last).max(), "relative values")
    check("its largest value at that step" in figure.axes[1].get_ylabel(), figure.axes[1].get_ylabel())


def check_frames():
    names = pictures.frames("drift-run.h5", "drift-frames")
    wanted = [f"step_{step:010d}.png" for step in (0, 40, 80, 120)] + ["movie.gif"]
    check(names == [os.path.join("drift-frames", name) for name in wanted], f"frames {names}")
    check(sorted(os.listdir("drift-frames")) == sorted(wanted), "files of the frames")
    with Image.open("drift-frames/movie.gif") as movie:
        check(movie.n_frames == 4, f"{movie.n_frames} frames")
    with h5py.File("drift-run.h5") as file:
        step, group = steps_of(file)[2]
        figure = frame(attributes(file), step, group, ["u", "r"], {"u": None, "r": 1})
        x, values = line(figure, "particles/u")
        order = numpy.argsort(group["particles/coordinates"][:, 0])
        close(x, group["particles/coordinates"][:, 0][order], "places of a frame")
        close(values, group["particles/u"][:][order], "particles of a frame")
        x, values = line(figure, "nodes/r")
        close(x, numpy.arange(16) / 16, "nodes' places")
        close(values, group["nodes/r"][:], "nodes of a frame")


def check_written(kind, says, *paths):
    """Draws a picture and checks that both files are whole and have these texts."""
    done = run_script("pictures.py", kind, *paths, "-o", f"out-{kind}")
    check(done.returncode == 0 and not done.stderr, f"{kind}: {done.stderr}")
    for text in says:
        check(f">{text}" in text_of(f"out-{kind}.svg"), f"'{text}' is not on the picture {kind}")
    with Image.open(f"out-{kind}.png") as picture:
        check(picture.width == 960 and len(picture.convert("L").getcolors()) > 20, f"{kind}: an empty picture")
    check(not [name for name in os.listdir(".") if name.endswith(".part")], "a .part is left")


def check_refused(arguments, says, **how):
    """Runs pictures.py, which must refuse in one line with status 2."""
    done = run_script("pictures.py", *arguments, **how)
    check_one_line(done, arguments, says)
    check(done.stderr.startswith("pictures.py: ") and " allowed: " in done.stderr, f"{arguments}: {done.stderr}")


def check_command():
    """Both files of each kind must be written and name their scene."""
    footer = ("gas2, linear basis, flip, k = 0.1, drift 1/8 (cells per step)",
              "16 cells, 2 particles a cell, offset 0.5, ends periodic")
    for kind, says, *paths in (("spectrum", footer, "drift.h5", "drift.json"), ("modes", footer, "drift.h5"),
                               ("symbol", footer, "drift-symbol.h5", "drift.h5", "drift.json"),
                               ("spacetime", footer, "drift-run.h5", "r"),
                               ("growth", ("gas2, linear basis, flip",), "drift-run.json")):
        check_written(kind, says, *paths)
    before = text_of("out-modes.svg")
    run_script("pictures.py", "modes", "drift.h5", "-o", "out-modes")
    check(text_of("out-modes.svg") == before, "the same file gives another picture")


def main(program):
    make(program)
    for one in (check_spectrum, check_symbol, check_modes, check_idle, check_plain_ticks, check_moving, check_room, check_growth,
                check_spacetime, check_own_scale, check_frames, check_command):
        one()


if __name__ == "__main__":
    main(sys.argv[1])
