/*
   The operator of a matrix that was given: of a file, or of a code that was probed. Its units are anybody's, so it is
   balanced: rows and columns are scaled by powers of two until both have about the same size.
*/
#include "operator/given.h"
#include <math.h>

#define SWEEPS 40  /* each halves the distance to balance, on a scale of logarithms */
#define CLOSE 0.25 /* change of a logarithm to base 2 below which a sweep is the last */
#define GAIN 4     /* the norm must become so many times smaller, else the matrix stays as it is */

/* The sums of abs of a matrix' rows without the diagonal, each column times its scale. */
static PetscErrorCode RowSums(Mat A, Vec scale, Vec sums)
{
  Vec          all;
  VecScatter   scatter;
  PetscInt     begin, end;
  PetscScalar *sum;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(A, &begin, &end));
  PetscCall(VecScatterCreateToAll(scale, &scatter, &all));
  PetscCall(VecScatterBegin(scatter, scale, all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(scatter, scale, all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecGetArray(sums, &sum));
  for (PetscInt row = begin; row < end; row++) {
    PetscInt           n;
    const PetscInt    *columns;
    const PetscScalar *values, *of;

    sum[row - begin] = 0;
    PetscCall(VecGetArrayRead(all, &of));
    PetscCall(MatGetRow(A, row, &n, &columns, &values));
    for (PetscInt i = 0; i < n; i++)
      if (columns[i] != row) sum[row - begin] += fabs(values[i]) * of[columns[i]];
    PetscCall(MatRestoreRow(A, row, &n, &columns, &values));
    PetscCall(VecRestoreArrayRead(all, &of));
  }
  PetscCall(VecRestoreArray(sums, &sum));
  PetscCall(VecScatterDestroy(&scatter));
  PetscCall(VecDestroy(&all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   One sweep. With D = diag(d), row i of D A D^-1 has the sum r_i = d_i sum_j abs(a_ij) / d_j, and its column the sum
   c_i = sum_j d_j abs(a_ji) / d_i. Each d_i is multiplied by (c_i / r_i)^(1/4): all are moved at once, and so half as far
   as one alone would be. change: the largest, of the logarithm to base 2.
*/
static PetscErrorCode Sweep(Mat A, Mat transposed, Vec d, Vec inverse, Vec rows, Vec columns, PetscReal *change)
{
  const PetscScalar *r, *c;
  PetscScalar       *scale;
  PetscInt           n;

  PetscFunctionBegin;
  PetscCall(VecCopy(d, inverse));
  PetscCall(VecReciprocal(inverse));
  PetscCall(RowSums(A, inverse, rows));
  PetscCall(RowSums(transposed, d, columns));
  PetscCall(VecGetLocalSize(d, &n));
  PetscCall(VecGetArrayRead(rows, &r));
  PetscCall(VecGetArrayRead(columns, &c));
  PetscCall(VecGetArray(d, &scale));
  *change = 0;
  for (PetscInt i = 0; i < n; i++) {
    PetscReal by = c[i] / scale[i] / (r[i] * scale[i]);

    if (!isnormal(by)) continue; /* nothing in the row or in the column, so that no scale balances them */
    by = sqrt(sqrt(by));
    scale[i] *= by;
    *change = PetscMax(*change, fabs(log2(by)));
  }
  PetscCall(VecRestoreArray(d, &scale));
  PetscCall(VecRestoreArrayRead(rows, &r));
  PetscCall(VecRestoreArrayRead(columns, &c));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, change, 1, MPIU_REAL, MPI_MAX, PetscObjectComm((PetscObject)A)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the diagonal of D: powers of two, so that scaling rounds nothing. */
static PetscErrorCode FindScale(Mat A, Vec d)
{
  PetscReal    change = INFINITY;
  PetscScalar *scale;
  PetscInt     n;
  Mat          transposed;
  Vec          inverse, rows, columns;

  PetscFunctionBegin;
  PetscCall(MatTranspose(A, MAT_INITIAL_MATRIX, &transposed));
  PetscCall(VecDuplicate(d, &inverse));
  PetscCall(VecDuplicate(d, &rows));
  PetscCall(VecDuplicate(d, &columns));
  PetscCall(VecSet(d, 1));
  for (PetscInt sweep = 0; sweep < SWEEPS && change > CLOSE; sweep++)
    PetscCall(Sweep(A, transposed, d, inverse, rows, columns, &change));
  PetscCall(VecGetLocalSize(d, &n));
  PetscCall(VecGetArray(d, &scale));
  for (PetscInt i = 0; i < n; i++) scale[i] = exp2(rint(log2(scale[i])));
  PetscCall(VecRestoreArray(d, &scale));
  PetscCall(VecDestroy(&inverse));
  PetscCall(VecDestroy(&rows));
  PetscCall(VecDestroy(&columns));
  PetscCall(MatDestroy(&transposed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Balance(MpmOperator *op)
{
  PetscReal before, after;
  Vec       inverse;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(op->A, NULL, &op->unit));
  PetscCall(FindScale(op->A, op->unit));
  PetscCall(VecDuplicate(op->unit, &inverse));
  PetscCall(VecCopy(op->unit, inverse));
  PetscCall(VecReciprocal(inverse));
  PetscCall(MatDuplicate(op->A, MAT_COPY_VALUES, &op->balanced));
  PetscCall(MatDiagonalScale(op->balanced, op->unit, inverse));
  PetscCall(VecDestroy(&inverse));
  PetscCall(MatNorm(op->A, NORM_INFINITY, &before));
  PetscCall(MatNorm(op->balanced, NORM_INFINITY, &after));
  if (GAIN * after < before) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecDestroy(&op->unit));
  PetscCall(MatDestroy(&op->balanced));
  PetscCall(PetscObjectReference((PetscObject)op->A));
  op->balanced = op->A;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOperatorFromMatrix(Mat A, PetscInt period, MpmOperator **op)
{
  const PetscReal begin = MPI_Wtime();
  MpmOperator    *o;
  PetscBool       shell;

  PetscFunctionBegin;
  PetscCall(PetscNew(op));
  o = *op;
  PetscCall(PetscObjectTypeCompare((PetscObject)A, MATSHELL, &shell));
  PetscCall(PetscObjectReference((PetscObject)A));
  o->A         = A;
  o->fields    = 1;
  o->parts     = 1;
  o->period    = period;
  o->assembled = shell ? PETSC_FALSE : PETSC_TRUE;
  o->nonzeros = o->bytes = NAN;
  PetscCall(MatGetSize(A, &o->order, NULL));
  PetscCall(PetscObjectSetName((PetscObject)A, "A"));
  if (shell) {
    PetscCall(PetscObjectReference((PetscObject)A));
    o->balanced = A;
  } else {
    PetscCall(Balance(o));
    PetscCall(MpmOperatorCount(o));
  }
  o->assemble_s = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}
