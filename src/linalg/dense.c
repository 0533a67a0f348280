/* Dense matrices that every rank holds whole. */
#include "linalg/lapack_names.h"
#include "linalg/dense.h"
#include <math.h>

#define DSYEVD MPM_LAPACK(dsyevd, DSYEVD)

extern void DSYEVD(const char *jobz, const char *uplo, const PetscBLASInt *n, double *a, const PetscBLASInt *lda,
                   double *w, double *work, const PetscBLASInt *lwork, PetscBLASInt *iwork, const PetscBLASInt *liwork,
                   PetscBLASInt *info);

PetscErrorCode MpmDenseWhole(Mat matrix, PetscBool here, Mat **whole)
{
  PetscInt rows, columns;
  IS       all_rows, all_columns;

  PetscFunctionBegin;
  PetscCall(MatGetSize(matrix, &rows, &columns));
  PetscCall(ISCreateStride(PETSC_COMM_SELF, here ? rows : 0, 0, 1, &all_rows));
  PetscCall(ISCreateStride(PETSC_COMM_SELF, here ? columns : 0, 0, 1, &all_columns));
  PetscCall(MatCreateSubMatrices(matrix, 1, &all_rows, &all_columns, MAT_INITIAL_MATRIX, whole));
  PetscCall(ISDestroy(&all_rows));
  PetscCall(ISDestroy(&all_columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDenseCopy(Mat matrix, PetscReal values[])
{
  PetscInt rows, columns;
  Mat     *whole;

  PetscFunctionBegin;
  PetscCall(MatGetSize(matrix, &rows, &columns));
  PetscCall(MpmDenseWhole(matrix, PETSC_TRUE, &whole));
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

PetscErrorCode MpmDenseSymmetric(PetscInt n, PetscReal a[], PetscReal value[])
{
  PetscBLASInt order, places, info, room = -1, places_room = -1, *place;
  PetscReal   *work, query;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &order));
  DSYEVD("V", "U", &order, a, &order, value, &query, &room, &places, &places_room, &info);
  PetscCheck(!info, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK dsyevd failed: %d", (int)info);
  room        = (PetscBLASInt)query;
  places_room = places;
  PetscCall(PetscMalloc2(room, &work, places_room, &place));
  DSYEVD("V", "U", &order, a, &order, value, work, &room, place, &places_room, &info);
  PetscCall(PetscFree2(work, place));
  PetscCheck(!info, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK dsyevd failed: %d", (int)info);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDenseNullity(Mat matrix, PetscReal tolerance, PetscInt *nullity)
{
  PetscInt     rows, columns;
  PetscBLASInt m, n, one = 1, room = -1, info;
  PetscReal   *a, *value, *work, query;

  PetscFunctionBegin;
  PetscCall(MatGetSize(matrix, &rows, &columns));
  PetscCall(PetscBLASIntCast(rows, &m));
  PetscCall(PetscBLASIntCast(columns, &n));
  PetscCall(PetscMalloc2((size_t)rows * columns, &a, PetscMin(rows, columns), &value));
  PetscCall(MpmDenseCopy(matrix, a));
  PetscCallBLAS("LAPACKgesvd",
                LAPACKgesvd_("N", "N", &m, &n, a, &m, value, NULL, &one, NULL, &one, &query, &room, &info));
  room = (PetscBLASInt)query;
  PetscCall(PetscMalloc1(room, &work));
  PetscCallBLAS("LAPACKgesvd",
                LAPACKgesvd_("N", "N", &m, &n, a, &m, value, NULL, &one, NULL, &one, work, &room, &info));
  PetscCheck(!info, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK dgesvd failed: %d", (int)info);
  *nullity = columns;
  for (PetscInt i = 0; i < PetscMin(rows, columns); i++) *nullity -= value[i] > tolerance * value[0];
  PetscCallMPI(MPI_Bcast(nullity, 1, MPIU_INT, 0, PetscObjectComm((PetscObject)matrix)));
  PetscCall(PetscFree(work));
  PetscCall(PetscFree2(a, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}
