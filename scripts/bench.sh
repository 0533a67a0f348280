#!/bin/sh
# Time of a step beside plain C loops of the same schemes, on 1 and 2 ranks. Options go to bench.py (--help).
set -eu
cd "$(dirname "$0")/.."
./scripts/setup.sh
. ./scripts/mpi-env.sh
unset OMPI_MCA_mpi_yield_when_idle # there is a core for each rank
python3 scripts/bench.py "$@"
