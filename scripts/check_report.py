#!/usr/bin/python3
"""Checks a report of three tiny scenes: its numbers against the JSON it was made from, and the page in a browser.

check_report.py MPMSTAB, in a folder that may be filled. Silent when all is well.
"""
import base64
import glob
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

from selenium import webdriver
from selenium.webdriver.chrome.service import Service

os.environ["MPMSTAB"] = os.path.abspath(sys.argv[1])
import report_runs  # noqa: E402 (which program it runs comes first)

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = {"rings": "formulation: gas2\ncells: 8\ncourant: 0.1\ndrift: 1/8\ninitial: random\nsteps: 200\n",
          "rests": "formulation: gas2 # <b>&amp;\ncells: 8\ncourant: 0.5\nsteps: 64\n",
          "jitters": "formulation: elastic\ncells: 8\ncourant: 1\njitter: 0.4\nsteps: 64\n"
                     "expect:\n  verdict: unstable\n",
          "wrong": "formulation: gas2\ncells: minus one\n"}
FLAGS = ("--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
         "--disable-component-update --disable-sync --disable-dev-shm-usage").split()
WIDTHS = ((360, 740), (1280, 900))


def check(condition, message):
    if not condition:
        sys.exit(f"check_report: {message}")


def report(*arguments):
    return subprocess.run([sys.executable, os.path.join(HERE, "report.py"), *arguments], capture_output=True, text=True,
                          check=False)


def make():
    for name, text in SCENES.items():
        with open(f"{name}.yaml", "w", encoding="utf-8") as file:
            file.write(text)
    done = report(*[f"{name}.yaml" for name in SCENES], "-n", "2", "-o", "page.html", "--work", "files")
    check(done.returncode == 0, done.stderr)
    check("Traceback" not in done.stderr and "rests.yaml: error against run time" in done.stderr, done.stderr)
    check(not glob.glob("*.part"), "a .part is left")
    with open("page.html", encoding="utf-8") as file:
        return file.read()


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
    """The five columns, of the scene and of the overview, are those of the JSON, to the last digit."""
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
    for name in ("rings", "rests", "jitters"):
        check_columns(page, name)
    critical = result("rests", "critical")["critical"]
    text = article(page, "rests")
    for value in (critical["critical_courant"], critical["growth_when_drifting"],
                  result("rests", "run")["run"]["error"]["u"]["l2"]):
        check(f'value="{value!r}"' in text, f"{value} is not on the page")
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
    text = article(page, "wrong")
    check("<b>map</b>" not in article(page, "rings"), "a map has nothing to expect")
    check("mpirun" not in text.split("The same again")[0], "what is not the program's")
    check("not examined" in text and "cells" in text and "minus one" in text, "a scene that cannot be read")
    for name in ("PETSc", "SLEPc", "MPI", "Python", "processor", "git revision", "date", "command"):
        check(re.search(rf"<td>{name}</td><td>[^<]+</td>", page), f"no {name}")
    network = re.search(r"""(src|href)\s*=\s*["']?\s*(https?:)?//|@import|url\(""", page)
    check(not network, f"the network is named: {network}")
    kinds = {name: len(re.findall("<img ", article(page, name))) for name in SCENES}
    least = {"rings": 6, "rests": 7, "jitters": 4, "wrong": 0}
    check(all(kinds[name] >= least[name] for name in least) and kinds["wrong"] == 0, f"pictures: {kinds}")
    check("not drawn" not in page, "a picture was not drawn")
    check(all(re.findall(r'<img [^>]*alt="([^"]+)"', page)), "a picture without words")


def check_transient(page):
    """Where the program has powers: the largest norm, and that a stable scheme may still grow."""
    if "powers" not in report_runs.options_known():
        return
    found = result("rests", "transient")["transient"]
    text = article(page, "rests")
    check(f'value="{found["largest"]!r}"' in text and found["largest"] > 2 and "and yet states grow" in text, "powers")


def check_browser(path, screenshots=""):
    """No complaint, no request, no page that scrolls sideways; every picture is there and the verdict is seen."""
    options = webdriver.ChromeOptions()
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    with tempfile.TemporaryDirectory() as profile:
        for flag in (*FLAGS, f"--user-data-dir={profile}"):
            options.add_argument(flag)
        driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
        try:
            driver.get("about:blank")
            driver.get_log("performance")  # the browser's own first page
            for width, height in WIDTHS:
                look(driver, path, width, height, screenshots)
        finally:
            driver.quit()


def look(driver, path, width, height, screenshots):
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    driver.get("file://" + os.path.abspath(path))
    driver.execute_async_script("const done = arguments[0]; Promise.all([...document.images].map(i => i.decode()))"
                                ".then(() => done(), e => done(e))")
    check(not driver.get_log("browser"), f"console: {driver.get_log('browser')}")
    events = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    urls = [event["params"]["request"]["url"] for event in events if event["method"] == "Network.requestWillBeSent"]
    check(urls and all(url.startswith(("file:", "data:")) for url in urls), f"requests: {[u[:80] for u in urls]}")
    inner, wide = driver.execute_script("return [innerWidth, document.documentElement.scrollWidth]")
    check(inner == width and wide <= width, f"at {width}: the page is {wide} wide in a window of {inner}")
    empty = driver.execute_script("return [...document.images].filter(i => !(i.naturalWidth > 0)).map(i => i.alt)")
    check(not empty and driver.execute_script("return document.images.length") > 0, f"empty pictures: {empty}")
    over = driver.execute_script("return [...document.images].filter(i => i.getBoundingClientRect().right > "
                                 "innerWidth + 1).map(i => i.alt)")
    check(not over, f"at {width}: pictures beyond the edge: {over}")
    seen = driver.execute_script("return [...document.querySelectorAll('.verdict')].map(v => v.checkVisibility ? "
                                 "v.checkVisibility() && v.offsetHeight > 0 : v.offsetHeight > 0)")
    check(seen and all(seen), f"at {width}: a verdict is not seen: {seen}")
    if screenshots:
        picture = driver.execute_cdp_cmd("Page.captureScreenshot", {"captureBeyondViewport": True, "format": "png"})
        with open(f"{screenshots}-{width}.png", "wb") as file:
            file.write(base64.b64decode(picture["data"]))


def check_refusals():
    for arguments, says in ((("none.yaml",), "none.yaml: no such file or directory; allowed: a scene in YAML"),
                            (("rests.yaml", "-n", "0"), "-n 0: allowed: 1 or more ranks"),
                            (("rests.yaml", "-o", "nowhere/page.html", "--no-work-precision", "--work", "files2"),
                             "nowhere/page.html.part: No such file")):
        done = report(*arguments)
        lines = [line for line in done.stderr.splitlines() if not line.startswith("report: ")]
        check(done.returncode == 2 and len(lines) == 1 and says in lines[0], f"{arguments}: {done.returncode} {lines}")


def main():
    page = make()
    check_text(page)
    check_browser("page.html")
    check_refusals()


if __name__ == "__main__":
    main()
