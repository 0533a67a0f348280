#!/bin/sh
# Lays out all C files; with --check only says which are not.
set -eu
cd "$(dirname "$0")/.."
files=$(find src include tests scripts -name '*.[ch]')
if [ "${1:-}" = --check ]; then
  # shellcheck disable=SC2086 # a list of files
  clang-format --dry-run --Werror $files
else
  # shellcheck disable=SC2086
  clang-format -i $files
fi
