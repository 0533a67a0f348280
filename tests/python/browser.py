"""Chromium without a window, for the checks of pages: what it shows, asks and does."""
import contextlib
import json
import os
import shutil
import sys
import tempfile

from checks import check

try:
    from selenium import webdriver
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.common.keys import Keys
except ImportError:
    webdriver = Keys = None

FLAGS = ("--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking "
         "--disable-component-update --disable-sync --disable-dev-shm-usage").split()
SKIPPED = 77
WAIT = "const done = arguments[arguments.length - 1]; "


def require_browser():
    """Ends the check as skipped, with its reason, where there is no browser to drive."""
    missing = [name for name, there in (("python3-selenium", webdriver), ("chromedriver", shutil.which("chromedriver")),
                                        ("chromium", shutil.which("chromium"))) if not there]
    if missing:
        print(f"skipped: there is no {' and no '.join(missing)}; scripts/test.sh installs what tests need")
        sys.exit(SKIPPED)


@contextlib.contextmanager
def browser():
    options = webdriver.ChromeOptions()
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    with tempfile.TemporaryDirectory() as profile:
        for flag in (*FLAGS, f"--user-data-dir={profile}"):
            options.add_argument(flag)
        driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
        try:
            driver.get("about:blank")
            driver.get_log("performance")  # the browser's own first page
            driver.execute_cdp_cmd("Browser.grantPermissions", {"permissions": ["clipboardReadWrite"]})
            yield driver
        finally:
            driver.quit()


def resize(driver, width, height):
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 500}
    driver.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)


def opened(driver, path):
    driver.get("file://" + os.path.abspath(path))


def clipboard_after(driver, selector):
    """Clicks the button that a selector finds and returns what is in the clipboard, and what the button says."""
    driver.execute_cdp_cmd("Page.bringToFront", {})
    return driver.execute_async_script(
        WAIT + "const button = document.querySelector(arguments[0]); button.click(); setTimeout(() => "
        "navigator.clipboard.readText().then(text => done([text, button.textContent]), e => done([String(e), ''])), 200)",
        selector)


def check_quiet(driver, width):
    """The page must not complain, ask the network, or be wider than the window."""
    log = driver.get_log("browser")
    check(not log, f"console: {log}")
    events = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    urls = [event["params"]["request"]["url"] for event in events if event["method"] == "Network.requestWillBeSent"]
    check(urls and all(url.startswith(("file:", "data:")) for url in urls), f"requests: {[url[:80] for url in urls]}")
    inner, wide = driver.execute_script("return [innerWidth, document.documentElement.scrollWidth]")
    check(inner == width and wide <= width, f"at {width}: the page is {wide} wide in a window of {inner}")
