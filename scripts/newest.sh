#!/bin/sh
# newest.sh [FOLDER]: builds the newest released PETSc and SLEPc (from PyPI, which has their sources) and this project
# against them in FOLDER (build-newest), and runs all tests. The rest is Debian's. What is built is used again.
set -eu
folder=${1:-$(dirname "$0")/../build-newest}
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
cd "$(dirname "$0")/.."
. ./scripts/mpi-env.sh
. ./scripts/install.sh
# a Fortran compiler: PETSc takes MUMPS only with one
# shellcheck disable=SC2086 # a list of packages
install_missing $common_packages $test_packages ca-certificates gfortran liblapack-dev libmumps-dev libscalapack-openmpi-dev

logged() { # LOG COMMAND...: what it says is shown only when it fails
  log=$folder/$1.log
  shift
  "$@" >"$log" 2>&1 || { tail -n 100 "$log"; echo "failed, see $log"; exit 1; }
}

# A SLEPc goes with the PETSc of its series only, and may be released later.
slepc=$(python3 scripts/fetch_source.py slepc "$folder")
petsc=$(python3 scripts/fetch_source.py petsc "$folder" "${slepc%.*}")
export PETSC_DIR="$folder/petsc-$petsc" SLEPC_DIR="$folder/slepc-$slepc" PETSC_ARCH=newest
unset PETSC_OPTIONS

if [ ! -e "$PETSC_DIR/$PETSC_ARCH/lib/libpetsc.so" ]; then
  echo "building PETSc $petsc"
  # real scalars and 32 bit integers, as Debian's; LAPACK is the one that CMake finds and MUMPS uses
  (
    cd "$PETSC_DIR"
    logged petsc-configure ./configure --with-debugging=0 --COPTFLAGS=-O2 --FOPTFLAGS=-O2 --with-shared-libraries=1 \
      --with-cc=mpicc --with-fc=mpif90 --with-cxx=0 --with-fortran-bindings=0 --with-make-np=2 --with-x=0 \
      --with-blaslapack-lib="-llapack -lblas" --with-mumps=1 --with-scalapack-lib=-lscalapack-openmpi \
      --with-hdf5-include=/usr/include/hdf5/openmpi --with-hdf5-lib="-lhdf5_openmpi_hl -lhdf5_openmpi"
    logged petsc-make make all
  )
fi
if [ ! -e "$SLEPC_DIR/$PETSC_ARCH/lib/libslepc.so" ]; then
  echo "building SLEPc $slepc"
  (
    cd "$SLEPC_DIR"
    logged slepc-configure ./configure
    logged slepc-make make all
  )
fi

build=$folder/mpmstab
mkdir -p "$build"
rm -f "$build/CMakeCache.txt" # it keeps what pkg-config said, perhaps of older ones
logged cmake cmake -S . -B "$build" -DCMAKE_BUILD_TYPE=Release
logged build cmake --build "$build" --parallel 2
grep -i 'warning' "$folder/build.log" || true
ldd "$build/mpmstab" >"$folder/libraries.txt"
for library in "$PETSC_DIR/$PETSC_ARCH/lib/libpetsc" "$SLEPC_DIR/$PETSC_ARCH/lib/libslepc"; do
  grep -qF " => $library.so" "$folder/libraries.txt" || { echo "the program does not load $library"; exit 1; }
done
if [ "$(grep -cE 'lib(petsc|slepc)' "$folder/libraries.txt")" -ne 2 ]; then # of no other series beside them
  cat "$folder/libraries.txt"
  exit 1
fi

echo "PETSc $petsc, SLEPc $slepc, $(mpirun --version | head -n 1)"
ctest --test-dir "$build" --output-on-failure --parallel 2
