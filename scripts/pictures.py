#!/usr/bin/python3
"""Draws what mpmstab has written, as NAME.png and NAME.svg.

  pictures.py spectrum SPECTRUM.h5 [RESULT.json]      eigenvalues, unit circle, the symbol's and the published factors
  pictures.py symbol SYMBOL.h5|CSV [SPECTRUM.h5] [RESULT.json]   abs(G) over the phase, in all columns that there are
  pictures.py damping SYMBOL.h5                       decay and frequency of waves over their length (symbol -damping)
  pictures.py modes SPECTRUM.h5                       the leading eigenmodes over x (-n: how many, --null-space: all)
  pictures.py growth RUN.json...                      size over steps, predicted growth dashed (RUN.csv lies beside)
  pictures.py spacetime RUN.h5 [FIELD]                a particle field over place and time
  pictures.py frames RUN.h5 -o FOLDER                 a picture for each output step, and movie.gif
  pictures.py map MAP.h5 [RESULT.json] [MAP.csv]      growth over two axes, with the limits and what is undecided
  pictures.py layout LAYOUT.csv [RESULT.json]         particles by their bound, the growing mode (critical -write_layout)
  pictures.py transient RESULT.json                   norm of the operator's powers (spectrum -powers)
  pictures.py pseudospectrum SPECTRUM.h5 [RESULT.json]   smallest singular value of z - A (spectrum -pseudospectrum)

The files are those that mpmstab writes for -output (.h5), -json and -csv. For other scripts, this module has a function
for each kind, which returns a figure.
"""
from program import Parser, end_in_one_line, refuse, require_outputs, say  # this import comes first: see there
import os
import warnings

from picture_damping import damping
from picture_files import Refusal
from picture_layout import layout
from picture_maps import growth_map, pseudospectrum, transient
from picture_modes import modes
from picture_process import run_apart
from picture_runs import frames, growth, spacetime
from picture_spectra import spectrum, symbol
from picture_style import names_of, save

KINDS = ("spectrum", "symbol", "modes", "growth", "spacetime", "frames", "map", "transient", "pseudospectrum",
         "damping", "layout")


def first_two(kind, paths):
    """Returns the file and its JSON (None when it is not given), for kinds that take no more."""
    if len(paths) > 2:
        raise Refusal(f"{paths[2]}: one file too many; allowed: {kind} FILE [RESULT.json]")
    return paths[0], paths[1] if len(paths) > 1 else None


def by_ending(kind, paths, endings):
    """Returns the files after the first by the parameter that their ending stands for, each ending once."""
    given = {}
    for path in paths[1:]:
        ending = path[path.rfind("."):]
        if ending not in endings or endings[ending] in given:
            raise Refusal(f"{path}: {kind} takes no more such file; allowed: one each of {' and '.join(endings)}")
        given[endings[ending]] = path
    return given


def draw(args):
    """Returns the figure, or None for frames, which have been written."""
    kind, paths = args.kind, args.files
    if kind == "symbol":
        return symbol(paths[0], **by_ending(kind, paths, {".h5": "spectrum_path", ".json": "result_path"}))
    if kind == "map":
        return growth_map(paths[0], **by_ending(kind, paths, {".json": "result_path", ".csv": "csv_path"}))
    if kind == "growth":
        return growth(paths, args.steps)
    if kind == "spacetime":
        if len(paths) > 2:
            raise Refusal(f"{paths[2]}: one too many; allowed: spacetime RUN.h5 [FIELD]")
        return spacetime(*paths)
    if kind in ("modes", "transient", "frames", "damping") and len(paths) > 1:
        raise Refusal(f"{paths[1]}: one file too many; allowed: {kind} FILE")
    if kind == "frames":
        frames(paths[0], args.output or "frames", tell=lambda words: print(f"pictures.py: {words}", flush=True))
        return None
    if kind == "modes":
        return modes(paths[0], args.number, args.null_space)
    if kind in ("transient", "damping"):
        return {"transient": transient, "damping": damping}[kind](paths[0])
    return {"spectrum": spectrum, "pseudospectrum": pseudospectrum, "layout": layout}[kind](*first_two(kind, paths))


def parse():
    parser = Parser(__doc__)
    parser.add_argument("kind", choices=KINDS)
    parser.add_argument("files", nargs="+", metavar="FILE")
    parser.add_argument("-o", "--output", metavar="NAME", help="what is written (by default the kind's name)")
    parser.add_argument("-n", "--number", type=int, choices=range(1, 5), default=2,
                        help="for modes: how many are drawn (2)")
    parser.add_argument("--null-space", action="store_true",
                        help="for modes: in a stable scene, also those that no node feels")
    parser.add_argument("-s", "--steps", type=int, help="for growth: the last step that is shown")
    args = parser.parse_args()
    if args.steps is not None and args.steps < 1:
        refuse(f"-s {args.steps}: allowed: 1 or more steps")
    args.inputs = args.files[:1] if args.kind == "spacetime" else args.files
    if args.kind != "frames":
        besides = [os.path.splitext(path)[0] + ".csv" for path in args.inputs] if args.kind == "growth" else []
        require_outputs(names_of(args.output or args.kind), [*args.inputs, *besides])
    return args


def draw_and_save(args):
    """Draws and writes. A damaged file may hold anything, so whatever fails in drawing is said of the files."""
    with warnings.catch_warnings(record=True) as noted:
        warnings.simplefilter("always")
        try:
            figure = draw(args)
            if figure:
                save(figure, args.output or args.kind)
        except Refusal as refusal:
            refuse(refusal)
        except Exception as error:
            if isinstance(error, OSError) and error.filename:
                raise  # a file cannot be written, which is said elsewhere
            why = f"{type(error).__name__}: {' '.join(str(error).split())}"
            refuse(f"{' or '.join(args.inputs)}: cannot be drawn ({why}); allowed: whole files of mpmstab")
    for message in {str(note.message) for note in noted if not issubclass(note.category, RuntimeWarning)}:
        say(f"warning: {message}")


def main():
    args = parse()
    run_apart(lambda: draw_and_save(args), args.inputs)


if __name__ == "__main__":
    end_in_one_line(main)
