#!/bin/sh
# Makes build/paper/paper.pdf of docs/paper with pandoc and Chromium; status 77 where one of them is missing. A source that is
# cited and is not in paper.bib ends it with status 1.
set -eu
[ $# -eq 0 ] || { sed -n '2,3s/^# //p' "$0" && exit 2; } >&2
cd "$(dirname "$0")/.."
. ./scripts/install.sh
for tool in pandoc chromium; do
  runs $tool || { echo "paper.sh: there is no $tool here, so no PDF is made" >&2 && exit 77; }
done
mkdir -p build/paper
pandoc --citeproc --standalone --fail-if-warnings --resource-path=docs/paper docs/paper/paper.md \
  --bibliography docs/paper/paper.bib -o build/paper/paper.html
chromium --headless --no-sandbox --disable-gpu --no-pdf-header-footer --print-to-pdf=build/paper/paper.pdf \
  "file://$PWD/build/paper/paper.html" >build/paper/chromium.log 2>&1 || { cat build/paper/chromium.log >&2 && exit 1; }
echo "build/paper/paper.pdf"
