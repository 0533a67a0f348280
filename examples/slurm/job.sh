#!/bin/bash
# A job for Slurm: sbatch job.sh SCENE.yaml [-option value]...
# README.md beside it says what to change and why.
#SBATCH --job-name=mpmstab
#SBATCH --nodes=4
#SBATCH --ntasks-per-node=64
#SBATCH --cpus-per-task=1
#SBATCH --hint=nomultithread
#SBATCH --exclusive
#SBATCH --mem=0
#SBATCH --time=02:00:00
#SBATCH --signal=TERM@300
#SBATCH --requeue
#SBATCH --open-mode=append
#SBATCH --output=%x-%j.log
set -euo pipefail

if [ $# -eq 0 ] || [ ! -f "$1" ]; then
  echo "job.sh: no scene '${1:-}'; allowed: sbatch job.sh SCENE.yaml [-option value]..." >&2
  exit 2
fi
name=$(basename "$1" .yaml)-${SLURM_JOB_ID:?"start it with sbatch"}
export OMP_NUM_THREADS=1 # a rank is a core; the linear algebra must not start more threads
export GLIBC_TUNABLES=glibc.malloc.hugetlb=1 # large pages where the system gives them on demand

# A job that was requeued, or ran out of its time before, goes on from its checkpoint.
restart=()
if [ -s "$name.h5" ]; then
  restart=(-restart "$name.h5")
fi
srun --cpu-bind=cores --distribution=block:block --kill-on-bad-exit=1 "${MPMSTAB:-mpmstab}" run "$@" \
  -checkpoint "$name.h5" -checkpoint_every "${EVERY:-10000}" "${restart[@]}" -json "$name.json" -progress false \
  -log_view ":$name.csv:ascii_csv"
