#!/usr/bin/python3
"""Checks a small atlas: its numbers, that an interrupted run goes on, and in a browser sorting, searching and copying.

check_atlas.py MPMSTAB, in a folder that may be filled. Silent when all is well; status 77 where there is no browser.
"""
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

os.environ["MPMSTAB"] = os.path.abspath(sys.argv[1])
from checks import SCRIPTS, check, check_one_line, run_script, text_of
from browser import browser, check_quiet, clipboard_after, opened, require_browser, resize
import atlas_numbers  # noqa: E402 (which program it runs comes first)
import program  # noqa: E402

SUBSET = ["--only", "musl,elastic", "flip,apic", "linear", "basis", "--dim", "1", "--jobs", "2", "-o", "atlas"]
SCHEMES = ["elastic flip linear 1-D", "musl apic linear 1-D", "musl flip linear 1-D"]
QUESTIONS = 4 * 8
# Limits at rest as docs/limits.md has them, and growth of musl on hats at k = 1/2 as an independent program found it.
KNOWN = {("musl flip linear 1-D", "bulk"): 1.7321, ("musl flip linear 1-D", "edge"): 1.4102,
         ("musl flip linear 1-D", "lone"): 2, ("musl flip linear 1-D", "least"): 1.4102,
         ("musl flip linear 1-D", "grows0"): 2.4e-3, ("musl flip linear 1-D", "grows2"): 2.7e-2,
         ("elastic flip linear 1-D", "bulk"): 1.3959}


def interrupt():
    """Begins an atlas and ends it by Ctrl-C when some answers are there. Returns how many are kept."""
    command = [sys.executable, os.path.join(SCRIPTS, "atlas.py"), *SUBSET]
    with subprocess.Popen(command, text=True, stderr=subprocess.PIPE) as process:
        first = process.stderr.readline()
        check(f"4 combinations, {QUESTIONS} questions; about " in first, first)
        while len(glob.glob("atlas/answers/*.json")) < 3 and process.poll() is None:
            pass
        process.send_signal(signal.SIGINT)
        said = [line for line in process.communicate()[1].splitlines() if not line.startswith("atlas: ")]
    check(process.returncode == 130 and said == ["atlas.py: interrupted"], f"{process.returncode} {said}")
    check(not os.path.exists("atlas/index.html"), "half an atlas")
    return len(glob.glob("atlas/answers/*.json"))


def build():
    """Goes on after an interruption, and again after an answer was damaged. Returns the page."""
    shutil.rmtree("atlas", ignore_errors=True)
    kept = interrupt()
    done = run_script("atlas.py", *SUBSET)
    check(done.returncode == 0 and f"{QUESTIONS} questions, {kept} of them answered" in done.stderr, done.stderr)
    check("atlas/index.html, 3 schemes" in done.stdout, done.stdout)
    answers = sorted(glob.glob("atlas/answers/*.json"))
    check(len(answers) == QUESTIONS - 7, f"{len(answers)} answers, where one scheme of four is refused")
    before = text_of("atlas/index.html")
    with open(answers[0], "r+", encoding="utf-8") as file:
        file.truncate(20)
    done = run_script("atlas.py", *SUBSET)
    check(f", {QUESTIONS - 8} of them answered" in done.stderr, f"a damaged answer: {done.stderr}")
    page = text_of("atlas/index.html")
    check(re.sub(r"20\d\d-[^<]*", "", page) == re.sub(r"20\d\d-[^<]*", "", before), "the same answers make another page")
    check("1 combination: -transfer apic" in page, "what is refused is not said")
    return page


def check_numbers(page):
    """The page has the numbers that are known, each is the program's, and its command prints it."""
    keys = [column.key for column in atlas_numbers.COLUMNS]
    rows = {}
    for row in re.findall(r"<tr data-dim.*?</tr>", page):
        values = re.findall(r'data-value="([^"]*)"', row)
        rows[re.search(r">([^<]+)</a>", row)[1]] = dict(zip(keys, [float(v) if v else math.nan for v in values]))
    check(sorted(rows) == SCHEMES, f"{sorted(rows)}")
    for (name, key), wanted in KNOWN.items():
        digits = 5e-5 if key in ("bulk", "edge", "lone", "least") else 5e-5 if wanted < 0.01 else 5e-4
        check(abs(rows[name][key] - wanted) < digits, f"{name}: {key} {rows[name][key]}, not {wanted}")
    for name, row in rows.items():
        check(row["worst"] == max(row[f"grows{n}"] for n in range(4)), f"{name}: worst {row}")
    check(abs(rows["musl flip linear 1-D"]["kept"] - 1) < 1e-9, "musl with flip does not damp")
    scheme = text_of("atlas/schemes/musl-flip-linear-basis-1d.html")
    commands = [html.unescape(re.sub("<.*?>", "", text)) for text in re.findall("<code>(.*?)</code>", scheme)]
    check(len(commands) == 10 and scheme.count("<svg") >= 2, f"{len(commands)} commands, {scheme.count('<svg')} charts")
    moving = next(text for text in commands if "-mach 1/4" in text)
    subprocess.run([os.environ["MPMSTAB"], *shlex.split(moving)[1:], "-json", "moving.json"], check=True,
                   stdout=subprocess.DEVNULL)
    with open("moving.json", encoding="utf-8") as file:
        check(json.load(file)["growth"] - 1 == rows["musl flip linear 1-D"]["grows2"], "the command prints another number")


def check_threads():
    """A command of the atlas gets one thread for its linear algebra, whatever the shell says."""
    os.environ["OMP_NUM_THREADS"] = "2"
    with program.side_by_side(2) as pool:
        said = pool.submit(subprocess.check_output, ["sh", "-c", "echo $OMP_NUM_THREADS"], text=True).result()
    check(said == "1\n", f"{said} threads")


def check_unknown():
    """What is not decided or was stopped is not a number, and no limit is infinite."""
    stopped = {"status": None, "result": {}}
    found = atlas_numbers.limits({"limits": stopped, "lone": stopped})
    check(set(found.values()) == {None}, f"{found}")
    places = {"bulk": {"critical_courant": 2.0}, "edge": {"verdict": "stable"}, "lone": {"undecided": "why"}}
    answer = {"result": {"critical": {"neighbourhoods": places}}}
    found = atlas_numbers.limits({"limits": answer, "lone": answer})
    check(found == {"bulk": 2.0, "edge": math.inf, "lone": None, "least": None}, f"{found}")
    check(atlas_numbers.growth({"result": {"verdict": "undecided", "growth": 1.1}}) is None, "an undecided growth")


SHOWN = "return [...document.querySelectorAll('#atlas tbody tr')].filter(r => !r.hidden).map(r => r.cells[0].textContent)"


def values_of(driver, key):
    return driver.execute_script(
        "const at = [...document.querySelectorAll('#atlas th')].findIndex(h => h.dataset.key === arguments[0]);"
        "return [...document.querySelectorAll('#atlas tbody tr')].filter(r => !r.hidden).map(r => r.cells[at].dataset.value)", key)


def click(driver, selector):
    driver.execute_script("document.querySelector(arguments[0]).click()", selector)


def searched(driver, words):
    driver.execute_script("const box = document.querySelector('#search'); box.value = arguments[0];"
                          "box.dispatchEvent(new Event('input'))", words)
    return driver.execute_script(SHOWN)


def check_table(driver):
    """Sorting and searching are read off the table."""
    worst = [float(value) for value in values_of(driver, "worst")]
    check(worst == sorted(worst) and len(worst) == 3, f"at first the least growth is not first: {worst}")
    click(driver, "th[data-key=bulk] button")
    up = [float(value) for value in values_of(driver, "bulk")]
    click(driver, "th[data-key=bulk] button")
    down = [float(value) for value in values_of(driver, "bulk")]
    check(up == sorted(up) and down == up[::-1] and len(set(up)) == 3, f"sorted by the limit: {up}, then {down}")
    click(driver, "th[data-key=scheme] button")
    check(driver.execute_script(SHOWN) == SCHEMES, f"sorted by name: {driver.execute_script(SHOWN)}")
    for button in range(1, 6):
        click(driver, f".ask:nth-child({button})")
        first = driver.execute_script("return JSON.parse(document.querySelector('.ask[aria-pressed=true]').dataset.keys)[0]")
        values = [float(value) for value in values_of(driver, first[0])]
        check(values == sorted(values, reverse=first[1] < 0), f"question {button}: {first} {values}")
    still = values_of(driver, "worst")
    check(len(still) < 3 and set(still) <= {"0.0"}, f"growth of those that are called stable when they move: {still}")
    click(driver, ".ask")
    check(searched(driver, "MUSL api") == ["musl apic linear 1-D"], "search for words")
    check(driver.execute_script("return document.querySelector('#count').textContent") == "1 of 3 schemes", "the count")
    check(searched(driver, "2d") == [] and len(searched(driver, "")) == 3, "search for a dimension")


def check_browser():
    with browser() as driver:
        for width, height in ((390, 844), (1280, 900)):
            resize(driver, width, height)
            opened(driver, "atlas/index.html")
            check_quiet(driver, width)
            check_table(driver)
            searched(driver, "musl flip")
            driver.execute_script("[...document.querySelectorAll('#atlas tbody tr')].find(r => !r.hidden).cells[7].click()")
            found = clipboard_after(driver, "#asked .copy")
            wanted = "mpmstab symbol -formulation musl -transfer flip -basis linear -courant 1/2 -mach 1/4 -refine"
            check(found == [wanted, "Copied"], f"{found}")
            opened(driver, "atlas/schemes/musl-flip-linear-basis-1d.html")
            check_quiet(driver, width)
            check(clipboard_after(driver, ".copy")[0].startswith("mpmstab critical -formulation musl"), "copying on a page")
            high = driver.execute_script("return [...document.querySelectorAll('svg')].map(s => s.getBoundingClientRect().height)")
            check(len(high) >= 2 and min(high) > 100, f"charts of the heights {high}")


def check_refusals():
    for arguments, says in ((("--only", "nothing"), "--only nothing: no scheme has these names; allowed: names"),
                            (("--jobs", "0"), "--jobs 0: allowed: 1 or more"), (("--dim", "4"), "invalid numbers value: '4'")):
        check_one_line(run_script("atlas.py", *arguments, "-o", "refused"), arguments, says)
    check(not os.path.exists("refused"), "a refusal makes a folder")
    done = run_script("atlas.py", "--estimate", "-o", "refused")
    check(done.returncode == 0 and "questions; about " in done.stderr and not os.path.exists("refused"), done.stderr)


def main():
    require_browser()
    check_threads()
    check_unknown()
    check_refusals()
    check_numbers(build())
    check_browser()


if __name__ == "__main__":
    main()
