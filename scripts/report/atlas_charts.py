"""Draws the charts of a scheme's page from the answers of the atlas."""
from fractions import Fraction

import svg_chart
from atlas_rows import COURANT, MACH

BANDS = [(1e-3, "#92C5DE", "below 0.001"), (1e-2, "#F4A582", "below 0.01"), (1e-1, "#D6604D", "below 0.1"),
         (float("inf"), "#67001F", "0.1 or more")]
STABLE, UNDECIDED = "#DDDDDD", "#FFFFFF"
BESIDE = (0.2, 1.0)  # Courant numbers of the map whose growth is drawn too
LEAST_GROWTH, LEAST_DECAY = 1e-6, 1e-12  # less is not growth, or is rounding


def above(value, least):
    """Returns a number, or 0, which is not drawn, where it is not known or not above the least."""
    return value if value and value > least else 0


def growth(answers, found):
    """Draws growth over velocity: that of all waves, and that of rows of the map."""
    series = [(f"k = {COURANT}, the largest of all that were looked at",
               [(float(Fraction(mach)), found[f"grows{number}"] or 0) for number, mach in enumerate(MACH)])]
    known = answers.get("map", {}).get("result", {}).get("map")
    for wanted in BESIDE if known else ():
        row = min(range(len(known["courant"])), key=lambda i: abs(known["courant"][i] - wanted))
        excess = known["excess"][row * len(known["mach"]):(row + 1) * len(known["mach"])]
        series.append((f"k = {known['courant'][row]:.3g}, of {known['phases']} waves",
                       [(mach, above(value, LEAST_GROWTH)) for mach, value in zip(known["mach"], excess)]))
    return svg_chart.lines("growth of moving particles (where there is no point: none)",
                           ("velocity U0 / c", "growth per step |G| − 1"), series)


def damping(answer):
    """Draws the decay of waves over their length."""
    found = answer["result"].get("symbol", {}).get("damping")
    if not found:
        return ""
    series = [(f"k = {courant:.4g}", [(length, above(value, LEAST_DECAY))
                                      for length, value in zip(found["wavelength"], decay)])
              for courant, decay in zip(found["courant"], found["decay"])]
    return svg_chart.lines("damping of waves at rest",
                           ("wavelength 2π / β (cells)", "decay rate r (c / h), amplitude exp(−r t)"), series)


def colour(excess, verdict):
    if verdict == "stable":
        return STABLE
    if verdict == "undecided" or excess is None:
        return UNDECIDED
    return next(colour for bound, colour, _ in BANDS if excess < bound or bound == float("inf"))


def growth_map(answer):
    """Draws growth over velocity and Courant number; without an answer there is nothing to draw."""
    found = (answer or {"result": {}})["result"].get("map")
    if not found:
        return ""
    colours = [colour(*point) for point in zip(found["excess"], found["verdict"])]
    across = len(found["mach"])
    rows = [colours[begin:begin + across] for begin in range(0, len(colours), across)]
    bands = [(f"growth per step |G| − 1 {words}", colour) for _, colour, words in BANDS]
    return svg_chart.boxes(f"growth over velocity and Courant number, of {found['phases']} waves",
                           ("velocity U0 / c", "Courant number k = c dt / h"), found["mach"], found["courant"], rows,
                           [("stable", STABLE), *bands, ("not decided", UNDECIDED)])
