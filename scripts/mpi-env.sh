# Sourced by the scripts here: lets Open MPI run as root and with more ranks than cores; one thread per rank.
# shellcheck shell=sh
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_mpi_yield_when_idle=1
export OMP_NUM_THREADS=1
export OMPI_MCA_pml=ob1 # on one machine: looking for networks takes longer than a small task
