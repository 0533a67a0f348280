"""Writes the pages of the atlas: a table of all schemes, sorted and searched in the browser, and a page for each."""
import json
import os
import shlex

import atlas_charts as charts
import report_html as html
from atlas_numbers import COLUMNS, numbers_of, written
from atlas_rows import COURANT, SAME_AS
from report_html import escaped
from whole_files import write_whole

# What people ask: in words what comes first, the columns that sort (1: the least first, -1: the largest), and between
# which two numbers others must be.
ASKED = {
    "Stable when moving": ("The least growth at any of the velocities comes first; of equal ones, the largest limit.",
                           [["worst", 1], ["least", -1]], {}),
    "Largest step": ("The largest least limit comes first: the least of the bulk, an edge and a lone particle.",
                     [["least", -1], ["bulk", -1]], {}),
    "Largest step inside a body": ("The largest limit of the bulk comes first.", [["bulk", -1], ["least", -1]], {}),
    "Least damping": (f"Of schemes that are stable at rest at k = {COURANT}, the largest amplitude kept comes first.",
                      [["kept", -1], ["worst", 1]], {"bulk": [0.5, None], "kept": [None, 1 + 1e-6]}),
    "Least damping, stable when moving": (
        "Of schemes that grow at none of the velocities, the largest amplitude kept comes first.",
        [["kept", -1], ["least", -1]], {"worst": [None, 0], "kept": [None, 1 + 1e-6]})}
MEANING = """All have 2 particles a cell in each direction, in the middles of equal parts of the cell (offset 1/2), and
Poisson's ratio 0.3. Particles move along x. A limit of 0 means that the limit falls to 0 as a particle comes to the face of
its cell, or that the scheme grows at every Courant number. None: no Courant number up to 64 is unstable. ?: not decided, or
not computed within the time for one command. In one and two dimensions growth is the largest over all waves: phases are
refined until it stops moving. In three it is that of 216 waves."""


def cell(column, value):
    data = "" if value is None else repr(value).replace("inf", "Infinity")
    return f'<td class="number" data-value="{data}">{written(column, value)}</td>'


def table_row(row, found):
    words = " ".join([*row.words.values(), f"{row.dim}-d", f"{row.dim}d",
                      *(name for name, same in SAME_AS.items() if same in row.words.values())])
    return (f'<tr data-dim="{row.dim}" data-words="{words}" data-scheme="{escaped(shlex.join(row.scheme()))}">'
            f'<td><a href="schemes/{row.name}.html">{row.title}</a></td>'
            + "".join(cell(column, found[column.key]) for column in COLUMNS) + "</tr>")


def heads():
    said = [("scheme", "scheme", "formulation, transfer, basis, gradient if it is not that of the basis, dimensions", "")]
    said += [(column.key, column.head, column.meaning, column.question) for column in COLUMNS]
    return "".join(f'<th scope="col" data-key="{key}" data-question="{question}"><button type="button" class="sort" '
                   f'title="{escaped(meaning)}">{escaped(head)}</button></th>' for key, head, meaning, question in said)


def asked_buttons():
    return "\n".join(f'<button type="button" class="ask" data-keys="{escaped(json.dumps(keys))}" '
                     f'data-need="{escaped(json.dumps(need))}" data-words="{escaped(words)}">{escaped(name)}</button>'
                     for name, (words, keys, need) in ASKED.items())


def legend():
    items = "".join(f"<li><b>{escaped(column.head)}</b>: {escaped(column.meaning)}.</li>" for column in COLUMNS)
    same = " ".join(f"{name} is not listed: its linear step is that of {other}." for name, other in SAME_AS.items())
    return f"<details><summary>What the numbers are</summary><ul>{items}</ul><p>{escaped(MEANING)} {same}</p></details>"


def not_there(refused):
    """Says which combinations the program refuses, and why."""
    items = "".join(f"<li>{count} combination{'s' * (count > 1)}: {escaped(why)}</li>" for why, count in refused.items())
    return f"<details><summary>What is not there</summary><ul>{items}</ul></details>" if refused else ""


def index(rows, found, refused, facts, commands):
    """Returns the page with the table. commands has what stands before and after the scheme in the command of a number."""
    body = "\n".join(table_row(row, numbers) for row, numbers in zip(rows, found))
    return html.page("Atlas of material point schemes", "\n".join([
        "<header><h1>Atlas of material point schemes</h1>",
        "<p>Which scheme is stable, for which time step, and what does it cost a wave? Each number is computed by mpmstab. "
        "Click a number for its command, and the name of a scheme for its page.</p></header>", "<main>",
        f'<div class="asks" role="group" aria-label="what do you ask?">{asked_buttons()}</div>',
        '<p><label>Search: <input type="search" id="search" placeholder="musl quadratic 2-D"></label> '
        '<output id="count"></output></p>', '<p id="words" class="quiet"></p>',
        '<div class="scroll" role="region" tabindex="0" aria-label="schemes"><table id="atlas">',
        f"<thead><tr>{heads()}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>", '<div id="asked" hidden></div>',
        legend(), not_there(refused), "<h2>How this was made</h2>", html.table("versions and machine", [], facts), "</main>",
        f'<script type="application/json" id="commands">{json.dumps(commands)}</script>',
        f"<style>{html.asset('atlas.css')}</style><script>{html.asset('atlas.js')}</script>"]))


def numbers_table(answers, found):
    """Returns each number beside the command that prints it."""
    rows = []
    for column in COLUMNS:
        if column.derived:
            continue
        answer = answers[column.question]
        said = f" ({escaped(answer['said'])})" if answer["status"] != 0 else ""
        rows.append([escaped(column.meaning), f"{written(column, found[column.key])}{said}",
                     html.command(answer["command"])])
    return html.table("numbers", ["number", "value", "command"], rows, (1,))


def scheme_page(row, answers, found):
    drawn = [charts.growth(answers, found), charts.damping(answers["damping"]), charts.growth_map(answers.get("map"))]
    more = (f"<p>The command of the map:</p>{html.command(answers['map']['command'])}" if "map" in answers else
            "<p>There is no map in three dimensions, where it takes too long.</p>")
    return html.page(row.title, "\n".join([
        '<p><a href="../index.html">Atlas</a></p>', f"<h1>{escaped(row.title)}</h1>", numbers_table(answers, found),
        f'<div class="pictures">{"".join(f"<figure>{chart}</figure>" for chart in drawn if chart)}</div>', more,
        f"<style>{html.asset('atlas.css')}</style>"]))


def commands_of(rows):
    """Returns by dimension and question what stands before and after the scheme in a command."""
    found = {}
    for row in rows:
        begin = 1 + len(row.scheme())  # after the task
        found.setdefault(row.dim, {name: [f"mpmstab {words[0]}", shlex.join(words[begin:])]
                                   for name, words in row.questions().items()})
    return found


def write_site(folder, rows, answers, facts):
    """Writes index.html and schemes/NAME.html. Returns how many schemes there are."""
    there, refused = [], {}
    for row, of in zip(rows, answers):
        if of["limits"]["status"] == 2:
            refused[of["limits"]["said"]] = refused.get(of["limits"]["said"], 0) + 1
        else:
            there.append((row, of, numbers_of(of)))
    for row, of, numbers in there:
        write_whole(os.path.join(folder, "schemes", f"{row.name}.html"), scheme_page(row, of, numbers))
    schemes, found = [row for row, _, _ in there], [numbers for _, _, numbers in there]
    write_whole(os.path.join(folder, "index.html"), index(schemes, found, refused, facts, commands_of(schemes)))
    return len(there)
