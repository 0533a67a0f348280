"""Takes the numbers of a row out of the answers to its questions, and says what they are.

A number is None where it is not known: the program has not decided it, or was stopped. A limit may be math.inf: no
Courant number is unstable.
"""
import math

from atlas_rows import CELLS, COURANT, MACH, PERIODS, PLACES, velocity


class Column:
    """A column of the table: its key, the question that has its number, its head, what it is, and how it is written.

    derived: it is the least or the largest of other columns.
    """

    def __init__(self, key, question, head, meaning, form, derived=False):
        self.key, self.question, self.head, self.meaning, self.form = key, question, head, meaning, form
        self.derived = derived


PLACED = {"bulk": "where particles fill space", "edge": "at a free surface", "lone": "of a particle with nothing around it"}
COLUMNS = [
    *(Column(place, question, f"limit, {place}", f"largest stable Courant number k = c dt / h at rest, {PLACED[place]}",
             "{:.5g}") for place, question in PLACES.items()),
    Column("least", "", "limit, least", f"the least of the limits in {', '.join(PLACES)}", "{:.5g}", True),
    *(Column(f"grows{number}", f"moving {mach}", f"growth, {velocity(mach)}",
             f"growth − 1 per step when particles move at U0 = {velocity(mach)}, k = {COURANT}; 0: at most 1e-6",
             "{:.2g}")
      for number, mach in enumerate(MACH)),
    Column("worst", "", "growth, worst", "the largest of these growths", "{:.2g}", True),
    Column("kept", "damping", "amplitude kept",
           f"part of its amplitude that a wave of {CELLS} cells keeps over {PERIODS} periods, at rest, k = {COURANT}",
           "{:.4g}"),
    Column("phase", "damping", "periods early",
           f"by how many periods that wave is early (late: negative) after {PERIODS} periods", "{:.2f}")]


def limits(answers):
    found = {}
    for place, question in PLACES.items():
        places = answers[question]["result"].get("critical", {}).get("neighbourhoods", {})
        one = places.get(place, {"undecided": "there is no answer"})
        known = "critical_courant" in one or "undecided" not in one
        found[place] = one.get("critical_courant", math.inf) if known else None
    found["least"] = None if None in found.values() else min(found.values())
    return found


def growth(answer):
    """Returns growth - 1 per step; 0 where it is stable."""
    result = answer["result"]
    return {"stable": 0.0, "unstable": result.get("growth", math.nan) - 1}.get(result.get("verdict"))


def wave(answer):
    found = answer["result"].get("symbol", {}).get("damping")
    if not found or CELLS not in found["wavelength"]:
        return {"kept": None, "phase": None}
    at = found["wavelength"].index(CELLS)
    decay, error = found["decay"][0][at], found["frequency_error"][0][at]
    return {"kept": None if decay is None else math.exp(min(700, -decay * CELLS * PERIODS)),
            "phase": None if error is None else error * PERIODS}


def numbers_of(answers):
    """Returns the numbers of a row by the keys of the columns."""
    found = {**limits(answers), **wave(answers["damping"])}
    for number, mach in enumerate(MACH):
        found[f"grows{number}"] = growth(answers[f"moving {mach}"])
    grows = [found[f"grows{number}"] for number in range(len(MACH))]
    known = [value for value in grows if value is not None]
    found["worst"] = max(known) if known and (None not in grows or max(known) > 0) else None
    return found


def written(column, value):
    """Returns a number for people."""
    if value is None:
        return "?"
    return "none" if value == math.inf else "0" if value == 0 else column.form.format(value)
