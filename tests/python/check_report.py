#!/usr/bin/python3
"""Checks a report of five tiny scenes: its numbers against the JSON it was made from, and the page in a browser.

check_report.py MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import base64
import glob
import html
import json
import math
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import types

os.environ["MPMSTAB"] = os.path.abspath(sys.argv[1])
from checks import ROOT, SCRIPTS, check, check_one_line, run_script, text_of
from browser import WAIT, Keys, browser, check_quiet, clipboard_after, opened, require_browser, resize, webdriver
import report_page  # noqa: E402 (which program it runs comes first)
import report_runs  # noqa: E402

SCENES = {"rings": "formulation: gas2\ncells: 8\ncourant: 0.1\ndrift: 1/8\ninitial: random\nsteps: 200\n",
          "rests": "formulation: gas2 # <b>&amp;\ncells: 8\ncourant: 0.5\nsteps: 64\n",
          "jitters": "formulation: elastic\ncells: 8\ncourant: 1\njitter: 0.4\nsteps: 64\n"
                     "expect:\n  verdict: unstable\n",
          "plane": "dim: 2\nformulation: usl\nbasis: quadratic\ncells: 4\nppc: 1\nmode: 1,1\npolarisation: s\n"
                   "drift: 1/8,0\nsteps: 20\n",
          "space": "dim: 3\nformulation: usl\ntransfer: apic\ngradient: mls\nbasis: quadratic\ncells: 4,2,2\nppc: 1\n"
                   "length: 2,1,1\ninitial: random\nsteps: 20\n",
          "wrong one's": "formulation: gas2\ncells: minus one\n"}
WIDTHS = ((390, 844), (820, 1180), (1280, 900))


def report(*arguments, **how):
    return run_script("report.py", *arguments, **how)


def make():
    for name, text in SCENES.items():
        with open(f"{name}.yaml", "w", encoding="utf-8") as file:
            file.write(text)
    done = report(*[f"{name}.yaml" for name in SCENES], "-n", "2", "-o", "page.html", "--work", "files")
    check(done.returncode == 0, done.stderr)
    check("Traceback" not in done.stderr and "rests.yaml: error against run time" in done.stderr, done.stderr)
    check(not glob.glob("*.part"), "a .part is left")
    return text_of("page.html")


def result(scene, name):
    with open(os.path.join("files", scene, f"{name}.json"), encoding="utf-8") as file:
        return json.load(file)


def article(page, name):
    found = re.search(rf'<article id="{name}">(.*?)</article>', page, flags=re.DOTALL)
    check(found, f"no article on {name}")
    return found.group(1)


def cells_of(row):
    return re.findall(r"<td[^>]*>(.*?)</td>", row, flags=re.DOTALL)


def value_of(cell):
    found = re.search(r'<data value="([^"]+)">', cell)
    return float(found.group(1)) if found else None


def check_columns(page, name):
    """The five columns of the scene and of the overview must be those of the JSON, to the last digit."""
    spectrum = result(name, "spectrum")
    wanted = {key: spectrum["predicted"][key] for key in ("published", "corrected", "symbol")}
    wanted["spectrum"] = spectrum["spectrum"]["growth"]
    wanted["measured"] = spectrum["run"]["growth_measured"]
    text = article(page, name)
    box = text[text.index('aria-label="growth per step in five columns"'):]
    rows = [cells_of(row) for row in re.findall(r"<tr>(.*?)</tr>", box[: box.index("</table>")], flags=re.DOTALL)[1:]]
    check({row[0]: value_of(row[1]) for row in rows} == wanted, f"{name}: {rows}, not {wanted}")
    line = next(row for row in re.findall(r"<tr>(.*?)</tr>", page, flags=re.DOTALL) if f'href="#{name}"' in row)
    check([value_of(cell) for cell in cells_of(line)[5:10]] == list(wanted.values()), f"{name}: overview {line}")
    check(f'<span class="badge {spectrum["verdict"]}">' in cells_of(line)[1], f"{name}: verdict in the overview")
    check(f'<div class="verdict {spectrum["verdict"]}">' in text, f"{name}: verdict")
    check(f'Growth per step <data value="{spectrum["growth"]!r}">' in text, f"{name}: growth")


def check_text(page):
    for name in ("rings", "rests", "jitters", "plane", "space"):
        check_columns(page, name)
    critical = result("rests", "critical")["critical"]
    text = article(page, "rests")
    for value in (critical["critical_courant"], critical["growth_when_drifting"],
                  result("rests", "run")["run"]["error"]["u"]["l2"]):
        check(f'value="{value!r}"' in text, f"{value} is not on the page")
    check("recommended" in critical and f"Recommended: none ({critical['recommended']['reason']})" in text, "rests: by layout")
    check("The published abs(G) is off by up to 0.293" in text and "gamma^2 + 2" in text, "why published differs")
    check("\nerror 0.001: nothing that is stable reaches it here" in text and 'alt="Error over run time' in text,
          "what work_precision.py said")
    check("# &lt;b&gt;&amp;amp;" in text and "<b>&amp;" not in text, "a scene's text is not escaped")
    text = article(page, "rings")
    check(f'<data value="{result("rings", "at-rest")["growth"]!r}">' in text, "growth at rest")
    check("it is the drift that makes it grow" in text, "why rings rings")
    check("the formulas are for particles at rest" in text, "why there is no published number")
    text = article(page, "jitters")
    check("<b>symbol</b> does not cover this scene: <q>jitter 0.4: the symbol needs" in text, "a refusal is quoted")
    check("expected verdict unstable, found stable" in text, "a missed expectation is said")
    check_transient(page)
    check_overview(page)
    check_dimensions(page)
    text = article(page, "wrong-one-s")
    check("<b>map</b>" not in article(page, "rings"), "a map has nothing to expect")
    said, again = text.split("The same again")
    check("mpirun" not in said, "what is not the program's")
    words = shlex.split(html.unescape(re.sub("<.*?>", "", re.search("<code>(.*?)</code>", again)[1])))
    check(words[:4] == ["mpirun", "-q", "-n", "2"] and os.path.abspath("wrong one's.yaml") in
          [os.path.join(report_runs.ROOT, word) for word in words], f"not to be typed: {words}")
    check("not examined" in text and "cells" in text and "minus one" in text, "a scene that cannot be read")
    for name in ("PETSc", "SLEPc", "MPI", "Python", "processor", "git revision", "date"):
        check(re.search(rf"<td>{name}</td><td>[^<]+</td>", page), f"no {name}")
    made = re.sub("<.*?>", "", re.search(r"<td>command</td><td>.*<code>(.*?)</code>", page)[1])
    check(re.match(r"scripts/report.py \S*rings.yaml .+", made), f"no command: {made}")
    check_album(page)
    network = re.search(r"""(src|href)\s*=\s*["']?\s*(https?:)?//|@import|url\(""", page)
    check(not network, f"the network is named: {network}")
    least = {"rings": 6, "rests": 7, "jitters": 4, "plane": 8, "space": 4, "wrong-one-s": 0}
    kinds = {name: len(re.findall("<img ", article(page, name))) for name in least}
    check(all(kinds[name] >= least[name] for name in least) and kinds["wrong-one-s"] == 0, f"pictures: {kinds}")
    damped = [name for name in least if "damping of waves along x" in article(page, name)
              and 'alt="Decay and frequency error of waves' in article(page, name)]
    check(damped == ["rings", "rests", "plane", "space"], f"damping: {damped}")
    check("not drawn" not in page, "a picture was not drawn")
    check(all(re.findall(r'<img [^>]*alt="([^"]+)"', page)), "a picture without words")


def check_album(page):
    """Each picture of the page is saved beside it, and its link leads there."""
    links = [html.unescape(link) for link in re.findall(r'<a href="(page-pictures/[^"]+)">', page)]
    check(len(links) == len(set(links)) == page.count("<img ") and "page-pictures/rests-spectrum.svg" in links, f"{links}")
    for link in links:
        with open(link, "rb") as file:
            embedded = base64.b64encode(file.read()).decode()
        check(embedded in page, f"{link} is not the picture of the page")


def check_overview(page):
    """A refused scene must not count as undecided, and growth below the tolerance must not look like a limit."""
    check("6 scenes: " in page and "1 not examined. Growth" in page, "scenes are not counted")
    line = {name: cells_of(re.search(rf'<tr>(<td><a href="#{name}".*?)</tr>', page).group(1))
            for name in ("rings", "rests", "wrong-one-s")}
    check("? not examined" in line["wrong-one-s"][1], f"{line['wrong-one-s']}")
    check(result("rings", "critical")["critical"]["threshold"] is False, "rings has a threshold: this tests nothing")
    check(re.search(r"up to <data [^>]*>[^<]*</data> \((lattice|layout|neighbourhood)", page), "a limit without its layout")
    check(">0</abbr>" in line["rings"][10] and "falls below the tolerance" in line["rings"][10], f"{line['rings']}")
    check("0: growth fades as k does" in page, "the page says in another way that no step of rings is stable")
    limit = result("rests", "critical")["critical"]["critical_courant"]
    check(value_of(line["rests"][10]) == limit, f"{line['rests']}, not {limit}")


def check_dimensions(page):
    """Scenes of two and three dimensions must have their sections, and sentences for what is left out."""
    text, critical = article(page, "plane"), result("plane", "critical")["critical"]
    for value in (critical["critical_courant"], 2 * math.pi / math.hypot(*critical["limited_by_beta"]),
                  result("plane", "run")["run"]["error"]["v_y"]["l2"], result("plane", "at-rest")["growth"]):
        check(f'value="{value!r}"' in text, f"plane: {value} is not on the page")
    line = next(row for row in re.findall(r"<tr>(.*?)</tr>", page, flags=re.DOTALL) if 'href="#plane"' in row)
    drift = re.findall(r'value="([^"]+)"', cells_of(line)[4])
    check(list(map(float, drift)) == result("plane", "symbol")["drift"] == [0.125, 0], f"drift {drift}")
    check(result("plane", "map")["map"]["shape"] == [12, 9] and "12 x 9 points and 16 phases" in text, "a map of plane")
    check("2 dimensions: cells are counted along x" in text, "plane: error against run time")
    for words in ("phases of all directions", "Particles at the end of the run, usl", "eigenmodes over the plane"):
        check(f"{words}" in text, f"plane: no picture of {words}")
    check("over place and time, usl" not in text, "a picture over place and time in the plane")
    text, critical = article(page, "space"), result("space", "critical")["critical"]
    check(f'stable up to <data value="{critical["bound"]!r}">' in text, "space: no bound for any layout")
    moving = critical["growth_when_drifting_diagonally"]
    check(re.search(rf'along x, <data value="{moving!r}">[^<]*</data> along the diagonal', text), "space: drift")
    check("<li>No map: in three dimensions" in text and "is stable up to" in text, "space: what is left out is not said")
    check("<li>No picture over place and time" in text and "<li>No norms of powers" in text, "space: what is left out")
    check("<td>cells</td><td>4, 2, 2</td>" in text, "space: parameters")


def check_second_line():
    """A continued line on the Kreiss constant must be quoted whole, without the lines around it."""
    table = "transient: norm(A^n)\n  largest 5\nKreiss constant: at least 3;\n  it is higher nearer\n\nverdict: x\n"
    answer = types.SimpleNamespace(done=True, table=table, result={"verdict": "stable", "transient": {
        "largest": 1.5, "at_step": 3}})
    said = report_page.transient_words({"answers": {"transient": answer}})
    check(said.endswith('<pre tabindex="0">Kreiss constant: at least 3;\n  it is higher nearer</pre>'), said)


def check_transient(page):
    """The page must have the largest norm of powers, and say that a stable scheme may still grow for a while."""
    if "powers" not in report_runs.options_known():
        return
    found = result("rests", "transient")["transient"]
    text = article(page, "rests")
    check(f'value="{found["largest"]!r}"' in text and found["largest"] > 2 and "and yet states grow" in text, "powers")


def check_browser(path, screenshots=""):
    """In a browser the page must not complain, ask the network or scroll sideways, and must show every picture."""
    with browser() as driver:
        for width, height in WIDTHS:
            resize(driver, width, height)
            opened(driver, path)
            driver.execute_async_script(WAIT + "Promise.all([...document.images].map(i => i.decode()))"
                                        ".then(() => done(), e => done(e))")
            check_quiet(driver, width)
            look(driver, width)
            use(driver, width)
            type_keys(driver, width)
            for scheme in ("dark", "light"):
                read_in(driver, width, scheme)
            if screenshots:
                picture = driver.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True, "format": "png"})
                with open(f"{screenshots}-{width}.png", "wb") as file:
                    file.write(base64.b64decode(picture["data"]))


def look(driver, width):
    empty = driver.execute_script("return [...document.images].filter(i => !(i.naturalWidth > 0)).map(i => i.alt)")
    check(not empty and driver.execute_script("return document.images.length") > 0, f"empty pictures: {empty}")
    over = driver.execute_script("return [...document.images].filter(i => i.getBoundingClientRect().right > "
                                 "innerWidth + 1).map(i => i.alt)")
    check(not over, f"at {width}: pictures beyond the edge: {over}")
    seen = driver.execute_script("return [...document.querySelectorAll('.verdict')].map(v => v.checkVisibility ? "
                                 "v.checkVisibility() && v.offsetHeight > 0 : v.offsetHeight > 0)")
    check(seen and all(seen), f"at {width}: a verdict is not seen: {seen}")
    beyond = driver.execute_script("return [...document.querySelectorAll('.command pre')].filter(p => p.scrollWidth > "
                                   "p.clientWidth).map(p => p.textContent)")
    check(not beyond, f"at {width}: commands that do not wrap: {beyond}")
    broken = driver.execute_script("return [...document.querySelectorAll('.word')].filter(w => w.textContent.length < 20 && "
                                   "w.offsetHeight > 30).map(w => w.textContent)")
    check(not broken, f"at {width}: words of commands that are broken: {broken}")


def use(driver, width):
    """A button copies its command, a tap opens a picture large, and a table scrolls beside its first column."""
    wanted = driver.execute_script("return document.querySelector('.command code').textContent")
    found = clipboard_after(driver, ".command .copy")
    check(found == [wanted, "Copied"] and " spectrum " in wanted, f"{found}, not {wanted}")
    large = driver.execute_async_script(
        WAIT + "document.querySelector('.enlarge').click(); setTimeout(() => { const d = document.querySelector('dialog');"
        "const shown = [d.open, d.querySelector('img').getBoundingClientRect().width]; d.querySelector('.close').click();"
        "setTimeout(() => done([...shown, document.querySelectorAll('dialog').length]), 100); }, 100)")
    check(large[0] and large[1] >= 900 and large[2] == 0, f"at {width}: a picture opens as {large}")
    table = driver.execute_script(
        "const box = document.querySelector('.scroll'), cells = box.querySelector('tbody tr').cells;"
        "const at = cell => cell.getBoundingClientRect().left, before = [at(cells[0]), at(cells[1])];"
        "box.scrollLeft = 150; return [box.scrollLeft, before[0] - at(cells[0]), before[1] - at(cells[1])]")
    check(abs(table[1]) < 2 and abs(table[2] - table[0]) < 2 and (table[0] == 150 or width > 500),
          f"at {width}: the table has scrolled by {table[0]}, its first two columns by {table[1:]}")


def type_keys(driver, width):
    """With keys alone each button, link and box that scrolls is reached and outlined; Enter opens a picture, Escape closes it."""
    keys = webdriver.ActionChains(driver)
    driver.execute_script("const top = document.querySelector('h1'); top.tabIndex = -1; top.focus(); "
                          "top.removeAttribute('tabindex'); window.reached = new Set(); "
                          "document.addEventListener('focusin', e => { if (getComputedStyle(e.target).outlineStyle !== 'none') "
                          "window.reached.add(e.target); })")
    stops = "[...document.querySelectorAll('a[href], button, summary, [tabindex]')].filter(e => e.checkVisibility())"
    for _ in range(driver.execute_script(f"return {stops}.length")):
        keys.send_keys(Keys.TAB)
    keys.perform()
    missed = driver.execute_script(f"return {stops}.filter(e => !window.reached.has(e)).map(e => e.outerHTML.slice(0, 80))")
    check(not missed, f"at {width}: not reached with keys, or not outlined: {missed[:5]}")
    driver.execute_script("document.querySelector('.enlarge').focus()")
    webdriver.ActionChains(driver).send_keys(Keys.ENTER).pause(0.2).perform()
    opens = driver.execute_script("return document.querySelectorAll('dialog[open]').length")
    webdriver.ActionChains(driver).send_keys(Keys.ESCAPE).pause(0.2).perform()
    shut, back = driver.execute_script("return [document.querySelectorAll('dialog').length, document.activeElement.className]")
    check((opens, shut, back) == (1, 0, "enlarge"), f"at {width}: by Enter {opens} pictures open, after Escape {shut}; focus on {back}")


def read_in(driver, width, scheme):
    """Text stands out from what is behind it, 4.5 to 1 (WCAG AA), in dark mode too."""
    driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [{"name": "prefers-color-scheme", "value": scheme}]})
    faint = driver.execute_script(r"""
      const parts = text => text.match(/[\d.]+/g).map(Number);
      const light = text => parts(text).slice(0, 3).map(c => c / 255).map(c => c <= 0.04045 ? c / 12.92 :
        ((c + 0.055) / 1.055) ** 2.4).reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
      const behind = e => { const c = getComputedStyle(e).backgroundColor, p = parts(c);
        return p.length < 4 || p[3] > 0 ? c : behind(e.parentElement); };
      const ratio = e => { const a = light(getComputedStyle(e).color), b = light(behind(e));
        return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05); };
      return [...document.querySelectorAll('p, a, td, th, dt, dd, li, pre, button, figcaption, .badge, .verdict, .quiet')]
        .filter(e => ratio(e) < 4.5).map(e => `${e.className || e.tagName} ${ratio(e).toFixed(2)}`)""")
    check(not faint, f"at {width}, {scheme}: too faint: {sorted(set(faint))[:5]}")
    dark = driver.execute_script("return getComputedStyle(document.body).backgroundColor")
    check((dark == "rgb(255, 255, 255)") == (scheme == "light"), f"at {width}, {scheme}: the page is {dark}")


def check_code():
    """A code that is probed has an article with its limits and certificates."""
    adapter = os.path.join(ROOT, "examples", "your-code", "line.py")
    with open("probed.yaml", "w", encoding="utf-8") as scene:
        scene.write(f"program: {sys.executable} {adapter}\n")
    done = report("probed.yaml", "-o", "probed.html")
    check(done.returncode == 0 and "a scene that is read runs nothing" in text_of("probed.html"), f"not trusted: {done.stderr}")
    done = report("probed.yaml", "-o", "probed.html", "--trust-scenes")
    check(done.returncode == 0, done.stderr)
    text = article(text_of("probed.html"), "probed")
    for words in ("dt up to <data value=", ">0.000306186<", "65.32%", "two sizes", "holds"):
        check(words in text, f"the article of a code has no {words}")
    check(text.count("<figure>") == 3 and "not drawn" not in text, f"{text.count('<figure>')} pictures of a code")


def check_refusals():
    with open("code.yaml", "w", encoding="utf-8") as scene:
        scene.write("matrix: a.mtx\n")
    for arguments, says in ((("none.yaml",), "none.yaml: no such file or directory; allowed: a scene in YAML"),
                            (("code.yaml",), "code.yaml: matrix takes the place of a scene"),
                            (("rests.yaml", "-n", "0"), "-n 0: allowed: 1 or more ranks"),
                            (("rests.yaml", "-o", "nowhere/page.html", "--no-work-precision", "--work", "files2"),
                             "nowhere: No such file"),
                            (("rests.yaml", "-o", "files", "--work", "files2"), "files: is a folder"),
                            (("rests.yaml", "--work", "rests.yaml"), "rests.yaml: File exists"),
                            (("rests.yaml", "--ranks", "two"), "invalid int value: 'two'")):
        check_one_line(report(*arguments), arguments, says)
    for program, says in (("/etc/passwd", "/etc/passwd cannot be run"), ("none/mpmstab", "there is no ")):
        check_one_line(report("rests.yaml", env={**os.environ, "MPMSTAB": program}), program, says)


def check_places():
    """Runs a report from another folder with a relative MPMSTAB, inside another repository, and ended by Ctrl-C."""
    with tempfile.TemporaryDirectory() as folder:
        os.symlink(os.environ["MPMSTAB"], os.path.join(folder, "mpm"))
        shutil.copy("rests.yaml", folder)
        shutil.copytree(SCRIPTS, os.path.join(folder, "inside", "scripts"))
        commit = ["-c", "user.name=a", "-c", "user.email=a", "commit", "-q", "--allow-empty", "-m", "a"]
        for command in (["init", "-q"], commit):
            subprocess.run(["git", *command], cwd=folder, check=True)
        script = os.path.join(folder, "inside", "scripts", "report.py")
        done = run_script(script, "rests.yaml", "--no-work-precision", cwd=folder,
                          env={**os.environ, "MPMSTAB": "./mpm"})
        check(done.returncode == 0, f"by a relative path: {done.stderr}")
        page = text_of(os.path.join(folder, "report.html"))
        check("1 scene: 1 stable." in page, "by a relative path nothing was run")
        check("<td>git revision</td><td>not known</td>" in page, "another repository's revision")
    with subprocess.Popen([sys.executable, os.path.join(SCRIPTS, "report.py"), "rests.yaml", "-o", "ended.html"],
                          text=True, stderr=subprocess.PIPE) as process:
        process.stderr.readline()  # it has begun
        process.send_signal(signal.SIGINT)
        said = [line for line in process.communicate()[1].splitlines() if not line.startswith("report: ")]
    check(process.returncode == 130 and said == ["report.py: interrupted"], f"{process.returncode} {said}")
    check(not glob.glob("ended.html*"), "half a page")


def main():
    require_browser()
    page = make()
    check_text(page)
    check_browser("page.html")
    check_code()
    check_refusals()
    check_second_line()
    check_places()


if __name__ == "__main__":
    main()
