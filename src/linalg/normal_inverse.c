/*
   (W^T W)^+ M by all eigenvalues and vectors, in the scaled form

     D (D W^T W D)^+ D^-1   with D = M^-1/2

   The scaling gives light and heavy nodes the same weight. Then only nodal data that no particle feels are singular.
*/
#include "linalg/dense.h"
#include <mpmstab/errors.h>
#include "linalg/normal_inverse.h"
#include <petscblaslapack.h>
#include <math.h>

#define MOST_NODES 3000
#define SINGULAR 1e-12   /* relative to the largest eigenvalue */
#define NEGLIGIBLE 1e-18 /* relative to the largest number of the inverse */

/* Computes W^T W as a dense matrix on every rank. */
static PetscErrorCode Square(Mat W, PetscReal square[])
{
  Mat product;

  PetscFunctionBegin;
  PetscCall(MatTransposeMatMult(W, W, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &product));
  PetscCall(MpmDenseCopy(product, square));
  PetscCall(MatDestroy(&product));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Replaces a symmetric matrix by its eigenvectors, as columns, divided by the square roots of their eigenvalues. Where
   an eigenvalue counts as 0 the column becomes 0.
*/
static PetscErrorCode HalfInverse(PetscInt n, PetscReal a[])
{
  PetscReal *lambda;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &lambda));
  PetscCall(MpmDenseSymmetric(n, a, lambda));
  for (PetscInt j = 0; j < n; j++) {
    const PetscReal scale = lambda[j] > SINGULAR * lambda[n - 1] ? 1 / sqrt(lambda[j]) : 0;

    for (PetscInt i = 0; i < n; i++) a[(size_t)j * n + i] *= scale;
  }
  PetscCall(PetscFree(lambda));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Fills this rank's rows of half half^T. Negligible numbers, which are rounding, are left out. */
static PetscErrorCode FillRows(PetscInt n, const PetscReal half[], Mat inverse)
{
  PetscReal      *rows, largest = 0;
  PetscInt       *columns, begin, end;
  PetscBLASInt    order, count;
  const PetscReal one = 1, zero = 0;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(inverse, &begin, &end));
  PetscCall(PetscMalloc2((size_t)n * (end - begin) + 1, &rows, n, &columns));
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCall(PetscBLASIntCast(end - begin, &count));
  if (count)
    PetscCallBLAS("BLASgemm", BLASgemm_("N", "T", &order, &count, &order, &one, half, &order, half + begin, &order,
                                        &zero, rows, &order));
  for (size_t i = 0; i < (size_t)n * (end - begin); i++) largest = PetscMax(largest, fabs(rows[i]));
  for (PetscInt i = begin; i < end; i++) {
    PetscReal *row  = rows + (size_t)n * (i - begin);
    PetscInt   kept = 0;

    for (PetscInt j = 0; j < n; j++) {
      if (fabs(row[j]) <= NEGLIGIBLE * largest) continue;
      columns[kept] = j;
      row[kept++]   = row[j];
    }
    PetscCall(MatSetValues(inverse, 1, &i, kept, columns, row, INSERT_VALUES));
  }
  PetscCall(PetscFree2(rows, columns));
  PetscCall(MatAssemblyBegin(inverse, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(inverse, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes sqrt(M) and 1 / sqrt(M), which is 0 where there is no mass. */
static PetscErrorCode Roots(Vec masses, Vec *root, Vec *inverse)
{
  PetscFunctionBegin;
  PetscCall(VecDuplicate(masses, root));
  PetscCall(VecDuplicate(masses, inverse));
  PetscCall(VecCopy(masses, *root));
  PetscCall(VecSqrtAbs(*root));
  PetscCall(VecCopy(*root, *inverse));
  PetscCall(VecReciprocal(*inverse)); /* of the numbers that are not 0 */
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNormalInverse(Mat W, Vec masses, Mat *inverse)
{
  PetscInt   n, local;
  PetscReal *half;
  Vec        root, inverse_root;

  PetscFunctionBegin;
  PetscCall(MatGetSize(W, NULL, &n));
  PetscCall(MatGetLocalSize(W, NULL, &local));
  MpmCheckInput(n <= MOST_NODES,
                "cells: the operator of this transfer holds an inverse of %" PetscInt_FMT
                " nodes; allowed: at most %d ('mpmstab run' and 'symbol' take more)",
                n, MOST_NODES);
  PetscCall(PetscMalloc1((size_t)n * n, &half));
  PetscCall(Roots(masses, &root, &inverse_root));
  PetscCall(MatDiagonalScale(W, NULL, inverse_root));
  PetscCall(Square(W, half));
  PetscCall(HalfInverse(n, half));
  PetscCall(MatCreateAIJ(PetscObjectComm((PetscObject)W), local, local, n, n, local, NULL, n - local, NULL, inverse));
  PetscCall(FillRows(n, half, *inverse));
  PetscCall(PetscFree(half));
  PetscCall(MatDiagonalScale(*inverse, inverse_root, root));
  PetscCall(VecDestroy(&root));
  PetscCall(VecDestroy(&inverse_root));
  PetscFunctionReturn(PETSC_SUCCESS);
}
