/* Whole matrices on every rank. */
#include <mpmstab/dense.h>
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

PetscErrorCode MpmDenseLargest(Mat matrix, PetscReal value[2])
{
  PetscInt     n;
  PetscBLASInt order, one = 1, room = -1, info;
  PetscReal   *a, *re, *im, *work, query;

  PetscFunctionBegin;
  PetscCall(MatGetSize(matrix, &n, NULL));
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCall(PetscMalloc3((size_t)n * n, &a, n, &re, n, &im));
  PetscCall(MpmDenseCopy(matrix, a));
  value[0] = INFINITY;
  value[1] = 0;
  if (IsFinite((size_t)n * n, a)) {
    PetscCallBLAS("LAPACKgeev",
                  LAPACKgeev_("N", "N", &order, a, &order, re, im, NULL, &one, NULL, &one, &query, &room, &info));
    room = (PetscBLASInt)query;
    PetscCall(PetscMalloc1(room, &work));
    PetscCallBLAS("LAPACKgeev",
                  LAPACKgeev_("N", "N", &order, a, &order, re, im, NULL, &one, NULL, &one, work, &room, &info));
    PetscCheck(info >= 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK dgeev failed: %d", (int)info);
    PetscCall(PetscFree(work));
    value[0] = info ? NAN : 0;
    for (PetscInt i = 0; i < n && !info; i++) {
      if (hypot(re[i], im[i]) <= hypot(value[0], value[1])) continue;
      value[0] = re[i];
      value[1] = im[i];
    }
  }
  PetscCall(PetscFree3(a, re, im));
  /* ranks whose LAPACK differs in the last digit must not part ways */
  PetscCallMPI(MPI_Bcast(value, 2, MPIU_REAL, 0, PetscObjectComm((PetscObject)matrix)));
  PetscFunctionReturn(PETSC_SUCCESS);
}
