#!/bin/sh
# From a bare Debian 12 to a result: sets up, runs the slides' three formulations, and prints what came out.
set -eu
cd "$(dirname "$0")/.."
./scripts/setup.sh
. ./scripts/mpi-env.sh

mkdir -p results
for scene in gas1-standing-wave gas2-standing-wave elastic-bar; do
  mpirun -n 2 build/mpmstab run "examples/$scene/scene.yaml" -json "results/$scene.json" >"results/$scene.txt" ||
    { cat "results/$scene.txt"; exit 1; }
done
python3 scripts/summary.py results/gas1-standing-wave.json results/gas2-standing-wave.json results/elastic-bar.json
echo
echo "Full tables: results/*.txt. Another run: build/mpmstab run examples/gas2-drifting-gas/scene.yaml"
