/* The inverse of the normal equations, for the operation SOLVE of an assembled operator. */
#pragma once
#include <mpmstab/compat.h>
#include <petscmat.h>

/*
   MpmNormalInverse - computes (W^T W)^+ M for W (particles x nodes) and the masses M on the nodes.

   Eigenvalues of W^T W, scaled by the masses, below 1e-12 of the largest count as 0. Negligible numbers are left out. W
   is overwritten.

   Collective. Every rank diagonalises the whole matrix (LAPACK). Refuses more than 3000 nodes.
*/
PetscErrorCode MpmNormalInverse(Mat W, Vec masses, Mat *inverse);
