/* All eigenvalues of a matrix that fits a rank: what MpmEigenSolve does up to DENSE_ORDER. */
#pragma once
#include <mpmstab/compat.h>
#include <slepceps.h>

/* Not collective. Whether an eps' options leave LAPACK's eigenvalues as they are, and ask for nothing that SLEPc does. */
PetscErrorCode MpmEigenDenseIsPlain(EPS eps, PetscBool *plain);

/*
   MpmEigenDenseSolve - eigenvalues re + i im (of a pair the upper one first) and vectors of a finite matrix.

   Collective; the first rank solves alone. rows: this rank's rows of the vectors, column by column, for
   MpmEigenDenseVector; free with PetscFree. failed: LAPACK did not converge, and nothing of it holds.
*/
PetscErrorCode MpmEigenDenseSolve(Mat A, PetscReal re[], PetscReal im[], PetscReal *rows[], PetscBool *failed);

/* Not collective. The vector of eigenvalue j. */
PetscErrorCode MpmEigenDenseVector(const PetscReal rows[], const PetscReal value_im[], PetscInt j, Vec re, Vec im);
