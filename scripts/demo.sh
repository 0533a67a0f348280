#!/bin/sh
# From a bare Debian 12 to an answer: installs what is missing, builds, finds the largest stable step of MLS-MPM in
# three dimensions, and takes the slides' three schemes apart and runs them.
set -eu
[ $# -eq 0 ] || { sed -n '2,3s/^# //p' "$0" && exit 2; } >&2
cd "$(dirname "$0")/.."
./scripts/setup.sh
. ./scripts/install.sh
. ./scripts/mpi-env.sh
alone results/demo.lock "which runs this demo here"

set -- build/mpmstab critical -dim 3 -formulation usl -transfer apic -gradient mls -basis quadratic \
  -young 1e6 -poisson 0.3 -density 1000 -cell_width 0.01 -neighbourhood bulk,lone
echo "The largest stable time step of MLS-MPM in three dimensions, with its reason:"
echo
echo "\$ $*"
"$@"
echo
echo "The three schemes of the slides, which takes some seconds:"
echo

logged() { # NAME COMMAND...: what the command says is in results/NAME.txt, and on the screen if it fails
  log=results/$1.txt
  shift
  "$@" >"$log" 2>&1 || { cat "$log" >&2 && give_up "This failed: $*"; }
}

scenes="gas1-standing-wave gas2-standing-wave gas2-beyond-its-limit gas2-rings-when-it-drifts elastic-damps"
for scene in $scenes elastic-bar; do
  file=examples/$scene/scene.yaml
  [ "$scene" = elastic-bar ] || # elastic-damps has the same waves
    logged "$scene-spectrum" build/mpmstab spectrum "$file" -json "results/$scene-spectrum.json"
  set -- run "$file" -json "results/$scene.json" -csv "results/$scene.csv"
  case $scene in *-wave | elastic-bar) set -- "$@" -output "results/$scene.h5" -output_every 1 ;; esac
  logged "$scene" build/mpmstab "$@"
done
# shellcheck disable=SC2086 # a list of scenes
logged slides python scripts/report/summary.py results $scenes
sed '/^$/q' results/slides.txt # the first of its two tables

# the spectrum predicts the growth of particles that move, for which there is no formula
logged pictures python scripts/pictures.py growth results/gas1-standing-wave.json results/gas2-standing-wave.json \
  results/gas2-rings-when-it-drifts.json results/elastic-bar.json results/gas2-rings-when-it-drifts-spectrum.json \
  -s 640 -o results/growth
for scene in gas1-standing-wave gas2-standing-wave elastic-bar; do
  logged pictures python scripts/pictures.py spacetime "results/$scene.h5" -o "results/$scene"
done
cat <<END
pictures: results/growth.png, how four of the runs grow; over place and time: results/gas1-standing-wave.png,
          results/gas2-standing-wave.png, results/elastic-bar.png
tables:   results/slides.txt; all that each scene gave: results/*.txt, *.json, *.csv, *.h5
read on:  README.md, with your own scheme and numbers; docs/slides.md, what the slides say and what holds
END
