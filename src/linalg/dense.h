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

/*
   MpmDenseEigen - all eigenvalues re + i im of a real matrix by LAPACK's dgeev, which balances.

   Not collective. a: n x n by columns, overwritten. vectors: NULL, or room for n x n; those of a pair, whose upper value
   comes first, are columns j and j + 1, re and im. failed: not 0 when LAPACK did not converge.
*/
PetscErrorCode MpmDenseEigen(PetscInt n, PetscReal a[], PetscReal re[], PetscReal im[], PetscReal vectors[],
                             int *failed);
