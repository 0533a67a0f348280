/* What MpmEigenSolve sets to find eigenvalues near a target. */
#pragma once
#include <mpmstab/compat.h>
#include <slepceps.h>

/*
   Collective. Sets the solver to find eigenvalues near 0 of its matrix by shift-and-invert. Call it before options are
   read.
*/
PetscErrorCode MpmEigenTargetSet(EPS eps, PetscInt restarts);

/*
   Collective. Sets a small Krylov space, unless options have asked for more eigenvalues or another space. Call it after
   options are read.
*/
PetscErrorCode MpmEigenTargetBasis(EPS eps);
