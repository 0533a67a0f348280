/* Small dense complex matrices: their eigenvalues, by QR steps of our own, and their vectors, by LAPACK. */
#pragma once
#include <mpmstab/compat.h>
#include <complex.h>

/*S
   MpmSmallEigen - a matrix, its eigenvalues and vectors, and work space, for any number of matrices of one size.
S*/
typedef struct {
  PetscInt        n, lwork;
  double complex *matrix, *value, *right, *left, *work;
  PetscReal      *rwork;
} MpmSmallEigen;

/* Not collective. MpmSmallEigenCreate allocates room for n x n matrices. */
PetscErrorCode MpmSmallEigenCreate(PetscInt n, MpmSmallEigen *small);
PetscErrorCode MpmSmallEigenDestroy(MpmSmallEigen *small);

/*
   MpmSmallEigenSolve - computes the eigenvalues small->value of small->matrix, which is stored by columns and
   overwritten.

   With vectors it also fills the columns of small->right and small->left with right and left eigenvectors of norm 1.
   When the matrix is not finite, all eigenvalues are infinite and all vectors are 0. Without vectors, left serves as
   work space.

   Not collective.
*/
PetscErrorCode MpmSmallEigenSolve(MpmSmallEigen *small, PetscBool vectors);

/* Not collective. The eigenvalues by LAPACK alone, with which those of MpmSmallEigenSolve are compared. */
PetscErrorCode MpmSmallEigenLapack(MpmSmallEigen *small);
