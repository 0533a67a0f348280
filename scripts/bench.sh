#!/bin/sh
# Time of a step beside a plain C loop of the same scheme, on 1 and 2 ranks. Options go to bench.py (--help).
set -eu
cd "$(dirname "$0")/.."
./scripts/setup.sh
. ./scripts/mpi-env.sh
unset OMPI_MCA_mpi_yield_when_idle # there is a core for each rank
cc -O3 -march=native -o build/gas2_plain scripts/bench/gas2_plain.c -lm
python3 scripts/bench.py "$@"
