#!/bin/sh
# From a bare Debian 12 to a result: sets up, runs the slides' three formulations, and prints what came out.
set -eu
cd "$(dirname "$0")/.."
./scripts/setup.sh
. ./scripts/mpi-env.sh

mkdir -p results
for scene in gas1-standing-wave gas2-standing-wave gas2-drifting-gas elastic-bar; do
  mpirun -n 2 build/mpmstab run "examples/$scene/scene.yaml" -json "results/$scene.json" \
    -csv "results/$scene.csv" >"results/$scene.txt" ||
    { cat "results/$scene.txt"; exit 1; }
done
set -- results/gas1-standing-wave.json results/gas2-standing-wave.json results/gas2-drifting-gas.json \
  results/elastic-bar.json
python=$(command -v /usr/bin/python3 || command -v python3) # Debian's has matplotlib
"$python" scripts/plot_growth.py -o results/growth.png "$@"
echo "picture: results/growth.png; full tables: results/*.txt; what to see: examples/*/README.md"
echo
"$python" scripts/summary.py "$@"
