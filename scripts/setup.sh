#!/bin/sh
# setup.sh [PACKAGE...]: installs what is missing for the build (Debian), and these packages, and builds into build/.
# Quick when nothing is missing. demo.sh and test.sh call it.
set -eu
cd "$(dirname "$0")/.."
. ./scripts/install.sh
case $PWD in
*[[:space:]\'\"\`\$\&\;\(\)\<\>\|\\]*)
  give_up "HDF5's compiler h5pcc takes no spaces, quotes or brackets in the name of a folder; move this one: $PWD"
  ;;
esac
alone build/setup.lock "which installs or builds here"
# shellcheck disable=SC2086 # a list of packages
install_missing $common_packages petsc-dev slepc-dev "$@"

made_for=$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' build/CMakeCache.txt 2>/dev/null || true)
[ -z "$made_for" ] || [ "$made_for" = "$(pwd -P)" ] ||
  give_up "$PWD/build was made for another folder, $made_for; remove it ('rm -r build') and start again."

log=build/setup.log
why="; the lines above are the last of $PWD/$log. INSTALL.md says what is needed, and 'rm -r build' begins afresh."
cmake -S . -B build -DCMAKE_BUILD_TYPE=Release >"$log" 2>&1 || {
  tail -n 20 "$log" >&2
  give_up "CMake could not configure the build$why"
}

build() { cmake --build build --parallel "$(getconf _NPROCESSORS_ONLN || echo 2)" 2>&1 || echo "not built"; }

progress() { # Writes the log, and tells how far the build is when there is something to compile.
  told=-10
  while IFS= read -r line; do
    printf '%s\n' "$line" >>"$log"
    case $line in "["*"%] Building "*) ;; *) continue ;; esac
    percent=${line%%"%"*}
    percent=${percent##*[!0-9]}
    [ "$told" -ge 0 ] || printf 'building, which takes about four minutes of processor time:'
    [ "$percent" -lt $((told + 10)) ] || { told=$percent && printf ' %s%%' "$percent"; }
  done
  [ "$told" -lt 0 ] || echo
}

build | progress
[ "$(tail -n 1 "$log")" != "not built" ] || {
  tail -n 20 "$log" >&2
  give_up "The build failed$why"
}
grep -i 'warning' "$log" || true
