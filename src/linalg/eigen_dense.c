/*
   All eigenvalues and vectors by LAPACK's dgeev, which balances. SLEPc's solver lapack takes twice the time: it also
   sorts the Schur form by swapping rows one after the other, although Sort() sorts again, and it computes vectors one
   by one. Vectors take dgeev nearly as long as eigenvalues, so those of a band are found by inverse iteration.
*/
#include "linalg/band_vectors.h"
#include "linalg/dense.h"
#include "linalg/eigen_dense.h"

/* Options that only SLEPc's solver can follow. */
static const char *const slepcs[] = {
    "-eps_type",           "-eps_view",           "-eps_view_values",    "-eps_view_vectors",
    "-eps_error_absolute", "-eps_error_relative", "-eps_error_backward", "-eps_converged_reason"};

PetscErrorCode MpmEigenDenseIsPlain(EPS eps, PetscBool *plain)
{
  ST          st;
  STType      transform;
  PetscScalar shift;
  PetscBool   lapack, asked = PETSC_FALSE;
  const char *prefix;

  PetscFunctionBegin;
  PetscCall(EPSGetST(eps, &st));
  PetscCall(STGetShift(st, &shift));
  PetscCall(STGetType(st, &transform));
  PetscCall(PetscObjectTypeCompare((PetscObject)eps, EPSLAPACK, &lapack));
  PetscCall(EPSGetOptionsPrefix(eps, &prefix));
  for (size_t o = 0; o < PETSC_STATIC_ARRAY_LENGTH(slepcs) && !asked; o++)
    PetscCall(PetscOptionsHasName(NULL, prefix, slepcs[o], &asked));
  *plain = lapack && !asked && shift == 0 && (!transform || !strcmp(transform, STSHIFT)) ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Solves on one rank. The vectors take the place of the matrix. */
static PetscErrorCode SolveAlone(PetscInt n, PetscReal re[], PetscReal im[], PetscReal **matrix, int *bad)
{
  PetscReal      *vectors;
  MpmBandVectors *band;

  PetscFunctionBegin;
  PetscCall(MpmBandVectorsCreate(n, *matrix, &band));
  if (band) {
    PetscCall(MpmDenseEigen(n, *matrix, re, im, NULL, bad));
    if (!*bad) PetscCall(MpmBandVectorsFind(band, re, im, *matrix));
    PetscCall(MpmBandVectorsDestroy(&band));
  } else {
    PetscCall(PetscMalloc1((size_t)n * n, &vectors));
    PetscCall(MpmDenseEigen(n, *matrix, re, im, vectors, bad));
    PetscCall(PetscFree(*matrix));
    *matrix = vectors;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenDenseSolve(Mat A, PetscReal re[], PetscReal im[], PetscReal *rows[], PetscBool *failed)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)A);
  PetscMPIInt    rank, count;
  PetscInt       n, begin, end;
  PetscReal     *whole, *column;
  int            bad = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(MatGetSize(A, &n, NULL));
  PetscCall(MatGetOwnershipRange(A, &begin, &end));
  PetscCall(PetscMPIIntCast(n, &count));
  PetscCall(PetscMalloc1((size_t)n * n, &whole));
  PetscCall(PetscMalloc1(n, &column));
  PetscCall(MpmDenseCopy(A, whole));
  if (rank == 0)
    PetscCall(SolveAlone(n, re, im, &whole, &bad));
  else
    PetscCall(PetscFree(whole));
  PetscCallMPI(MPI_Bcast(&bad, 1, MPI_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(re, count, MPIU_REAL, 0, comm));
  PetscCallMPI(MPI_Bcast(im, count, MPIU_REAL, 0, comm));
  PetscCall(PetscMalloc1((size_t)n * (end - begin), rows));
  for (PetscInt j = 0; j < n; j++) {
    if (rank == 0) PetscCall(PetscArraycpy(column, whole + (size_t)n * j, n));
    PetscCallMPI(MPI_Bcast(column, count, MPIU_REAL, 0, comm));
    PetscCall(PetscArraycpy(*rows + (size_t)(end - begin) * j, column + begin, end - begin));
  }
  PetscCall(PetscFree(column));
  PetscCall(PetscFree(whole));
  *failed = bad ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenDenseVector(const PetscReal rows[], const PetscReal value_im[], PetscInt j, Vec re, Vec im)
{
  const PetscInt first = value_im[j] < 0 ? j - 1 : j;
  PetscInt       n;
  PetscReal     *x[2];

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(re, &n));
  PetscCall(VecGetArrayWrite(re, &x[0]));
  PetscCall(VecGetArrayWrite(im, &x[1]));
  for (PetscInt i = 0; i < n; i++) {
    const PetscReal *row = rows + (size_t)n * first + i;

    x[0][i] = row[0];
    x[1][i] = value_im[j] == 0 ? 0 : value_im[j] < 0 ? -row[n] : row[n];
  }
  PetscCall(VecRestoreArrayWrite(re, &x[0]));
  PetscCall(VecRestoreArrayWrite(im, &x[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
