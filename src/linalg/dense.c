/* Dense matrices that every rank holds whole. */
#include "linalg/dense.h"
#include <petscblaslapack.h>
#include <math.h>

PetscErrorCode MpmDenseCopy(Mat matrix, PetscReal values[])
{
  PetscInt rows, columns;
  Mat     *whole;
  IS       all_rows, all_columns;

  PetscFunctionBegin;
  PetscCall(MatGetSize(matrix, &rows, &columns));
  PetscCall(ISCreateStride(PETSC_COMM_SELF, rows, 0, 1, &all_rows));
  PetscCall(ISCreateStride(PETSC_COMM_SELF, columns, 0, 1, &all_columns));
  PetscCall(MatCreateSubMatrices(matrix, 1, &all_rows, &all_columns, MAT_INITIAL_MATRIX, &whole));
  PetscCall(PetscArrayzero(values, (size_t)rows * columns));
  for (PetscInt i = 0; i < rows; i++) {
    const PetscInt    *where;
    const PetscScalar *row;
    PetscInt           count;

    PetscCall(MatGetRow(whole[0], i, &count, &where, &row));
    for (PetscInt c = 0; c < count; c++) values[(size_t)where[c] * rows + i] = row[c];
    PetscCall(MatRestoreRow(whole[0], i, &count, &where, &row));
  }
  PetscCall(MatDestroySubMatrices(1, &whole));
  PetscCall(ISDestroy(&all_rows));
  PetscCall(ISDestroy(&all_columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsFinite(size_t n, const PetscReal a[])
{
  for (size_t i = 0; i < n; i++)
    if (!isfinite(a[i])) return PETSC_FALSE;
  return PETSC_TRUE;
}

PetscErrorCode MpmDenseEigen(PetscInt n, PetscReal a[], PetscReal re[], PetscReal im[], PetscReal vectors[],
                             int *failed)
{
  const char  *job = vectors ? "V" : "N";
  PetscBLASInt order, one = 1, room = -1, info;
  PetscReal   *work, query;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCallBLAS("LAPACKgeev",
                LAPACKgeev_("N", job, &order, a, &order, re, im, NULL, &one, vectors, &order, &query, &room, &info));
  room = (PetscBLASInt)query;
  PetscCall(PetscMalloc1(room, &work));
  PetscCallBLAS("LAPACKgeev",
                LAPACKgeev_("N", job, &order, a, &order, re, im, NULL, &one, vectors, &order, work, &room, &info));
  PetscCall(PetscFree(work));
  PetscCheck(info >= 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK dgeev failed: %d", (int)info);
  *failed = (int)info;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDenseLargest(Mat matrix, PetscReal value[2])
{
  PetscInt   n;
  int        failed;
  PetscReal *a, *re, *im;

  PetscFunctionBegin;
  PetscCall(MatGetSize(matrix, &n, NULL));
  PetscCall(PetscMalloc3((size_t)n * n, &a, n, &re, n, &im));
  PetscCall(MpmDenseCopy(matrix, a));
  value[0] = INFINITY;
  value[1] = 0;
  if (IsFinite((size_t)n * n, a)) {
    PetscCall(MpmDenseEigen(n, a, re, im, NULL, &failed));
    value[0] = failed ? NAN : 0;
    for (PetscInt i = 0; i < n && !failed; i++) {
      if (hypot(re[i], im[i]) <= hypot(value[0], value[1])) continue;
      value[0] = re[i];
      value[1] = im[i];
    }
  }
  PetscCall(PetscFree3(a, re, im));
  /* ranks whose LAPACK differs in the last digit must not decide differently */
  PetscCallMPI(MPI_Bcast(value, 2, MPIU_REAL, 0, PetscObjectComm((PetscObject)matrix)));
  PetscFunctionReturn(PETSC_SUCCESS);
}
