/* Eigenvalues of a matrix by its smaller one, for MpmEigenSolveReduced, and what it shares with eigen.c. */
#pragma once
#include "linalg/eigen.h"

#define MPM_EIGEN_ACCEPTED 1e-7 /* largest residual of a listed pair */

/* Collective. The residual of x = x[0] + i x[1] as MpmEigen has it. r is work space. */
PetscErrorCode MpmEigenResidual(const MpmEigen *e, PetscReal re, PetscReal im, Vec x[2], Vec r, PetscReal *residual);

/*
   Not collective. Sorts by -abs, then by the angle from the positive real axis; of a pair the upper half comes first. The
   angle enters the key with a small weight, so that rounding of the abs does not decide the order.
*/
PetscErrorCode MpmEigenSort(MpmEigen *e);

/* Collective. The infinity norm; that of a transposed shell is not known, and a lower bound of its own is. */
PetscErrorCode MpmEigenNorm(Mat A, PetscReal *norm);

/* Collective. The vector of listed pair j of a solve by a smaller matrix, before it is scaled. */
PetscErrorCode MpmEigenReducedVector(const MpmEigen *e, PetscInt j, Vec re, Vec im);
