#!/bin/sh
# Sets up and runs every test.
set -eu
cd "$(dirname "$0")/.."
./scripts/setup.sh
. ./scripts/install.sh
# shellcheck disable=SC2086 # a list of packages
install_missing $test_packages
ctest --test-dir build --output-on-failure --parallel 2 "$@"
