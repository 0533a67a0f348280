/* The inverse of the normal equations, for SOLVE over sparse registers. */
#pragma once
#include <mpmstab/compat.h>
#include <petscmat.h>

/*
   MpmNormalInverse - (W^T W)^+ M for W (particles x nodes) and masses M on the nodes; eigenvalues of W^T W, scaled
   by the masses, below 1e-12 of the largest are taken for 0. Numbers that are lost in rounding are left out. W is
   overwritten.

   Collective. Every rank diagonalises the whole matrix (LAPACK); refuses more than 3000 nodes.
*/
PetscErrorCode MpmNormalInverse(Mat W, Vec masses, Mat *inverse);
