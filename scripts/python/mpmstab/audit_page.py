"""The page of an audit: one HTML file with its pictures inside, drawn without matplotlib."""
import base64
import math

import numpy

from .drawing import picture_module

BLUE, GREEN, ORANGE, GREY = "#0072B2", "#009E73", "#D55E00", "#888888"
DARK_TO_LIGHT = numpy.array([[0, 34, 78], [65, 77, 107], [124, 123, 120], [188, 175, 111], [254, 232, 56]])  # cividis
PIXELS, ARROWS, DOTS, ZOOM = 360, 250, 3000, 6  # ZOOM: cells around the particle that decides
STYLE = """<style>
svg { max-width: 46rem; width: 100%; height: auto; display: block; }
svg text { fill: currentColor; font-size: 13px; }
svg .grid { stroke: currentColor; stroke-opacity: 0.15; }
svg .box { fill: none; stroke: currentColor; stroke-opacity: 0.5; }
</style>"""


def colour(part):
    """The colour of a number from 0 to 1, light for large."""
    at = float(numpy.clip(part, 0, 1)) * (len(DARK_TO_LIGHT) - 1)
    low = min(int(at), len(DARK_TO_LIGHT) - 2)
    mixed = DARK_TO_LIGHT[low] + (at - low) * (DARK_TO_LIGHT[low + 1] - DARK_TO_LIGHT[low])
    return "#%02x%02x%02x" % tuple(int(round(c)) for c in mixed)


def bars(audit, chart):
    """The steps as bars from 0, and the person's own as a line."""
    rows = [(row.name, row.dt, BLUE if row.evidence == "proved" else GREEN) for row in audit.rows]
    rows += [("limit", audit.limit[1], GREY)] if audit.limit else []
    rows = [row for row in rows if math.isfinite(row[1])]
    own = audit.step
    high = 1.15 * max([dt for _, dt, _ in rows] + [own or 0])
    if not high > 0:
        return ""
    top, bottom = 34, 34 + 34 * len(rows)
    x = chart.Axis(0, high, chart.LEFT, chart.WIDTH - chart.RIGHT)
    pieces = []
    for value in x.ticks():
        at = x.at(value)
        pieces += [f'<path d="M{at:.1f} {top}V{bottom}" class="grid"/>', chart.text(at, bottom + 18, f"{value:.4g}")]
    for number, (name, step, fill) in enumerate(rows):
        y = top + 34 * number
        pieces += [f'<rect x="{x.begin}" y="{y + 6}" width="{x.at(step) - x.begin:.1f}" height="22" fill="{fill}"/>',
                   chart.text(x.begin - 7, y + 22, name, "end"),
                   f'<text x="{x.begin + 6}" y="{y + 22}" style="fill: #ffffff; font-weight: 600">{step:.4g}</text>']
    if own is not None:
        at = x.at(own)
        pieces += [f'<path d="M{at:.1f} {top - 6}V{bottom}" stroke="{ORANGE}" stroke-width="3" stroke-dasharray="7 4"/>',
                   chart.text(at, top - 12, f"your step {own:.4g}", "end" if own > high / 2 else "start")]
    pieces.append(chart.text((x.begin + x.end) / 2, bottom + 40, "time step, in the units of your columns (s)"))
    return chart.picture(pieces, "largest steps as bars, and yours as a line", bottom + 50)


def box_of(x):
    low, high = x.min(axis=0), x.max(axis=0)
    middle, half = (low + high) / 2, max((high - low).max() / 2 * 1.05, 1e-300)
    return middle - half, middle + half


def raster(x, values, low, high, scale):
    """A square of pixels as colours: the least value of the particles in each; what has none is transparent as white."""
    side = int(min(PIXELS, max(24, 1.2 * math.sqrt(len(x)))))
    column = numpy.minimum(((x[:, 0] - low[0]) / (high[0] - low[0]) * side).astype(int), side - 1)
    row = numpy.minimum(((x[:, 1] - low[1]) / (high[1] - low[1]) * side).astype(int), side - 1)
    least = numpy.full((side, side), numpy.inf)
    numpy.minimum.at(least, (side - 1 - row, column), values)
    return [["#ffffff" if not math.isfinite(v) else colour(scale(v)) for v in line] for line in least]


def scatter(x, values, title, ends, chart):
    """Particles in the plane, coloured by a value of each, yellow for large."""
    finite = values[numpy.isfinite(values)]
    small, large = float(finite.min()), float(finite.max())
    span = large - small or 1

    def scale(value):
        return (value - small) / span

    low, high = box_of(x)
    side = chart.HEIGHT - chart.BOTTOM - chart.TOP
    begin = (chart.WIDTH - side) / 2
    across = chart.Axis(low[0], high[0], begin, begin + side)
    up = chart.Axis(low[1], high[1], chart.HEIGHT - chart.BOTTOM, chart.TOP)
    if len(x) <= DOTS:
        radius = max(1.2, min(5, 110 / math.sqrt(len(x))))
        marks = [f'<circle cx="{across.at(a):.1f}" cy="{up.at(b):.1f}" r="{radius:.1f}" fill="{colour(scale(v))}"/>'
                 for (a, b), v in zip(x, values)]
    else:
        data = base64.b64encode(chart.png(raster(x, values, low, high, scale))).decode()
        marks = [f'<image x="{begin}" y="{chart.TOP}" width="{side}" height="{side}" preserveAspectRatio="none" '
                 f'style="image-rendering: pixelated" href="data:image/png;base64,{data}"/>']
    steps = 24
    for number in range(steps):
        marks.append(f'<rect x="{begin + side * number / steps:.1f}" y="{chart.HEIGHT - 2}" width="{side / steps + 0.5:.1f}" '
                     f'height="12" fill="{colour((number + 0.5) / steps)}"/>')
    marks += [chart.text(begin, chart.HEIGHT + 26, f"{ends[0]} {small:.3g}", "start"),
              chart.text(begin + side, chart.HEIGHT + 26, f"{ends[1]} {large:.3g}", "end")]
    return marks, chart.frame(title, across, up, ("x", "y")), across, up


def arrows(audit, across, up):
    """The velocities of the mode at the nodes where they are largest. In three dimensions x and y of them."""
    mode = audit.mode[0][:, :2]
    size = numpy.linalg.norm(mode, axis=1)
    chosen = numpy.argsort(size)[::-1][:ARROWS]
    index = numpy.stack([chosen % audit.at.shape[0], chosen // audit.at.shape[0] % audit.at.shape[1]], -1)
    place = audit.at.origin[:2] + index * audit.at.h[:2]
    length = 40 / size.max()
    pieces = []
    for (a, b), (u, v) in zip(place, mode[chosen]):
        if not (across.low <= a <= across.high and up.low <= b <= up.high and math.hypot(u, v) * length > 2):
            continue
        x, y = across.at(a), up.at(b)
        dx, dy = u * length, -v * length
        tip = f"M{x + dx:.1f} {y + dy:.1f}l{-0.3 * dx - 0.2 * dy:.1f} {-0.3 * dy + 0.2 * dx:.1f}m{0.4 * dy:.1f} {-0.4 * dx:.1f}l{0.3 * dx - 0.2 * dy:.1f} {0.3 * dy + 0.2 * dx:.1f}"
        pieces.append(f'<path d="M{x:.1f} {y:.1f}l{dx:.1f} {dy:.1f}{tip}" stroke="{ORANGE}" stroke-width="1.3" fill="none"/>')
    return pieces


def in_plane(audit, chart):
    x, share = audit.x[:, :2], audit.mode[1]
    marks, frame, _, _ = scatter(x, audit.own_steps, "step that the bound 'particle' allows each", ("least", "largest"), chart)
    pictures = [chart.picture(marks + frame, "particles coloured by their own step", chart.HEIGHT + 34)]
    if audit.mode[0] is not None:
        near = (numpy.abs(audit.x - audit.x[share.argmax()]) <= ZOOM * audit.at.h).all(axis=1)
        order = numpy.flatnonzero(near)[numpy.argsort(share[near])]
        marks, frame, across, up = scatter(x[order], share[order], "the mode that allows least: energies and velocities",
                                           ("energy", "largest"), chart)
        pictures.append(chart.picture(marks + frame + arrows(audit, across, up), "the mode that allows least", chart.HEIGHT + 34))
    return pictures


def on_line(audit, chart):
    order = numpy.argsort(audit.x[:, 0])
    x, steps, share = audit.x[order, 0], audit.own_steps[order], audit.mode[1][order]
    pictures = []
    for title, label, values in (("step that the bound 'particle' allows each", "step (s)", steps),
                                 ("who decides: energy in the mode that allows least", "share of the largest", share)):
        across = chart.Axis(x[0], x[-1], chart.LEFT, chart.WIDTH - chart.RIGHT)
        up = chart.Axis(0, float(values[numpy.isfinite(values)].max()) or 1, chart.HEIGHT - chart.BOTTOM, chart.TOP)
        every = max(1, len(x) // DOTS)
        marks = [f'<circle cx="{across.at(a):.1f}" cy="{up.at(v):.1f}" r="3" fill="{BLUE}"/>'
                 for a, v in list(zip(x, values))[::every] if math.isfinite(v)]
        pictures.append(chart.picture(chart.frame(title, across, up, ("x", label)) + marks, title, chart.HEIGHT))
    return pictures


def page(audit):
    from .audit import recommended, text_of, why

    html, chart = picture_module("report_html"), picture_module("svg_chart")
    rows = [[html.escaped(row.name), html.number(row.dt), html.escaped(row.evidence),
             f"{row.particle} at {', '.join(f'{a:.6g}' for a in audit.x[row.particle])}"] for row in audit.rows]
    if audit.limit:
        rows.append(["limit", html.number(audit.limit[1]), "beyond it disturbances grow", ""])
    rows.append(["anywhere", html.number(audit.lone_anywhere), "a particle that is alone later, at its worst place in a cell", ""])
    verdict = ""
    if audit.verdict:
        verdict = (f'<p class="verdict {audit.verdict}"><strong>{html.SIGNS[audit.verdict]} {audit.verdict}</strong>'
                   f"Your step {html.number(audit.step, '.6g')} = {html.escaped(audit.rule)}: {html.escaped(audit.reason)}.</p>")
    pictures = in_plane(audit, chart) if audit.at.dim > 1 else on_line(audit, chart)
    names = ", ".join(f"{name} = {value:.6g}" for name, value in audit.names.items() if name != "pi")
    body = f"""{STYLE}
<h1>Which step do these particles allow?</h1>
<p>{html.escaped('; '.join(audit.words))}. Scheme {html.escaped(audit.scheme)}, {html.escaped(audit.basis)} basis,
{html.escaped(audit.transfer)} transfer. {html.escaped(names)}.</p>
{verdict}
<p>Recommended: <strong>{html.number(recommended(audit), '.6g')}</strong>, {html.escaped(why(audit))}.</p>
<figure>{bars(audit, chart)}<figcaption>Blue: proved. Green: certified by a random start, with a small chance to be wrong. Grey: the limit,
beyond which disturbances grow.</figcaption></figure>
{html.table('largest steps', ['bound', 'largest step (s)', 'evidence', 'particle that decides'], rows, numeric=(1,))}
<div class="pictures">{''.join(f'<figure>{one}</figure>' for one in pictures)}</div>
<h2>What this page does not say</h2>
<p>All steps are for these particles where they are now, at rest, with small strains and the moduli of now. Walls that set velocities
of nodes do not make these steps smaller; contact by penalty may. Particles that move through the grid can make disturbances grow
slowly at any of these steps (ringing): the program mpmstab says how fast. When particles have moved, ask again, or take the
bounds in your loop with mpmstab.dt.</p>
<h2>The same as text</h2>
{html.preformatted(text_of(audit))}"""
    return html.page("mpmstab audit", body)
