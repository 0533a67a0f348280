"""Says what is known of a code that is probed, in the place of a scene: program or plugin. Its answers are those of symbol,
spectrum and critical, with powers where the operator is small."""
import os

import numpy

import picture_files as files
import picture_style as style
import report_html as html
from picture_spectra import eigenvalues_of, phase_axis, unit_circle
from report_html import escaped, number
from report_runs import SMALL, Asker, each, shown

LIMITS = {"interior": "cells alike in all directions, without an edge", "block": "some cells with nothing around them",
          "lone_particle": "a particle with nothing around it", "state": "the particles that the code describes"}


def ask_all(scene, folder, ranks, trusted):
    """Runs the tasks on a code, in the folder from which the report is called, as a command of a code may need it. The
    program refuses to start what a scene names that is not trusted."""
    asker, trust = Asker(os.path.abspath(scene), folder, ranks, os.getcwd()), ["-trust_scene"] if trusted else []
    answers = {"symbol": asker.ask("symbol", options=trust, files=("json", "h5")),
               "spectrum": asker.ask("spectrum", options=trust, files=("json", "h5")),
               "critical": asker.ask("critical", options=trust)}
    spectrum = answers["spectrum"]
    if spectrum.done and spectrum.result["spectrum"].get("unknowns", SMALL + 1) <= SMALL:
        answers["powers"] = asker.ask("spectrum", "powers", [*trust, "-powers", "200"])
    return {"asker": asker, "answers": answers}


def best(entry):
    """The answer that the verdict rests on, or None when there is none."""
    return next((entry["answers"][name] for name in ("symbol", "spectrum", "critical") if entry["answers"][name].done), None)


def verdict_box(entry):
    answer = best(entry)
    if answer is None:
        return (f'<div class="verdict undecided"><strong>? not examined</strong>The program says: '
                f'{escaped(entry["answers"]["critical"].complaint)}</div>')
    result = answer.result
    verdict = result["verdict"]
    return (f'<div class="verdict {verdict}"><strong>{html.SIGNS[verdict]} {verdict}</strong>\nGrowth per step '
            f"{number(result.get('growth'))}. Evidence: {escaped(result.get('evidence', '-'))}.</div>")


def certificates(entry):
    """What shows that the operator is that of the code."""
    answer = best(entry)
    found = answer.result.get("probing", {}).get("certificates", {}) if answer else {}
    rows = [[escaped(name), number(one["value"], ".2g"), number(one["bound"], ".2g"), "holds" if one["holds"] else "<b>fails</b>"]
            for name, one in found.items()]
    return html.table("certificates", ["certificate", "value", "bound", ""], rows, (1, 2)) if rows else ""


def limits(entry):
    answer = entry["answers"]["critical"]
    if not answer.done:
        return f"<p>Not found: {escaped(answer.complaint)}.</p>"
    found = answer.result["critical"]
    given = found.get("given_dt")
    rows = [[escaped(name.replace("_", " ")), number(dt, ".6g"), f"{100 * given / dt:.4g}%" if given and dt else "-",
             LIMITS.get(name, "")] for name, dt in found.get("limits", {}).items()]
    least = found.get("critical_dt")
    said = ("The limit is not certain; a certificate fails." if least is None else
            f"The least counts: dt up to {number(least, '.6g')}, in the code's own units.")
    return f"<p>{said}</p>\n" + html.table("largest stable time steps", ["particles", "largest stable dt", "the code's dt is", "which are"], rows, (1, 2))


def draw_eigenvalues(entry):
    with files.open_hdf5(entry["asker"].path("spectrum.h5")) as file:
        values = eigenvalues_of(file)
    figure = style.new_figure(4.6, "eigenvalues of the operator of all particles")
    axes = figure.subplots()
    unit_circle(axes)
    axes.plot(values.real, values.imag, **style.EIGENVALUES, label="eigenvalues")
    axes.set(xlabel="real part of the eigenvalue λ", ylabel="imaginary part of λ", aspect="equal")
    axes.locator_params(nbins=5)
    style.legend_below(axes)
    return style.settle(figure)


def draw_growth(entry):
    with files.open_hdf5(entry["asker"].path("symbol.h5")) as file:
        beta, growth = (files.array(file, f"symbol/{name}", "symbol -output") for name in ("beta", "growth"))
    if beta.ndim > 1:
        raise files.Refusal("waves in more than one direction")
    order = numpy.argsort(beta)
    figure = style.new_figure(3.6, f"largest growth {growth.max():.9g} per step")
    axes = figure.subplots()
    axes.plot(beta[order], growth[order], **style.COLUMNS["symbol"])
    phase_axis(axes)
    axes.set_ylabel("growth per step |G|")
    axes.set_ylim(min(0.95, growth.min()), max(1.05, 1.02 * growth.max()))
    return figure


def draw_powers(entry):
    found = entry["answers"]["powers"].result["transient"]
    figure = style.new_figure(3.6, f"largest {found['largest']:.6g} at step {found['at_step']}")
    axes = figure.subplots()
    axes.plot(found["steps"], found["norm"], **style.COLUMNS["symbol"])
    axes.set(xlabel="time step n", ylabel="norm of the n-th power, $||A^n||$",
             yscale="log" if found["largest"] > 100 else "linear")
    axes.set_ylim(bottom=None if found["largest"] > 100 else 0)
    return figure


def pictures(entry, album):
    answers, pieces = entry["answers"], []
    wanted = (("symbol", draw_growth, "Growth of each wave of the interior."),
              ("spectrum", draw_eigenvalues, "Eigenvalues; stable ones do not leave the unit circle."),
              ("powers", draw_powers, "How large a state can become before eigenvalues decide."))
    for name, draw, caption in wanted:
        if name not in answers or not answers[name].done or (name == "powers" and "transient" not in answers[name].result):
            continue
        if name == "symbol" and len(each(answers[name].result["symbol"].get("beta_at_max", 0))) > 1:
            continue  # a surface over two or three phases is told in the table
        pieces.append(album.draw(f"{entry['name']}-{name}", draw(entry), caption, escaped(caption)))
    return f'<div class="pictures">\n{chr(10).join(pieces)}\n</div>' if pieces else "<p>Nothing to draw.</p>"


def section(entry, album):
    answers = entry["answers"]
    commands = "\n".join(html.command(answer.command) for answer in answers.values())
    missed = [f"<li><b>{escaped(name)}</b>: <q>{escaped(answer.complaint)}</q></li>"
              for name, answer in answers.items() if not answer.done or answer.status == 3]
    tables = [f"<details>\n<summary>What {escaped(name)} prints</summary>\n{html.preformatted(answer.table)}</details>"
              for name, answer in answers.items() if answer.done]
    return "\n".join([
        f'<article id="{entry["name"]}">', f"<h2>{escaped(entry['name'])}</h2>", verdict_box(entry),
        "<h3>For which time step?</h3>", limits(entry), "<h3>Is the operator that of the code?</h3>", certificates(entry),
        "<h3>Pictures</h3>", pictures(entry, album), *tables,
        f"<h3>Refused, failed or unexpected</h3>\n<ul>\n{chr(10).join(missed)}\n</ul>" if missed else "",
        f"<h3>The code</h3>\n<p>{escaped(shown(entry['file']))}</p>", html.preformatted(entry["text"]),
        "<h3>The same again</h3>", commands, "</article>"])
