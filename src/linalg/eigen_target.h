/* What MpmEigenSolve sets where it looks near a target. */
#pragma once
#include <mpmstab/compat.h>
#include <slepceps.h>

/* Collective. Eigenvalues of the eps' matrix near 0 by shift-and-invert; before options are read. */
PetscErrorCode MpmEigenTargetSet(EPS eps, PetscInt restarts);

/* Collective. A small Krylov space, where the options, read before, have not asked for more eigenvalues or another. */
PetscErrorCode MpmEigenTargetBasis(EPS eps);
