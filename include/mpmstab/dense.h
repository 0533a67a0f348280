/* Whole matrices on every rank, for LAPACK. */
#pragma once
#include <mpmstab/compat.h>
#include <petscmat.h>

/* Collective. A parallel matrix by columns on every rank; room for rows x columns numbers. */
PetscErrorCode MpmDenseCopy(Mat matrix, PetscReal values[]);

/* Order up to which all eigenvalues are taken where that is done many times over. */
#define MPM_DENSE_MANY 2048

/*
   MpmDenseLargest - re and im of the eigenvalue of largest abs among all (LAPACK, without vectors).

   Collective. re is infinite when the matrix is not finite, NaN when LAPACK did not converge.
*/
PetscErrorCode MpmDenseLargest(Mat matrix, PetscReal value[2]);
