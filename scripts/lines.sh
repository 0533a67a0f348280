#!/bin/sh
# lines.sh: lines and files of the C code, the tests and the scripts. src/ and include/ should have 34,000 lines, and at
# most 40,000.
set -eu
cd "$(dirname "$0")/.."
count() {
  git ls-files "$@" | grep -E '\.(c|h|py|sh|txt|csv|yaml)$' | tr '\n' '\0' | xargs -0 cat | wc -l | tr '\n' ' '
  git ls-files "$@" | grep -cE '\.(c|h|py|sh|txt|csv|yaml)$' | tr '\n' ' '
  echo "$*"
}
echo "lines files folders"
count src include
for folder in src/*/; do count "$folder"; done
count tests ':!tests/data' ':!tests/golden'
count scripts
