#!/bin/sh
# test.sh [--all] [OPTION OF CTEST...]: from a bare Debian 12 to tested: installs what is missing, builds, and runs the
# tests of every day; with --all all tests; with options such as -R NAME those that ctest chooses by them.
set -eu
cd "$(dirname "$0")/.."
. ./scripts/install.sh
case ${1:-} in
'') set -- -LE nightly ;;
--all) shift && test_packages="$test_packages dpkg-dev debhelper lintian mmdebstrap" ;;
esac
# shellcheck disable=SC2086 # a list of packages
./scripts/setup.sh $test_packages
alone build/test.lock "which runs the tests here"
ctest --test-dir build --output-on-failure --parallel 2 "$@"
