#!/usr/bin/python3
"""Builds the site of all pages by scripts/site.sh and looks at it: links, headings, the table of limits, and that it asks nobody.

check_site.py, with MPMSTAB. Status 77 where pip cannot fetch mkdocs-material. Silent when all is well. Links and anchors of the
pages are checked by mkdocs itself, which is strict; here those of the site are.
"""
import html
import os
import re
import shutil
import subprocess
import sys
import urllib.parse

from browser import browser, check_quiet, opened, resize, webdriver
from checks import ROOT, check, text_of

SITE = os.path.join(ROOT, "build", "site")
SKIPPED = 77
PAPER = 720  # the width of A4 between its margins, in pixels


def pages():
    return sorted(os.path.join(folder, name) for folder, _, names in os.walk(SITE) for name in names if name.endswith(".html"))


def check_pages():
    for page in pages():
        text = text_of(page)
        name = os.path.relpath(page, SITE)
        check(len(re.findall(r"<h1[ >]", text)) == 1 or name == "404.html", f"{name}: not one heading of the first order")
        body = text.split("<article")[-1].split("</article>")[0]
        lists = re.search(r"<p>[^<]*(?:<(?!/p>)[^<]*)*\n(?:-|\d+\.) ", body)
        check(not lists, f"{name}: a list without a blank line before it is text here: {lists and lists.group()[-60:]}")
        for link in re.findall(r'(?:href|src)="([^"#]+)', body):
            link = urllib.parse.unquote(html.unescape(link))
            if not re.match(r"\w+:", link):
                check(os.path.exists(os.path.join(os.path.dirname(page), link)), f"{name}: there is no {link}")
    index = text_of(os.path.join(SITE, "index.html"))
    for page in os.listdir(os.path.join(ROOT, "docs")):
        check(not page.endswith(".md") or f'href="docs/{page[:-3]}.html" class="md-nav__link"' in index, f"docs/{page} is not in the navigation")
    rows = text_of(os.path.join(SITE, "limits-table.html")).count("<tr data-command=")
    check(rows > 500, f"the table of limits has {rows} rows")


def check_in_browser():
    with browser() as driver:
        for width in (390, 820, 1280):
            resize(driver, width, 900)
            for name in ("index.html", "docs/related-work.html", "docs/verification.html", "limits-table.html"):
                opened(driver, os.path.join(SITE, name))
                check_quiet(driver, width)
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
        resize(driver, PAPER, 900)
        for page in pages():
            opened(driver, page)
            cut = driver.execute_script("return [...document.querySelectorAll('article table, article pre, article img')].filter(e => "
                                        "e.getBoundingClientRect().right > innerWidth || e.scrollWidth > e.clientWidth + 1).length")
            check(not cut, f"{os.path.relpath(page, SITE)}: {cut} tables, listings or pictures are cut off in print")
        driver.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})
        resize(driver, 1280, 900)
        opened(driver, os.path.join(SITE, "limits-table.html"))
        driver.execute_script("const box = document.getElementById('wanted'); box.value = 'usavg cubic blend'; "
                              "box.dispatchEvent(new Event('input'))")
        shown = driver.execute_script("return [...document.querySelectorAll('#limits tbody tr')].filter(r => !r.hidden).length")
        check(shown == 3, f"{shown} rows of usavg, cubic, blend, not those of 1, 2 and 4 particles a cell")
        driver.execute_script("document.querySelectorAll('#limits tbody tr')[0].click()")
        said = driver.execute_script("return document.getElementById('command').textContent")
        check(said.startswith("mpmstab critical -formulation"), said)


def main():
    done = subprocess.run([os.path.join(ROOT, "scripts", "site.sh")], capture_output=True, text=True, check=False)
    if done.returncode == SKIPPED:
        print(f"check_site: {done.stderr.strip().splitlines()[-1]}")
        sys.exit(SKIPPED)
    check(done.returncode == 0, f"site.sh: {done.stdout}{done.stderr}")
    check_pages()
    if webdriver and shutil.which("chromium") and shutil.which("chromedriver"):
        check_in_browser()


if __name__ == "__main__":
    main()
