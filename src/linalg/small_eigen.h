/*
   Small dense complex matrices: their eigenvalues, by QR steps of our own, and their vectors, by LAPACK. For a matrix
   of order 4 LAPACK's zgeev mostly calls its own parts, and takes three times as long as these loops; at order 144 it
   takes twice as long.
*/
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

#define MPM_SMALL_QR_MOST 192 /* the largest order */

/*
   MpmSmallQr - computes the eigenvalues of a matrix. LAPACK balances it, Householder's reflections take it to
   Hessenberg form, and QR steps with Wilkinson's shift take that to triangular form.

   Not collective.

   Input Parameters:
+  n - the order
-  a - the matrix by columns, all of its numbers finite; it is overwritten

   Output Parameters:
+  value - the eigenvalues
-  ok    - false where the steps have not converged, as for zgeev's info > 0; value is then not set

   Sources: Golub and Van Loan 2013, 'Matrix Computations', section 7.5; Ahues and Tisseur 1997 (LAPACK Working Note
   122) for when a number below the diagonal counts as 0; Parlett and Reinsch 1969 for the balance.
*/
void MpmSmallQr(PetscInt n, double complex a[], double complex value[], PetscBool *ok);

#define MPM_MOST_HERMITIAN 3

/*
   MpmHermitianSolve - the eigenvalues of a Hermitian matrix of order n, the largest first, and eigenvectors of norm 1.

   Not collective. By LAPACK's zheev; the eigenvalues are NaN where it has not converged.

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
