#!/bin/sh
# Builds a site of all pages in build/site, with mkdocs-material in a Python of its own below build/; status 77: pip cannot
# fetch it. The site asks no other host. A file opens in a browser; for the search serve it: python3 -m http.server -d build/site
# Links and headings that are not there end it with status 1.
set -eu
[ $# -eq 0 ] || { sed -n '2,4s/^# //p' "$0" && exit 2; } >&2
cd "$(dirname "$0")/.."
python=build/site-python/bin/python
if ! $python -c 'import material' 2>/dev/null; then
  echo "installing mkdocs-material in build/site-python"
  rm -rf build/site-python
  if ! { python3 -m venv build/site-python && $python -m pip install -q --disable-pip-version-check 'mkdocs-material>=9.5,<10'; } \
    >build/site-python.log 2>&1; then
    tail -n 1 build/site-python.log >&2
    echo "site.sh: pip cannot fetch mkdocs-material here, so no site is built (build/site-python.log)" >&2
    exit 77
  fi
fi
python3 scripts/report/site_pages.py build/site-pages
if ! $python -m mkdocs build --strict --config-file build/site-pages/mkdocs.yml --site-dir ../site >build/site.log 2>&1; then
  grep WARNING build/site.log >&2 || cat build/site.log >&2
  exit 1
fi
echo "build/site/index.html"
