"""Writes what a report says of each scene and of all in its overview. examine() in report.py makes the entries."""
import math

import report_code
import report_html as html
import report_pictures
from report_html import escaped, number
from report_runs import COLUMNS, each, explanations, growths, left_out, shown, why_published_differs

QUESTION = "Is this scheme stable, for which time step, how accurate for what cost, and why?"
MEANINGS = {"published": "as the slides print it", "corrected": "the same analysis done right",
            "symbol": "exact von Neumann analysis", "spectrum": "eigenvalues of the assembled operator",
            "measured": "random data marched"}
GROWS = 2  # a stable scheme whose powers have a larger norm than this gets a remark


def best(entry):
    """Returns the answer that the verdict rests on, or None when there is none."""
    for name in ("spectrum", "symbol", "run"):
        if entry["answers"][name].done:
            return entry["answers"][name]
    return None


def verdict_box(entry):
    answer = best(entry)
    if answer is None:
        return (f'<div class="verdict undecided"><strong>? not examined</strong>The program says: '
                f'{escaped(entry["answers"]["run"].complaint)}</div>')
    result = answer.result
    growth, verdict = result.get("growth"), result["verdict"]
    words = {"stable": "nothing grows exponentially", "unstable": "something grows exponentially",
             "undecided": "the evidence is not enough"}[verdict]
    size = "" if growth is None else f"Growth per step {number(growth)}"
    if growth is not None and verdict == "unstable":
        size += f", a factor ten every {number(math.log(10) / math.log(growth), '.3g')} steps"
    evidence = f"Evidence: {escaped(result['evidence'])}." if "evidence" in result else "Evidence: the run alone."
    return (f'<div class="verdict {verdict}"><strong>{html.SIGNS[verdict]} {verdict}: {words}</strong>\n'
            f"{size}. {evidence}</div>")


def by_layout(found):
    """The table of steps by layout in a sentence."""
    rows = [f"{row['layout']} {number(row['courant'], '.4g')}" for row in found.get("layouts", []) if "courant" in row]
    if not rows:
        return ""
    advice = found["recommended"]
    step = number(advice["courant"], ".4g") if "courant" in advice else "none"
    return f" Largest k by layout, particles at rest: {', '.join(rows)}. Recommended: {step} ({escaped(advice['reason'])})."


def layout_of(result):
    """The layout that a limit is of, in words."""
    if "layout" in result:
        return f"layout {escaped(result['layout'])}"
    values = {"offset": 0.5, **result}
    parts = [f"{name} {','.join(format(one, '.6g') for one in each(values[name]))}" for name in ("ppc", "counts", "offset")
             if name in values]
    jitter = result.get("jitter", 0)
    return ", ".join([f"layout, jitter {jitter:.6g}" if jitter else "lattice", *parts])


def which_step(entry):
    answer = entry["answers"]["critical"]
    if not answer.done:
        return f"Not found: {escaped(answer.complaint)}."
    found, result = answer.result["critical"], answer.result
    limit, worst = found.get("critical_courant"), found.get("limited_by_neighbourhood", "bulk")
    has = f"; the scene has {number(result['courant'], '.6g')}" if "courant" in result else ""
    if limit is None:
        said = "No limit was found."
    elif limit == 0 and worst == "bulk":
        said = "0: it grows at every Courant number."
    elif worst == "bulk" and not found.get("threshold", True):
        said = f"0: growth fades as k does and falls below the tolerance only at k = {number(limit, '.3g')}{has}."
    else:
        of = layout_of(result) if worst == "bulk" else f"neighbourhood {escaped(worst)}"
        said = f"Courant number k = c dt / h up to {number(limit, '.6g')} ({of}){has}."
        if "critical_dt" in found:
            has = f"; the scene has {number(result['dt'], '.6g')}" if "dt" in result else ""
            said += f" In the scene's units that is dt up to {number(found['critical_dt'], '.6g')}{has}."
    if worst != "bulk":
        inside = found["neighbourhoods"].get("bulk", {}).get("critical_courant")
        inside = f" Inside the body ({layout_of(result)}) the limit is {number(inside, '.6g')}." if inside is not None else ""
        return (f"{said} This is the limit of the neighbourhood '{escaped(worst)}', the worst of those asked."
                f"{inside}{by_layout(found)}")
    beta = found.get("limited_by_beta")
    beta = math.hypot(*beta) if isinstance(beta, list) else beta
    if beta:
        named = {"P": "P waves", "S": "S waves", "mixed": "Mixed P and S waves"}
        waves = named.get(found.get("limited_by_wave"), "Waves")
        said += f" {waves} of {number(2 * math.pi / beta, '.4g')} cells set it."
    if "growth_when_drifting" in found:
        said += (" If its particles drift by 1/8 cell per step, growth is "
                 f"{number(found['growth_when_drifting'], '.6g')} per step")
        diagonal = found.get("growth_when_drifting_diagonally")
        said += "." if diagonal is None else f" along x, {number(diagonal, '.6g')} along the diagonal."
    if "bound" in found:
        said += (f" Any layout of such particles at rest is stable up to {number(found['bound'], '.6g')}.")
    return said + by_layout(found)


def how_accurate(entry):
    answer = entry["answers"]["run"]
    if not answer.done:
        return f"Not run: {escaped(answer.complaint)}."
    run = answer.result["run"]
    if "error" in run:
        errors = ", ".join(f"{escaped(field)} {number(error.get('l2'), '.3g')}"
                           for field, error in run["error"].items())
        said = f"After {run['steps']} steps the l2 error, relative to the exact amplitude, is {errors}."
    else:
        said = f"No exact solution for these data, so no error; {run['steps']} steps were run."
    return said + f" Cost: {number(run.get('ns_per_particle_step'), '.4g')} ns per particle and step in the loop."


def reasons(entry):
    """Explains the verdict in the program's words."""
    answers, found = entry["answers"], []
    spectrum = answers["spectrum"] if answers["spectrum"].done else answers["symbol"]
    differs = why_published_differs(spectrum.table)
    if differs:
        found.append(escaped(differs[0].upper() + differs[1:]) + ".")
    else:
        why = explanations(spectrum.table).get("published")
        if why and growths(answers)["published"] is None:
            found.append(f"There is no published number to compare with: {escaped(why)}.")
    rest = answers.get("at rest")
    if rest and rest.done and spectrum.done:
        found.append(f"The same particles at rest: growth {number(rest.result['growth'])} per step, "
                     f"{rest.result['verdict']}.")
        if rest.result["verdict"] == "stable" and spectrum.result["verdict"] == "unstable":
            found.append("So it is the drift that makes it grow: as particles move, the weights with which a node "
                         "hears its left and its right cell change from step to step.")
    beta = math.hypot(*each(answers["symbol"].result.get("symbol", {}).get("beta_at_max") or 0))
    if beta and spectrum.result.get("verdict") == "unstable":
        found.append(f"Waves of {number(2 * math.pi / beta, '.4g')} cells grow most.")
    return " ".join(found) or "Nothing more is known than the numbers below."


def answers_list(entry):
    items = (("Stable?", verdict_words(entry)), ("For which time step?", which_step(entry)),
             ("How accurate, for what cost?", how_accurate(entry)), ("Why?", reasons(entry)))
    body = "\n".join(f"<div><dt>{question}</dt><dd>{said}</dd></div>" for question, said in items)
    return f'<dl class="answers">\n{body}\n</dl>'


def verdict_words(entry):
    """Says how closely the columns agree that must agree."""
    found = growths(entry["answers"])
    exact = [(name, found[name]) for name in ("symbol", "spectrum", "measured") if found[name] is not None]
    if len(exact) < 2:
        return "One kind of evidence only: " + (exact[0][0] if exact else "none") + "."
    apart = max(value for _, value in exact) - min(value for _, value in exact)
    names = ", ".join(name for name, _ in exact)
    verdict = best(entry).result["verdict"].capitalize()
    return (f"{verdict}. Growth of {names} lies within {number(apart, '.2g')}: they are found independently of one "
            "another.")


def five_columns(entry):
    """Returns a table of the growth in five columns, each with the program's words on it."""
    found, spectrum = growths(entry["answers"]), entry["answers"]["spectrum"]
    said = explanations(spectrum.table if spectrum.done else entry["answers"]["symbol"].table)
    rows = [[name, number(found[name]), MEANINGS[name], f'<span class="words">{escaped(said.get(name, "-"))}</span>']
            for name in COLUMNS]
    head = ["", "growth per step", "what it is", "the program says"]
    return html.table("growth per step in five columns", head, rows, (1,))


def transient_words(entry):
    answer = entry["answers"].get("transient")
    if not answer or not answer.done or "transient" not in answer.result:
        return ""
    found, verdict = answer.result["transient"], answer.result["verdict"]
    if found["largest"] is None:
        words = "The norm of the powers leaves the range of doubles."
    else:
        words = f"The norm of A^n reaches {number(found['largest'], '.6g')} at n = {found['at_step']}."
        if verdict == "stable" and found["largest"] > GROWS:
            words += (" No eigenvalue lies outside the unit circle, and yet states grow: the operator is not normal, "
                      "or has a defective eigenvalue. That is not called unstable, but it is there.")
    telling = ("Kreiss", "norms grow", "norms do not", "late norms")
    lines, told = [], False
    for line in answer.table.splitlines():
        told = any(word in line for word in telling) or (told and line.startswith("  "))  # its next lines
        lines += [line] * told
    return f"<h3>Transient growth</h3>\n<p>{words}</p>\n" + (html.preformatted("\n".join(lines)) if lines else "")


def damping_words(entry):
    """Returns the program's table of damping."""
    answer = entry["answers"].get("damping")
    if not answer or not answer.done:
        return ""
    lines = answer.table.splitlines()
    begin = next(number for number, line in enumerate(lines) if line.startswith("damping of waves"))
    end = next(number for number, line in enumerate(lines) if number > begin and not line)
    return f"<h3>Damping</h3>\n{html.preformatted(chr(10).join(lines[begin:end]))}"


def parameters(entry):
    """Returns a table of the scene as the program has read it, defaults included."""
    rows = [[escaped(key), escaped(", ".join(f"{one:.9g}" if isinstance(one, float) else str(one)
                                             for one in each(value)))]
            for key, value in sorted(entry["scene"].items())]
    return html.table("parameters", ["parameter", "value"], rows) if rows else "<p>The program wrote none.</p>"


def missed(entry):
    """Lists tasks that were refused or failed, in the program's words, missed expectations, and what is left out."""
    items = []
    for name, answer in entry["answers"].items():
        if answer.status == 3 and name not in ("at rest", "damping", "map"):  # expectations of a scene are not about those
            items.append(f"<li><b>{escaped(name)}</b>: {escaped(answer.complaint)}</li>")
        elif not answer.done:
            kind = "does not cover this scene" if answer.status == 2 else "failed"
            items.append(f"<li><b>{escaped(name)}</b> {kind}: <q>{escaped(answer.complaint)}</q></li>")
    items += [f"<li>{escaped(sentence)}</li>" for sentence in left_out(entry["answers"])]
    return f"<h3>Refused, failed, unexpected or left out</h3>\n<ul>\n{chr(10).join(items)}\n</ul>" if items else ""


def work_precision(entry, album):
    answer = entry["answers"].get("error against run time")
    if not answer or not answer.done:
        return ""
    return (f"<h3>Error against run time</h3>\n{report_pictures.of_work_precision(entry, album)}\n"
            f"{html.preformatted(answer.table)}")


def scene_section(entry, album):
    commands = "\n".join(html.command(answer.command) for answer in entry["answers"].values())
    return "\n".join([
        f'<article id="{entry["name"]}">', f"<h2>{escaped(entry['name'])}</h2>", verdict_box(entry),
        answers_list(entry), "<h3>Growth per step</h3>", five_columns(entry), "<h3>Pictures</h3>",
        report_pictures.all_of(entry, album), damping_words(entry), transient_words(entry), work_precision(entry, album),
        missed(entry), f"<h3>The scene</h3>\n<p>{escaped(shown(entry['file']))}</p>", html.preformatted(entry["text"]),
        "<details>\n<summary>As the program has read it, with defaults</summary>", parameters(entry), "</details>",
        "<h3>The same again</h3>", commands, "</article>"])


def largest_stable(critical):
    """Returns the largest stable Courant number: 0 when no step is stable, also when growth only fades below the tolerance."""
    if not critical.done:
        return "-"
    found = critical.result["critical"]
    limit = found.get("critical_courant")
    if found.get("limited_by_neighbourhood", "bulk") != "bulk":
        return number(limit, ".6g")
    if limit and not found.get("threshold", True):
        why = f"growth fades as k does and falls below the tolerance only at k = {limit:.3g}"
        return f'<abbr title="{escaped(why)}">0</abbr>'
    return "no limit found" if limit is None else number(limit, ".6g")


def overview(entries):
    rows = []
    for entry in entries:
        answer = best(entry)
        result, critical = (answer.result if answer else {}), entry["answers"]["critical"]
        found = growths(entry["answers"]) if answer else dict.fromkeys(COLUMNS)
        rows.append([f'<a href="#{entry["name"]}">{escaped(entry["name"])}</a>',
                     html.badge(result["verdict"]) if answer else html.badge("undecided", "not examined"),
                     escaped(result.get("formulation", "-")), number(result.get("courant"), ".6g"),
                     ", ".join(number(one, ".6g") for one in each(result.get("drift"))),
                     *[number(found[name], ".6f") for name in COLUMNS],
                     largest_stable(critical)])
    head = ["scene", "verdict", "scheme", "k", "drift", *COLUMNS, "largest stable k"]
    count = {verdict: sum(best(e) is not None and best(e).result["verdict"] == verdict for e in entries)
             for verdict in html.SIGNS}
    count["not examined"] = len(entries) - sum(count.values())
    words = ", ".join(f"{many} {verdict}" for verdict, many in count.items() if many)
    return (f"<p>{len(entries)} scene{'s' if len(entries) > 1 else ''}: {words}. Growth is the "
            "factor per step of what grows fastest; published is as the slides print it, corrected the same analysis "
            "done right; symbol, spectrum and measured are this program's and must agree. A dash: the formula or task "
            "does not cover the scene. None as largest stable k: it grows at every one, or growth only fades as k "
            "does.</p>\n" + html.table("all scenes", head, rows, (3, 4, 5, 6, 7, 8, 9, 10)))


def body(entries, codes, facts, album):
    rows = [[escaped(name), html.command(value) if name == "command" else escaped(value)] for name, value in facts]
    return "\n".join([
        "<header>", f"<h1>{QUESTION}</h1>",
        '<p class="quiet">A report of mpmstab, from what the program itself computed.</p>', "</header>",
        "<main>", *(['<section aria-label="overview">', overview(entries), "</section>"] if entries else []),
        *(scene_section(entry, album) for entry in entries), *(report_code.section(entry, album) for entry in codes),
        '<section aria-label="how this was made">', "<h2>How this was made</h2>",
        html.table("versions and machine", [], rows), "</section>", "</main>"])
