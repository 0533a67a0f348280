/*
   Unknowns that feel nobody else are taken away, then those that felt only these, and so on (Kahn 1962). The matrix is
   strictly triangular in this order if none is left.
*/
#include "linalg/nilpotent.h"
#include <mpmstab/compat.h>

/* The unknowns that are taken away, one after the other; AT has a row for each column of the matrix. */
static PetscErrorCode TakeAway(Mat A, Mat AT, PetscInt order, PetscInt *taken, PetscInt *last)
{
  PetscInt          *felt, *queue, n = 0;
  const PetscInt    *columns;
  const PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(order, &felt, order, &queue));
  for (PetscInt i = 0; i < order; i++) {
    PetscInt entries;

    PetscCall(MatGetRow(A, i, &entries, NULL, &values));
    for (PetscInt k = 0; k < entries; k++) felt[i] += values[k] != 0;
    PetscCall(MatRestoreRow(A, i, &entries, NULL, &values));
    if (!felt[i]) queue[n++] = i;
  }
  for (*taken = 0; *taken < n; ++*taken) {
    PetscInt entries;

    PetscCall(MatGetRow(AT, queue[*taken], &entries, &columns, &values));
    for (PetscInt k = 0; k < entries; k++)
      if (values[k] != 0 && !--felt[columns[k]]) queue[n++] = columns[k];
    PetscCall(MatRestoreRow(AT, queue[*taken], &entries, &columns, &values));
  }
  *last = n ? queue[n - 1] : -1;
  PetscCall(PetscFree2(felt, queue));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNilpotentFind(Mat A, PetscInt *unit)
{
  PetscInt    order, taken = 0, last = -1;
  PetscReal   diagonal;
  PetscBool   sparse;
  PetscMPIInt size;
  Vec         d;
  Mat         whole, transposed;

  PetscFunctionBegin;
  *unit = -1;
  PetscCall(PetscObjectTypeCompareAny((PetscObject)A, &sparse, MATSEQAIJ, MATMPIAIJ, ""));
  if (!sparse) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatCreateVecs(A, &d, NULL));
  PetscCall(MatGetDiagonal(A, d));
  PetscCall(VecNorm(d, NORM_INFINITY, &diagonal));
  PetscCall(VecDestroy(&d));
  if (diagonal != 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)A), &size));
  PetscCall(MatCreateRedundantMatrix(A, size, MPI_COMM_NULL, MAT_INITIAL_MATRIX, &whole));
  PetscCall(MatTranspose(whole, MAT_INITIAL_MATRIX, &transposed));
  PetscCall(MatGetSize(A, &order, NULL));
  PetscCall(TakeAway(whole, transposed, order, &taken, &last));
  if (taken == order) *unit = last;
  PetscCall(MatDestroy(&transposed));
  PetscCall(MatDestroy(&whole));
  PetscFunctionReturn(PETSC_SUCCESS);
}
