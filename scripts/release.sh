#!/bin/sh
# release.sh tarball|build|tests [FOLDER]: makes mpmstab-VERSION.tar.gz of the last commit in FOLDER (build/release) and unpacks
# it in a clean place there; 'build' also builds and installs there, and 'tests' also runs the tests of every day there.
# Changes that are not committed, versions that differ, and files that name a home folder end it with status 1.
set -eu
case ${1:-} in tarball | build | tests) ;; *) sed -n '2,4s/^# //p' "$0" >&2 && exit 2 ;; esac
[ $# -le 2 ] || { sed -n '2,4s/^# //p' "$0" >&2 && exit 2; }
until=$1
mkdir -p "${2:-$(dirname "$0")/../build/release}"
folder=$(cd "${2:-$(dirname "$0")/../build/release}" && pwd -P)
cd "$(dirname "$0")/.."
. ./scripts/install.sh

[ "$(git rev-parse --show-toplevel 2>/dev/null)" = "$(pwd -P)" ] || give_up "This is no clone of the repository: $PWD"
changed=$(git status --porcelain)
[ -z "$changed" ] || give_up "These files are changed or new and not committed, so the tarball would not have them:
$changed"

version=$(sed -n 's/^project(mpmstab VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
says() { # FILE LINE: has this file the version in such a line?
  grep -qxF -- "$2" "$1" || give_up "$1 does not say '$2', and CMakeLists.txt has version $version"
}
says CITATION.cff "version: $version"
says scripts/python/pyproject.toml "version = \"$version\""
says CHANGELOG.md "## $version"
says scripts/packaging/conda/meta.yaml "{% set version = \"$version\" %}"
grep -qF "version(\"$version\"" scripts/packaging/spack/package.py ||
  give_up "scripts/packaging/spack/package.py has no version $version"
grep -qx "mpmstab ($version-1) .*" scripts/packaging/debian/changelog ||
  give_up "scripts/packaging/debian/changelog has no version $version-1"

# The same commit gives the same bytes.
name=mpmstab-$version
git archive --format=tar --prefix="$name/" HEAD | gzip -n -9 >"$folder/$name.tar.gz"
rm -rf "${folder:?}/$name"
tar -xzf "$folder/$name.tar.gz" -C "$folder"
echo "$folder/$name.tar.gz"
cd "$folder/$name"
# of other machines or of this one; a folder that the pages invent is $HOME/... or PATH/...
if grep -rnIE '(/home|/Users)/[a-z]|(^|[^[:alnum:]_.])[/]root/' . >"$folder/paths.txt"; then
  give_up "These lines of the tarball name a folder of one machine:
$(cat "$folder/paths.txt")"
fi
[ "$until" != tarball ] || exit 0

unset PYTHONPATH MPMSTAB
./scripts/setup.sh
cmake --install build --prefix "$folder/prefix" >"$folder/install.log" 2>&1 || { cat "$folder/install.log" >&2 && exit 1; }
"$folder/prefix/bin/mpmstab" critical -formulation usl -expect_critical 0.75592,0.75594 >"$folder/critical.txt" ||
  give_up "The installed program does not find the limit of usl: see $folder/critical.txt"
[ "$until" != build ] || exit 0

./scripts/test.sh
