/* Dense matrices that every rank holds whole, for LAPACK. */
#pragma once
#include <mpmstab/compat.h>
#include <petscmat.h>

/* Collective. A whole copy, to be freed with MatDestroySubMatrices; without rows on ranks where it is not wanted. */
PetscErrorCode MpmDenseWhole(Mat matrix, PetscBool here, Mat **whole);

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

/*
   MpmDenseSymmetric - all eigenvalues, ascending, of a real symmetric matrix and their vectors of norm 1 by LAPACK's
   dsyevd. It divides the problem and conquers it, which at order 1000 is several times as fast as the QR steps of
   dsyev.

   Not collective. a: n x n by columns; the vectors, by columns, take its place.
*/
PetscErrorCode MpmDenseSymmetric(PetscInt n, PetscReal a[], PetscReal value[]);

/*
   MpmDenseNullity - the number of columns of a matrix minus its rank. Singular values below tolerance, relative to the
   largest, count as 0; a tolerance of 1e-12 is the least that makes sense. Collective.
*/
PetscErrorCode MpmDenseNullity(Mat matrix, PetscReal tolerance, PetscInt *nullity);
