#!/bin/sh
# Installs what is missing (Debian), configures and builds into build/. Quick when nothing is missing.
set -eu
cd "$(dirname "$0")/.."
. ./scripts/install.sh
# shellcheck disable=SC2086 # a list of packages
install_missing $common_packages petsc-dev slepc-dev

mkdir -p build
log=build/setup.log
[ -x build/mpmstab ] || echo "building build/mpmstab, which takes minutes; $log has the messages"
cmake -S . -B build -DCMAKE_BUILD_TYPE=Release >"$log" 2>&1 || { cat "$log"; exit 1; }
cmake --build build --parallel 2 >>"$log" 2>&1 || { cat "$log"; exit 1; }
grep -i 'warning' "$log" || true
