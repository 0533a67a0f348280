/* Eigenvalues of one small dense complex matrix, by LAPACK. */
#pragma once
#include <mpmstab/compat.h>
#include <complex.h>

/*S
   MpmSmallEigen - room for matrices of one size.
S*/
typedef struct {
  PetscInt        n, lwork;
  double complex *matrix, *value, *right, *left, *work;
  PetscReal      *rwork;
} MpmSmallEigen;

/* Not collective. */
PetscErrorCode MpmSmallEigenCreate(PetscInt n, MpmSmallEigen *small);
PetscErrorCode MpmSmallEigenDestroy(MpmSmallEigen *small);

/*
   MpmSmallEigenSolve - eigenvalues of small->matrix (columns, destroyed) into small->value; with vectors, normed
   right and left vectors into the columns of small->right and small->left. Infinite eigenvalues, and vectors 0, when
   the matrix is not finite.

   Not collective.
*/
PetscErrorCode MpmSmallEigenSolve(MpmSmallEigen *small, PetscBool vectors);
