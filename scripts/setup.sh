#!/bin/sh
# Installs what is missing (Debian), configures and builds into build/. Quick when nothing is missing.
set -eu
cd "$(dirname "$0")/.."

packages="gcc libc6-dev make cmake pkg-config git petsc-dev slepc-dev libhdf5-openmpi-dev libopenmpi-dev openmpi-bin
          libopenblas0-serial libfftw3-dev libyaml-dev libjansson-dev clang-format python3 python3-numpy python3-h5py
          python3-matplotlib valgrind"
missing=
for package in $packages; do
  case $(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true) in
  *"ok installed") ;;
  *) missing="$missing $package" ;;
  esac
done
if [ -n "$missing" ]; then
  echo "installing:$missing"
  as_root=
  [ "$(id -u)" -eq 0 ] || as_root=sudo
  $as_root apt-get update -qq
  # shellcheck disable=SC2086 # a list of packages
  $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
fi

mkdir -p build
log=build/setup.log
cmake -S . -B build -DCMAKE_BUILD_TYPE=Release >"$log" 2>&1 || { cat "$log"; exit 1; }
cmake --build build --parallel 2 >>"$log" 2>&1 || { cat "$log"; exit 1; }
grep -i 'warning' "$log" || true
