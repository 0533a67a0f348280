#!/bin/sh
# Prints the tables of docs/limits.md (five minutes). With --check FILE...: whether each line printed at ppc 2, at rest, is in
# the files. With --check-neighbourhoods FILE...: the same of the lines for edges and lone particles that take seconds.
set -eu
cd "$(dirname "$0")/.."
. ./scripts/mpi-env.sh
program=${MPMSTAB:-build/mpmstab}

bar() {
  "$program" critical -cells 16 -boundary "$1,free" -formulation "$2" -ppc "$3" |
    sed -n "s/^critical Courant number: \([0-9.]*\).*/$2 ppc $3, $1 and free: \1/p"
}

# A line with the limits of neighbourhoods: near DIM NEIGHBOURHOODS OPTION...
near() {
  dim=$1 kinds=$2
  shift 2
  "$program" critical -dim "$dim" -neighbourhood "$kinds" "$@" |
    awk -v line="dim $dim $*:" '/^(bulk|edge|corner|lone) / { line = line "  " $1 " " $2 } END { print line }'
}

# The schemes that codes run: near_all DIM NEIGHBOURHOODS.
near_all() {
  near "$1" "$2" -formulation usl -transfer apic -gradient mls -basis quadratic
  for basis in quadratic gimp linear; do
    for formulation in usl musl; do
      near "$1" "$2" -formulation $formulation -basis $basis
    done
  done
}

# Whether each line of standard input is in the files: lines_in FILE...
lines_in() {
  while IFS= read -r line; do
    for file; do
      grep -qF -- "$line" "$file" || { echo "$file lacks: $line"; exit 1; }
    done
  done
}

if [ "${1:-}" = --check-neighbourhoods ]; then
  shift
  printed=$(near_all 1 bulk,edge,lone
    near 2 bulk,edge,lone -formulation usl -transfer apic -gradient mls -basis quadratic)
  [ "$(printf '%s\n' "$printed" | wc -l)" -eq 8 ] || { echo "lines of neighbourhoods are missing"; exit 1; }
  printf '%s\n' "$printed" | lines_in "$@"
  exit
fi
if [ "${1:-}" = --check ]; then
  shift
  printed=$("$program" critical -survey)
  [ "$(printf '%s\n' "$printed" | wc -l)" -gt 30 ] || { echo "the survey is too short"; exit 1; }
  printf '%s\n' "$printed" | tail -n +2 | lines_in "$@"
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
echo "growth per step - 1 at k = 0.5, drift 1/8: particles move at a quarter of the wave speed"
echo "scheme   transfer       linear       gimp  quadratic      cubic"
for formulation in usl usf musl usavg verlet rk implicit; do
  for transfer in flip pic apic tpic aflip fmpm; do
    printf '%-8s %-10s' $formulation $transfer
    for basis in linear gimp quadratic cubic; do
      "$program" symbol -formulation $formulation -transfer $transfer -basis $basis -drift 1/8 -phases 1024 |
        awk '$1 == "symbol" { g = $2 - 1; if (g < 1e-7) printf "  %9s", "0"; else printf "  %9.1e", g }'
    done
    echo
  done
done
echo
echo "bars of 16 cells, by all eigenvalues"
bar fixed usl 1
bar fixed usl 2
bar fixed musl 2
bar fixed usf 1
bar fixed_reaction usf 1
echo
near_all 1 bulk,edge,lone
near_all 2 bulk,edge,lone
near 2 corner -formulation usl -transfer apic -gradient mls -basis quadratic
echo
"$program" list codes
