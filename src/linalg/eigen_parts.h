/* What MpmEigenSolve is made of. */
#pragma once
#include <mpmstab/compat.h>
#include <slepceps.h>

/* ---- all eigenvalues of a matrix that fits in the memory of one rank (eigen_dense.c) ---- */

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

/*
   MpmNilpotentFind - finds whether a sparse matrix is strictly triangular in some order of its unknowns: no unknown
   feels itself, be it over others. Krylov's method does not find the eigenvalues 0 of such a matrix, or finds others,
   since rounding moves them far.

   Collective. unit: an unknown whose unit vector the matrix maps to 0; -1 where the matrix is not of this kind, or not
   AIJ.
*/
PetscErrorCode MpmNilpotentFind(Mat A, PetscInt *unit);

/* ---- those near a complex target in real arithmetic, and Rayleigh-Ritz (ritz.c) ---- */

/* Collective. Computes T = (A - a I)^2 + b^2 I, or A - a I when b is 0. */
PetscErrorCode MpmRitzMatrix(Mat A, const PetscReal target[2], Mat *T);

/*
   MpmRitzExtract - computes eigenvalues (re, im) of A on the space spanned by given vectors X and by A X.

   Collective. The vectors are scaled. basis: an orthonormal basis of that space. n: its dimension. The vector of value
   j is

     basis times coefficients[2 n j + (0 .. n-1)] + i basis times coefficients[2 n j + n + (0 .. n-1)]

   Free the arrays with PetscFree.
*/
PetscErrorCode MpmRitzExtract(Mat A, PetscInt given, Vec vectors[], BV *basis, PetscInt *n, PetscReal **re,
                              PetscReal **im, PetscReal **coefficients);

/*
   Collective. Sets the solver to find eigenvalues near 0 of T by shift-and-invert. Call it before options are
   read.
*/
PetscErrorCode MpmEigenTargetSet(EPS eps, PetscInt restarts);

/*
   Collective. Sets a small Krylov space, unless options have asked for more eigenvalues or another space. Call it after
   options are read.
*/
PetscErrorCode MpmEigenTargetBasis(EPS eps);
