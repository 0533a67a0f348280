/* All eigenvalues of a matrix that fits in the memory of one rank, for MpmEigenSolve. */
#pragma once
#include <mpmstab/compat.h>
#include <slepceps.h>

/*
   Not collective. Finds whether the options leave LAPACK's eigenvalues as they are and ask for nothing that only SLEPc
   can do.
*/
PetscErrorCode MpmEigenDenseIsPlain(EPS eps, PetscBool *plain);

/*
   MpmEigenDenseSolve - computes eigenvalues re + i im and vectors of a finite matrix. Of a complex pair the upper one
   comes first.

   Collective; the first rank solves alone. rows: this rank's rows of the vectors, column by column, for
   MpmEigenDenseVector; free them with PetscFree. failed: LAPACK did not converge, and no result may be used.
*/
PetscErrorCode MpmEigenDenseSolve(Mat A, PetscReal re[], PetscReal im[], PetscReal *rows[], PetscBool *failed);

/* Not collective. Gives the vector of eigenvalue j. */
PetscErrorCode MpmEigenDenseVector(const PetscReal rows[], const PetscReal value_im[], PetscInt j, Vec re, Vec im);
