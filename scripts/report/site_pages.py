#!/usr/bin/python3
"""Prepares the pages of the project as a source of mkdocs: site_pages.py FOLDER. scripts/site.sh runs it.

Pages are taken as they are, with the files that they link to. Only links to folders become links to the folder's page, or
lists of its files. Added are a page for each public header, and the limits of all schemes as a table that can be searched
and sorted, where build/mpmstab is built; and the atlas, where the folder atlas/ has one.
"""
import csv
import html
import os
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
LINK = re.compile(r"(\]\()([^)\s#:]+)((?:#[^)]*)?\))")
NAVIGATION = [("Start", ["README.md", "INSTALL.md", "docs/glossary.md", "CHANGELOG.md"]),
              ("Questions", ["docs/limits.md", "limits-table.md", "docs/step-rules.md", "docs/ringing.md", "docs/ringing-tables.md",
                             "docs/damping.md", "docs/remedies.md", "docs/work-precision.md", "docs/floors.md", "docs/scenes.md",
                             "docs/spectra.md", "docs/extremes.md", "docs/slides.md"]),
              ("Reference", ["docs/reference.md", "docs/theory.md", "docs/pictures.md", "docs/verification.md", "docs/related-work.md"])]
CONFIG = """site_name: mpmstab
docs_dir: pages
use_directory_urls: false
theme:
  name: material
  font: false
  features: [navigation.sections, navigation.top, content.code.copy]
  palette:
    - {media: "(prefers-color-scheme: light)", scheme: default, toggle: {icon: material/weather-night, name: dark}}
    - {media: "(prefers-color-scheme: dark)", scheme: slate, toggle: {icon: material/weather-sunny, name: light}}
plugins: [search]
extra_css: [print.css]
markdown_extensions: [tables, attr_list, fenced_code, admonition, toc, sane_lists]
validation: {omitted_files: ignore, not_found: warn, anchors: warn, unrecognized_links: warn, absolute_links: warn}
"""
PRINT = """/* On paper nothing scrolls: wide tables become small, and pictures stay on one page. */
@media print {
  .md-typeset img { max-height: 22cm; width: auto; break-inside: avoid; }
  .md-typeset .md-typeset__scrollwrap, .md-typeset .md-typeset__table { display: block; margin: 0; overflow: visible; padding: 0; }
  .md-typeset table:not([class]) { display: table; font-size: 0.5rem; overflow: visible; width: 100%; }
  .md-typeset table:not([class]) th, .md-typeset table:not([class]) td { min-width: 0; overflow-wrap: anywhere; padding: 0.3em 0.4em; }
  .md-typeset table code { font-size: inherit; overflow-wrap: anywhere; padding: 0; }
  .md-typeset tr { break-inside: avoid; }
  .md-typeset pre > code { font-size: 0.5rem; white-space: pre-wrap; }
}
"""
TABLE = """# Limits of all schemes, as a table

The largest stable Courant numbers c dt / h of lattices at rest, in one dimension, with particles in the middles of their shares of the cell
(`-offset 0.5`). `0`: the scheme grows at every one. Other layouts can have smaller limits ([limits](docs/limits.md)). *Growth* and other words are
in the [glossary](docs/glossary.md). Type words to search, such as `musl quadratic`; a click on a heading sorts; a click on a
row fills the command.

<input id="wanted" type="search" aria-label="search" placeholder="musl quadratic" style="border: 1px solid; padding: 0.3rem; width: 16rem">

<p><code id="command">mpmstab critical</code></p>

<table id="limits"><thead><tr>HEAD</tr></thead><tbody>
ROWS
</tbody></table>

<script>
(function () {
  "use strict";
  const table = document.getElementById("limits"), body = table.tBodies[0], wanted = document.getElementById("wanted");
  function show() {
    const words = wanted.value.toLowerCase().split(/\\s+/);
    for (const row of body.rows) row.hidden = !words.every(word => row.textContent.toLowerCase().includes(word));
  }
  wanted.addEventListener("input", show);
  Array.from(table.tHead.rows[0].cells).forEach(function (cell, column) {
    let up = 1;
    cell.firstElementChild.addEventListener("click", function () {
      const value = row => row.cells[column].dataset.value;
      Array.from(body.rows).sort(function (a, b) {
        const x = value(a), y = value(b), numbers = Number(x) - Number(y);
        return up * (isNaN(numbers) ? x.localeCompare(y) : numbers);
      }).forEach(row => body.append(row));
      up = -up;
    });
  });
  body.addEventListener("click", function (event) {
    const row = event.target.closest("tr");
    if (row) document.getElementById("command").textContent = row.dataset.command;
  });
  wanted.value = decodeURIComponent(location.hash.slice(1));
  show();
})();
</script>
"""


def listed():
    """The files of the project."""
    done = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=False)
    names = done.stdout.split("\n") if done.returncode == 0 else [
        os.path.relpath(os.path.join(folder, name), ROOT) for folder, _, found in os.walk(ROOT) for name in found
        if not os.path.relpath(folder, ROOT).startswith("build")]
    return [name for name in names if name and not name.startswith((".", "docs/paper/"))]  # a paper has headings of its own kind


def copy(name, pages):
    target = os.path.join(pages, name)
    os.makedirs(os.path.dirname(target), exist_ok=True)
    if not os.path.exists(target):
        shutil.copyfile(os.path.join(ROOT, name), target)


def folder_page(name, pages):
    """A list of the files of a folder that has no page."""
    files = sorted(os.listdir(os.path.join(ROOT, name)))
    if os.path.exists(os.path.join(pages, name, "README.md")):
        return
    os.makedirs(os.path.join(pages, name), exist_ok=True)
    with open(os.path.join(pages, name, "README.md"), "w", encoding="utf-8") as file:
        file.write(f"# {name}\n\n" + "".join(f"- `{one}`\n" for one in files))


def linked(page, pages):
    """Takes a page with its links to folders and files."""
    here = os.path.dirname(page)

    def target(match):
        name = os.path.normpath(os.path.join(here, match.group(2)))
        if os.path.isdir(os.path.join(ROOT, name)):
            if not os.path.exists(os.path.join(ROOT, name, "README.md")):
                folder_page(name, pages)
            return f"{match.group(1)}{match.group(2).rstrip('/')}/README.md{match.group(3)}"
        if not name.endswith(".md") and os.path.isfile(os.path.join(ROOT, name)):
            copy(name, pages)
        return match.group(0)

    with open(os.path.join(ROOT, page), encoding="utf-8") as file:
        pieces = re.split(r"(```.*?```)", file.read(), flags=re.DOTALL)
    text = "".join(piece if piece.startswith("```") else LINK.sub(target, piece) for piece in pieces)
    os.makedirs(os.path.join(pages, here), exist_ok=True)
    with open(os.path.join(pages, page), "w", encoding="utf-8") as file:
        file.write(text)


def header_pages(names, pages):
    """A page for each public header, and its name."""
    found = []
    for name in names:
        if re.match(r"include/.*\.h$", name):
            with open(os.path.join(ROOT, name), encoding="utf-8") as file:
                text = file.read()
            made = f"headers/{os.path.basename(name)[:-2]}.md"
            os.makedirs(os.path.join(pages, "headers"), exist_ok=True)
            with open(os.path.join(pages, made), "w", encoding="utf-8") as file:
                file.write(f"# {name[len('include/'):]}\n\n```c\n{text}```\n")
            found.append(made)
    return found


def limits_table(pages):
    """The table of limits by the program; without it a sentence."""
    program = os.environ.get("MPMSTAB", os.path.join(ROOT, "build", "mpmstab"))
    path = os.path.join(pages, "limits-table.md")
    if not os.access(program, os.X_OK):
        with open(path, "w", encoding="utf-8") as file:
            file.write("# Limits of all schemes, as a table\n\nThe program was not built when this site was: [limits](docs/limits.md).\n")
        return
    rows, shown = [], ("formulation", "basis", "transfer", "ppc", "critical_courant")
    with tempfile.TemporaryDirectory() as folder:
        for ppc in (1, 2, 4):
            name = os.path.join(folder, "survey.csv")
            subprocess.run([program, "critical", "-survey", "-ppc", str(ppc), "-csv", name], check=True, stdout=subprocess.DEVNULL)
            with open(name, encoding="utf-8", newline="") as file:
                rows += list(csv.DictReader(file))
    head = "".join(f'<th><button type="button">{name.replace("_", " ")}</button></th>' for name in shown)

    def cell(row, name):
        value = row[name]
        words = value if name != "critical_courant" else f"{float(value):.4f}" if value not in ("", "0", "inf") else value or "none"
        return f'<td data-value="{html.escape(value or "inf")}">{html.escape(words)}</td>'

    lines = [f'<tr data-command="mpmstab critical -formulation {row["formulation"]} -basis {row["basis"]} -transfer {row["transfer"]} '
             f'-ppc {row["ppc"]}">{"".join(cell(row, name) for name in shown)}</tr>' for row in rows]
    with open(path, "w", encoding="utf-8") as file:
        file.write(TABLE.replace("HEAD", head).replace("ROWS", "\n".join(lines)))


def config(names, headers):
    """mkdocs.yml."""
    rest = sorted(name for name in names if name.startswith("examples/"))
    dev = sorted(name for name in names if name.startswith("docs/dev/")) + ["CONTRIBUTING.md"]
    lines = [CONFIG, "nav:"]
    for heading, pages in [*NAVIGATION, ("Examples", rest), ("Headers", headers), ("Development", dev)]:
        lines += [f"  - {heading}:"] + [f"    - {page}" for page in pages]
    return "\n".join(lines) + "\n"


def main():
    folder = sys.argv[1]
    shutil.rmtree(folder, ignore_errors=True)
    pages = os.path.join(folder, "pages")
    os.makedirs(pages)
    names = listed()
    for name in names:
        if name.endswith(".md"):
            linked(name, pages)
    limits_table(pages)
    with open(os.path.join(pages, "print.css"), "w", encoding="utf-8") as file:
        file.write(PRINT)
    if os.path.isdir(os.path.join(ROOT, "atlas")):
        shutil.copytree(os.path.join(ROOT, "atlas"), os.path.join(pages, "atlas"), ignore=shutil.ignore_patterns("answers"))
    with open(os.path.join(folder, "mkdocs.yml"), "w", encoding="utf-8") as file:
        file.write(config([name for name in names if name.endswith(".md")], header_pages(names, pages)))


if __name__ == "__main__":
    main()
