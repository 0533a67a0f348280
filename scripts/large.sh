#!/bin/sh
# Leading eigenvalues of operators of order 1e6 in two and three dimensions, and what they cost (the table of docs/dev/speed.md).
# scripts/large.sh [RANKS]: on so many ranks, 1 by default. A minute on one rank, 0.7 GB.
set -eu
cd "$(dirname "$0")/.."
. ./scripts/mpi-env.sh
program=${MPMSTAB:-build/mpmstab}
ranks=${1:-1}

leading() {
  echo "-formulation usl $*"
  mpirun --oversubscribe -n "$ranks" "$program" spectrum -formulation usl -measure false -progress false "$@" |
    grep -E '^ +spectrum|^operator|^solver|^verdict|^time|^memory'
  echo
}

leading -dim 2 -cells 256 -courant 1 -expect unstable
leading -dim 2 -cells 256 -courant 0.7 -expect stable
leading -dim 3 -cells 24 -courant 1 -expect unstable
leading -dim 3 -cells 24 -courant 0.7 -expect stable
leading -dim 3 -cells 24 -courant 1 -eps_type krylovschur
