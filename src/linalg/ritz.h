/* Eigenvalues near a complex target in real arithmetic, and Rayleigh-Ritz, for MpmEigenSolve and MpmEigenRitz. */
#pragma once
#include <mpmstab/compat.h>
#include <slepceps.h>

/* Collective. Computes T = (A - a I)^2 + b^2 I, or A - a I when b is 0. */
PetscErrorCode MpmRitzMatrix(Mat A, const PetscReal target[2], Mat *T);

/*
   MpmRitzExtract - computes eigenvalues (re, im) of A on the space spanned by given vectors X and by A X.

   Collective. The vectors are scaled. basis: an orthonormal basis of that space. n: its dimension. The vector of value j is

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
