/* Dense matrices that every rank holds whole, for LAPACK. */
#pragma once
#include <mpmstab/compat.h>
#include <petscmat.h>

/* Collective. Copies a parallel matrix to every rank, column by column. values has room for rows x columns numbers. */
PetscErrorCode MpmDenseCopy(Mat matrix, PetscReal values[]);

/* Up to this order all eigenvalues are computed where many matrices are solved. */
#define MPM_DENSE_MANY 2048

/*
   MpmDenseLargest - the eigenvalue of largest abs (real and imaginary part), found among all of them by LAPACK.

   Collective. The real part is infinite when the matrix is not finite, and NaN when LAPACK did not converge.
*/
PetscErrorCode MpmDenseLargest(Mat matrix, PetscReal value[2]);

/*
   MpmDenseEigen - all eigenvalues re + i im of a real matrix by LAPACK's dgeev, which balances.

   Not collective. a: n x n by columns, overwritten. vectors: NULL, or room for n x n. Of a complex pair the eigenvalue
   with im > 0 comes first, and columns j and j + 1 hold the real and the imaginary part of its vector. failed: not 0
   when LAPACK did not converge.
*/
PetscErrorCode MpmDenseEigen(PetscInt n, PetscReal a[], PetscReal re[], PetscReal im[], PetscReal vectors[],
                             int *failed);
