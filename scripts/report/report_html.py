"""Makes pieces of HTML: numbers that keep their full precision, tables that scroll, pictures inside the page."""
import base64
import html
import os
import re
import urllib.parse

from whole_files import write_whole

LARGEST_SVG = 400_000  # bytes; a larger picture is embedded as PNG
SIGNS = {"stable": "✓", "unstable": "✗", "undecided": "?"}


def escaped(text):
    return html.escape(str(text))


def number(value, form=".9g"):
    """Returns a number for people, with all its digits for programs, or a dash for None."""
    if value is None:
        return "-"
    return f'<data value="{value!r}">{value:{form}}</data>'


def badge(verdict, word=None):
    """Returns a verdict, or other words in its colours."""
    return f'<span class="badge {verdict}">{SIGNS[verdict]} {word or verdict}</span>'


def table(label, head, rows, numeric=()):
    """Returns a table in a box that scrolls and can be reached by keyboard. Its cells are HTML."""
    def cell(tag, column, text):
        return f'<{tag}{" class=number" if column in numeric else ""}>{text}</{tag}>'

    def line(tag, texts):
        return "<tr>" + "".join(cell(tag, column, text) for column, text in enumerate(texts)) + "</tr>"

    body = "\n".join(line("td", row) for row in rows)
    top = f"<thead>{line('th', head)}</thead>\n" if head else ""
    return (f'<div class="scroll" role="region" tabindex="0" aria-label="{escaped(label)}">\n<table>\n'
            f"{top}<tbody>\n{body}\n</tbody>\n</table>\n</div>")


def preformatted(text):
    return f'<pre tabindex="0">{escaped(text)}</pre>'


def command(text):
    """Returns a command that wraps between its words, with a button that copies it."""
    words = re.sub(r"\S+", r'<span class="word">\g<0></span>', escaped(text))
    return (f'<div class="command"><button type="button" class="copy">Copy</button>'
            f'<pre><code>{words}</code></pre></div>')


class Album:
    """Puts pictures into the page, and saves each in a folder beside it."""

    def __init__(self, page):
        self.folder = os.path.splitext(page)[0] + "-pictures"

    def add(self, name, data, kind, alt, caption):
        """Saves the bytes of a picture, embeds them, and links to the file. A tap opens the picture large."""
        file = f"{name}.{kind}"
        write_whole(os.path.join(self.folder, file), data)
        mime = {"svg": "image/svg+xml", "png": "image/png"}[kind]
        source = f"data:{mime};base64,{base64.b64encode(data).decode()}"
        link = escaped(urllib.parse.quote(f"{os.path.basename(self.folder)}/{file}"))
        return (f'<figure><button type="button" class="enlarge" title="Enlarge"><img src="{source}" alt="{escaped(alt)}">'
                f'</button><figcaption>{caption} <a href="{link}">{kind.upper()}</a></figcaption></figure>')

    def draw(self, name, figure, alt, caption):
        from picture_style import encoded  # here: pages that draw by themselves need no matplotlib

        data, kind = encoded(figure, "svg"), "svg"
        if len(data) > LARGEST_SVG:
            data, kind = encoded(figure, "png"), "png"
        return self.add(name, data, kind, alt, caption)


def asset(name):
    """Returns a file of this folder that goes into pages."""
    with open(os.path.join(os.path.dirname(os.path.abspath(__file__)), name), encoding="utf-8") as file:
        return file.read()


def page(title, body):
    return (f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
            '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
            f'<link rel="icon" href="data:,">\n<title>{escaped(title)}</title>\n<style>\n{asset("report.css")}</style>\n</head>\n'
            f'<body>\n{body}\n<script>\n{asset("page.js")}</script>\n</body>\n</html>\n')
