#!/bin/sh
# test.sh [OPTION OF CTEST...]: from a bare Debian 12 to tested: installs what is missing, builds, runs all tests, or
# those that options such as -R NAME choose.
set -eu
cd "$(dirname "$0")/.."
. ./scripts/install.sh
# shellcheck disable=SC2086 # a list of packages
./scripts/setup.sh $test_packages
alone build/test.lock "which runs the tests here"
ctest --test-dir build --output-on-failure --parallel 2 "$@"
