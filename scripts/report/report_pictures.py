"""Draws the pictures of a scene, each with words on what it shows."""
import os

import pictures
import report_html as html
from picture_runs import last_frame
from report_runs import dimension, each

CAPTIONS = {
    "spectrum": "Eigenvalues of the assembled operator, the unit circle that stable ones may not leave, the symbol's "
                "factors coloured by phase, and, where it covers the scene, the published prediction.",
    "symbol": "Growth of each wave: the symbol is exact, eigenvalues stand at the phase of their largest Fourier "
              "component; where published and corrected lie apart, the slides' formula fails.",
    "zone": "Growth of each wave over the phases of the directions: grey where nothing grows; circles at the fastest.",
    "damping": "How fast waves decay, and how far their frequency is off: at the scene's time step and at parts of it.",
    "frame": "Particles at the end of the run.",
    "modes": "The leading eigenmodes: what grows fastest, or in a stable scene what oscillates and decays most slowly.",
    "growth": "Size of the state as it was marched, and the growth that is predicted.",
    "spacetime": "A particle field, each value where its particle is.",
    "map": "Growth over Courant number and drift: what moves is not what rests.",
    "transient": "Norms of powers: how large a state can become before eigenvalues decide.",
    "pseudospectrum": "Where z - A is nearly singular: the further out, the more the powers grow first."}


def wanted(asker, answers):
    """Yields kind, function that draws, and alternative text of every picture that the answers allow."""
    def path(name):
        return asker.path(name)

    spectrum, symbol, run = (answers[name].done for name in ("spectrum", "symbol", "run"))
    result = answers["spectrum"].result if spectrum else answers["symbol"].result if symbol else answers["run"].result
    drift = ", ".join(map(str, each(result.get("drift"))))
    scheme = f"{result.get('formulation')}, Courant number {result.get('courant')}, drift {drift}"
    places = "x" if dimension(result) == 1 else "the plane"
    growth = f"largest growth {result.get('growth')} per step"
    if spectrum:
        yield ("spectrum", lambda: pictures.spectrum(path("spectrum.h5"), path("spectrum.json")),
               f"Eigenvalues of {scheme} in the complex plane with the unit circle; {growth}.")
    if symbol:
        extra = (path("spectrum.json"), path("spectrum.h5")) if spectrum else ()
        kind, phases = ("symbol", "phase") if dimension(result) == 1 else ("zone", "phases of all directions")
        yield (kind, lambda: pictures.symbol(path("symbol.h5"), *extra),
               f"Amplification factor over the {phases} for {scheme}; {growth}.")
    if "damping" in answers and answers["damping"].done:
        yield ("damping", lambda: pictures.damping(path("damping.h5")),
               f"Decay and frequency error of waves along x over their length, {scheme} and smaller time steps.")
    if "map" in answers and answers["map"].done:
        yield ("map", lambda: pictures.growth_map(path("map.h5"), path("map.json"), path("map.csv")),
               f"Growth over Courant number and drift for {result['formulation']}; unstable at "
               f"{answers['map'].result['map']['unstable']} points.")
    if run:
        extra = [path("spectrum.json")] if spectrum else []
        measured = answers["run"].result["run"].get("growth_measured")
        yield ("growth", lambda: pictures.growth([path("run.json"), *extra]),
               f"Size of the state over time steps for {scheme}; measured growth {measured} per step.")
    if "output" in answers and answers["output"].done and dimension(result) > 1:
        yield "frame", lambda: last_frame(path("output.h5")), f"Particles at the end of the run, {scheme}."
    elif "output" in answers and answers["output"].done:
        yield ("spacetime", lambda: pictures.spacetime(path("output.h5")),
               f"Particle values over place and time, {scheme}.")
    if spectrum:
        every = "transient" in answers and answers["transient"].done
        yield ("modes", lambda: pictures.modes(path("transient.h5" if every else "spectrum.h5")),
               f"The two leading eigenmodes over {places}, {scheme}.")
    if "transient" in answers and answers["transient"].done:
        found = answers["transient"].result
        if "transient" in found:
            yield ("transient", lambda: pictures.transient(path("transient.json")),
                   f"Norm of powers of the operator; the largest is {found['transient']['largest']}.")
        if "pseudospectrum" in found:
            yield ("pseudospectrum", lambda: pictures.pseudospectrum(path("transient.h5"), path("transient.json")),
                   f"Contours of the smallest singular value; Kreiss constant {found['pseudospectrum']['kreiss']}.")


def all_of(entry, album):
    """Returns the pictures as HTML, and words in place of a picture that cannot be drawn."""
    pieces = []
    for kind, draw, alt in wanted(entry["asker"], entry["answers"]):
        try:
            pieces.append(album.draw(f"{entry['name']}-{kind}", draw(), alt, html.escaped(CAPTIONS[kind])))
        except Exception as error:  # the other pictures and the page are still of use
            pieces.append(f'<p class="undecided">Picture of {kind}: not drawn: {html.escaped(error)}</p>')
    return f'<div class="pictures">\n{chr(10).join(pieces)}\n</div>' if pieces else "<p>Nothing to draw.</p>"


def of_work_precision(entry, album):
    """Returns the picture that work_precision.py has written, or nothing when there is none."""
    path = entry["asker"].path("work-precision.svg")
    if not os.path.exists(path):
        return ""
    caption = "Error against run time: time of the loop alone, error against the exact solution at the end."
    with open(path, "rb") as file:
        return album.add(f"{entry['name']}-work-precision", file.read(), "svg",
                         "Error over run time on log axes for three grids.", caption)
