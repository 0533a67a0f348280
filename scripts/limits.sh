#!/bin/sh
# Prints the tables of LIMITS.md (half a minute). With --check FILE...: whether each line printed at ppc 2 is in the files.
set -eu
cd "$(dirname "$0")/.."
. ./scripts/mpi-env.sh
program=${MPMSTAB:-build/mpmstab}

bar() {
  "$program" critical -cells 16 -boundary "$1,free" -formulation "$2" -ppc "$3" |
    sed -n "s/^critical Courant number: /$2 ppc $3, $1 and free: /p"
}

if [ "${1:-}" = --check ]; then
  shift
  "$program" critical -survey | tail -n +2 | while IFS= read -r line; do
    for file; do
      grep -qF -- "$line" "$file" || { echo "$file lacks: $line"; exit 1; }
    done
  done
  exit
fi
for ppc in 1 2 4; do
  "$program" critical -survey -ppc "$ppc"
  echo
done
for drift in 1/8 1/3; do
  "$program" critical -survey -drift "$drift"
  echo
done
echo "bars of 16 cells, by all eigenvalues"
bar fixed usl 1
bar fixed usl 2
bar fixed musl 2
bar fixed usf 1
bar fixed_reaction usf 1
