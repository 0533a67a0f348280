#!/bin/sh
# From a bare Debian 12 to a result: sets up, takes the slides' three schemes apart and runs them, prints what came out.
set -eu
cd "$(dirname "$0")/.."
./scripts/setup.sh
. ./scripts/mpi-env.sh

mkdir -p results
scenes="gas1-standing-wave gas2-standing-wave gas2-beyond-its-limit gas2-rings-when-it-drifts elastic-damps"
pictured=
for scene in $scenes; do
  file=examples/$scene/scene.yaml
  mpirun -n 2 build/mpmstab spectrum "$file" -json "results/$scene-spectrum.json" >"results/$scene-spectrum.txt" ||
    { cat "results/$scene-spectrum.txt"; exit 1; }
  mpirun -n 2 build/mpmstab run "$file" -json "results/$scene.json" -csv "results/$scene.csv" \
    >"results/$scene.txt" || { cat "results/$scene.txt"; exit 1; }
done
mpirun -n 2 build/mpmstab run examples/elastic-bar/scene.yaml -json results/elastic-bar.json \
  -csv results/elastic-bar.csv >results/elastic-bar.txt
for scene in gas1-standing-wave gas2-standing-wave gas2-rings-when-it-drifts elastic-bar; do
  pictured="$pictured results/$scene.json"
done
pictured="$pictured results/gas2-rings-when-it-drifts-spectrum.json" # no formula predicts its growth
python=$(command -v /usr/bin/python3 || command -v python3) # Debian's has matplotlib
# shellcheck disable=SC2086 # a list of files
"$python" scripts/pictures.py growth $pictured -s 640 -o results/growth
echo "picture: results/growth.png (.svg); full tables: results/*.txt; what to see: examples/*/README.md"
echo
# shellcheck disable=SC2086 # a list of scenes
"$python" scripts/report/summary.py results $scenes
