#!/bin/sh
# bench.sh [march|spectrum|phases|startup|growth|scaling|boxes] [option...]: how fast the program is, beside others; --help after a
# part says what can be chosen. Options without a part are the march's; nothing at all: the first five in brief.
set -eu
cd "$(dirname "$0")/.."
./scripts/setup.sh
. ./scripts/install.sh
. ./scripts/mpi-env.sh
unset OMPI_MCA_mpi_yield_when_idle # there is a core for each rank
unset OMP_NUM_THREADS              # solvers take the threads that they would anywhere

case ${1:-} in
march | spectrum | phases | startup | growth | scaling | boxes)
  part=$1
  shift
  [ "$part" != spectrum ] || install_missing python3-scipy
  exec "./scripts/bench/bench_$part.py" "$@"
  ;;
-*) exec ./scripts/bench/bench_march.py "$@" ;;
'') ;;
*)
  echo "bench.sh: unknown part '$1'; allowed: march, spectrum, phases, startup, growth, scaling, boxes" >&2
  exit 2
  ;;
esac
install_missing python3-scipy
./scripts/bench/bench_march.py --repeats 2 --no-memory
echo
./scripts/bench/bench_spectrum.py
echo
./scripts/bench/bench_phases.py
echo
./scripts/bench/bench_startup.py
echo
./scripts/bench/bench_growth.py
