/*
   All eigenvalues and vectors by LAPACK's dgeev, which balances. SLEPc's solver lapack takes twice the time: it also
   sorts the Schur form by swapping rows one after the other, although Sort() sorts again, and it computes vectors one
   by one.
*/
#include "linalg/dense.h"
#include "linalg/eigen_parts.h"

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

PetscErrorCode MpmEigenDenseSolve(Mat A, PetscReal re[], PetscReal im[], PetscReal *rows[], PetscBool *failed)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)A);
  PetscMPIInt    rank, count;
  PetscInt       n, begin, end;
  PetscReal     *whole, *vectors = NULL, *column;
  int            bad = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(MatGetSize(A, &n, NULL));
  PetscCall(MatGetOwnershipRange(A, &begin, &end));
  PetscCall(PetscMPIIntCast(n, &count));
  PetscCall(PetscMalloc1((size_t)n * n, &whole));
  PetscCall(PetscMalloc1(n, &column));
  PetscCall(MpmDenseCopy(A, whole));
  if (rank == 0) {
    PetscCall(PetscMalloc1((size_t)n * n, &vectors));
    PetscCall(MpmDenseEigen(n, whole, re, im, vectors, &bad));
  }
  PetscCall(PetscFree(whole));
  PetscCallMPI(MPI_Bcast(&bad, 1, MPI_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(re, count, MPIU_REAL, 0, comm));
  PetscCallMPI(MPI_Bcast(im, count, MPIU_REAL, 0, comm));
  PetscCall(PetscMalloc1((size_t)n * (end - begin), rows));
  for (PetscInt j = 0; j < n; j++) {
    if (rank == 0) PetscCall(PetscArraycpy(column, vectors + (size_t)n * j, n));
    PetscCallMPI(MPI_Bcast(column, count, MPIU_REAL, 0, comm));
    PetscCall(PetscArraycpy(*rows + (size_t)(end - begin) * j, column + begin, end - begin));
  }
  PetscCall(PetscFree(column));
  PetscCall(PetscFree(vectors));
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

/*
   ---- matrices whose eigenvalues are all 0 because of where their entries are ----

   Unknowns that feel nobody else are taken away, then those that felt only these, and so on (Kahn 1962). The matrix is
   strictly triangular in this order if none is left.
*/

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
