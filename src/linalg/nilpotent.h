/* Matrices whose eigenvalues are all 0 because of where their entries are. */
#pragma once
#include <petscmat.h>

/*
   MpmNilpotentFind - finds whether a sparse matrix is strictly triangular in some order of its unknowns: no unknown feels
   itself, be it over others. Krylov's method does not find the eigenvalues 0 of such a matrix, or finds others, since
   rounding moves them far.

   Collective. unit: an unknown whose unit vector the matrix maps to 0; -1 where the matrix is not of this kind, or not AIJ.
*/
PetscErrorCode MpmNilpotentFind(Mat A, PetscInt *unit);
