/* Eigenvalues and vectors of Hermitian matrices of order up to 3. */
#pragma once
#include <mpmstab/compat.h>
#include <complex.h>

#define MPM_MOST_HERMITIAN 3

/*
   MpmHermitianSolve - the eigenvalues of a Hermitian matrix of order n, the largest first, and eigenvectors of norm 1.

   Not collective. It rotates until the numbers beside the diagonal are lost to rounding (Jacobi's method).

   Input Parameters:
+  n      - the order, 1 to MPM_MOST_HERMITIAN
-  matrix - by rows; it is overwritten

   Output Parameters:
+  value  - the eigenvalues
-  vector - vector[i][a]: component a of the eigenvector of value i
*/
void MpmHermitianSolve(PetscInt n, double complex matrix[MPM_MOST_HERMITIAN][MPM_MOST_HERMITIAN],
                       PetscReal      value[MPM_MOST_HERMITIAN],
                       double complex vector[MPM_MOST_HERMITIAN][MPM_MOST_HERMITIAN]);
