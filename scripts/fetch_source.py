#!/usr/bin/python3
"""Fetches the source of a project's newest release from PyPI, unless it is there, and prints its version.

fetch_source.py NAME FOLDER [SERIES]

The source goes to FOLDER/NAME-VERSION. With SERIES, such as 3.26, it is the newest of that series. The script runs
nothing of the source; pip would, to learn its metadata.
"""
import hashlib
import io
import os
import re
import sys
import tarfile
import tempfile
import urllib.parse
import urllib.request

NAME, FOLDER, SERIES = (sys.argv[1:] + [""])[:3]
PAGE = f"https://pypi.org/simple/{NAME}/"

with urllib.request.urlopen(PAGE) as answer:
    links = re.findall(r"<a [^>]*>", answer.read().decode())
releases = {}
for link in links:
    found = re.search(rf'href="([^"#]*/{NAME}-([0-9.]+)\.tar\.gz)#sha256=([0-9a-f]+)"', link)
    if found and "data-yanked" not in link and f"{found[2]}.".startswith(f"{SERIES}." if SERIES else ""):
        releases[tuple(int(n) for n in found[2].split("."))] = found.groups()
if not releases:
    sys.exit(f"fetch_source: {PAGE} has no source of {NAME} {SERIES}")
url, version, digest = releases[max(releases)]

target = os.path.join(FOLDER, f"{NAME}-{version}")
if not os.path.exists(target):
    with urllib.request.urlopen(urllib.parse.urljoin(PAGE, url)) as answer:
        data = answer.read()
    if hashlib.sha256(data).hexdigest() != digest:
        sys.exit(f"fetch_source: {url} is not what {PAGE} says it is")
    # The source is unpacked elsewhere and then moved, so that a folder of this name is complete.
    with tempfile.TemporaryDirectory(dir=FOLDER) as aside:
        with tarfile.open(fileobj=io.BytesIO(data)) as archive:
            archive.extractall(aside)
        os.rename(os.path.join(aside, f"{NAME}-{version}"), target)
print(version)
