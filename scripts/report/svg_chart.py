"""Draws small charts as SVG text: points over logarithmic axes, and maps of coloured boxes. It takes milliseconds."""
import base64
import html
import math
import struct
import zlib

WIDTH, HEIGHT = 560, 360
LEFT, RIGHT, TOP, BOTTOM = 84, 18, 34, 56  # margins around the axes
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")


class Axis:
    """Where numbers of an axis stand, between two ends in the picture; the first end is that of the least."""

    def __init__(self, low, high, begin, end, logarithmic=False):
        self.of = math.log10 if logarithmic else float
        self.logarithmic, self.begin, self.end = logarithmic, begin, end
        self.low, self.high = self.of(low), self.of(high)
        if self.high <= self.low:
            self.low, self.high = self.low - 0.5, self.high + 0.5

    def at(self, value):
        return self.begin + (self.of(value) - self.low) / (self.high - self.low) * (self.end - self.begin)

    def ticks(self):
        """Returns the numbers at ticks: powers of ten, with 2 and 5 between them where there are few, or round steps."""
        if self.logarithmic:
            powers = range(math.floor(self.low), math.ceil(self.high) + 1)
            skip = max(1, len(powers) // 7)
            parts = (1, 2, 5) if len(powers) < 5 else (1,)
            found = [part * 10.0**power for power in powers if power % skip == 0 for part in parts]
            return [value for value in found if self.low - 1e-9 <= math.log10(value) <= self.high + 1e-9]
        step = 10.0 ** math.floor(math.log10((self.high - self.low) / 4))
        step *= next(part for part in (1, 2, 5, 10) if (self.high - self.low) / (part * step) <= 6)
        first, last = math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9)
        return [number * step for number in range(first, last + 1)]


def text(x, y, words, anchor="middle", more=""):
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{more}>{html.escape(words)}</text>'


def tick(x, y, axis, value, anchor="middle"):
    """Returns a tick's number. On a logarithmic axis that leaves 1e-3 to 1e5 all are powers of ten, else all are plain."""
    words, raised = f"{value:.6g}", ""
    if axis.logarithmic and not -3 <= axis.low <= axis.high < 5:
        power = math.floor(math.log10(value) + 1e-9)
        part = round(value / 10.0**power)
        words = "10" if part == 1 else f"{part} × 10"
        raised = f'<tspan dy="-5" font-size="80%">{str(power).replace("-", "−")}</tspan>'
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{words}{raised}</text>'


def frame(title, x, y, labels):
    """Returns the title, the axes with ticks and grid lines, and the labels of both."""
    pieces = [text((x.begin + x.end) / 2, TOP - 14, title, more=' font-weight="600"')]
    for value in x.ticks():
        at = x.at(value)
        pieces += [f'<path d="M{at:.1f} {y.begin}V{y.end}" class="grid"/>', tick(at, y.begin + 18, x, value)]
    for value in y.ticks():
        at = y.at(value)
        pieces += [f'<path d="M{x.begin} {at:.1f}H{x.end}" class="grid"/>', tick(x.begin - 7, at + 4, y, value, "end")]
    pieces.append(f'<rect x="{x.begin}" y="{y.end}" width="{x.end - x.begin}" height="{y.begin - y.end}" class="box"/>')
    middle = (y.begin + y.end) / 2
    return pieces + [text((x.begin + x.end) / 2, y.begin + 40, labels[0]),
                     text(16, middle, labels[1], more=f' transform="rotate(-90 16 {middle:.1f})"')]


def picture(pieces, alt, height):
    return (f'<svg viewBox="0 0 {WIDTH} {height:.0f}" role="img" aria-label="{html.escape(alt)}">' + "".join(pieces) + "</svg>")


def legend(entries, top):
    """Returns the words of each colour, one below the other, and where they end."""
    pieces = []
    for number, (label, colour) in enumerate(entries):
        y = top + 20 * number
        pieces += [f'<rect x="{LEFT}" y="{y - 10:.0f}" width="14" height="11" fill="{colour}" stroke="#888888"/>',
                   text(LEFT + 20, y, label, "start")]
    return pieces, top + 20 * len(entries)


def lines(title, labels, series):
    """Draws series, each a label and points (x, y), over logarithmic axes. A point with y = 0 is left out, and ends the line
    before it. Without points words say so.
    """
    points = [point for _, some in series for point in some if point[1] > 0]
    if not points:
        return f'<p class="quiet">{html.escape(title)}: nothing above rounding.</p>'
    x = Axis(min(p[0] for _, some in series for p in some), max(p[0] for _, some in series for p in some),
             LEFT, WIDTH - RIGHT, True)
    y = Axis(min(p[1] for p in points), max(p[1] for p in points), HEIGHT - BOTTOM, TOP, True)
    pieces = frame(title, x, y, labels)
    for number, (_, some) in enumerate(series):
        drawn = [(x.at(p[0]), y.at(p[1])) if p[1] > 0 else None for p in some]
        path = "".join(f"{'L' if before else 'M'}{here[0]:.1f} {here[1]:.1f}"
                       for before, here in zip([None, *drawn], drawn) if here)
        pieces.append(f'<path d="{path}" fill="none" stroke="{COLOURS[number]}" stroke-width="1.5"/>' if path else "")
        pieces += [f'<circle cx="{here[0]:.1f}" cy="{here[1]:.1f}" r="3.5" fill="{COLOURS[number]}"/>' for here in drawn if here]
    below, end = legend([(label, COLOURS[number]) for number, (label, _) in enumerate(series)], HEIGHT + 6)
    return picture(pieces + below, title, end)


def png(rows):
    """Returns a PNG with a pixel for each colour of rows, '#rrggbb', the first row at the top."""
    raw = b"".join(b"\0" + b"".join(bytes.fromhex(colour[1:]) for colour in row) for row in rows)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b"")


def edges(values):
    half = (values[1] - values[0]) / 2
    return values[0] - half, values[-1] + half


def boxes(title, labels, x_values, y_values, colours, entries):
    """Draws a box for each pair of numbers, evenly spaced; colours has a row for each y, from the first on."""
    x = Axis(*edges(x_values), LEFT, WIDTH - RIGHT)
    y = Axis(*edges(y_values), HEIGHT - BOTTOM, TOP)
    data = base64.b64encode(png(colours[::-1])).decode()
    image = (f'<image x="{x.begin}" y="{y.end}" width="{x.end - x.begin}" height="{y.begin - y.end}" '
             f'preserveAspectRatio="none" style="image-rendering: pixelated" href="data:image/png;base64,{data}"/>')
    below, end = legend(entries, HEIGHT + 6)
    return picture([image, *frame(title, x, y, labels), *below], title, end)
