/* A sparse matrix on its way between the first rank, which has the file, and all ranks. */
#include "base/memory.h"
#include "io/matrix_csr.h"
#include "linalg/dense.h"
#include <mpmstab/errors.h>
#include <math.h>

PetscErrorCode MpmEntriesRoom(PetscReal rows, PetscReal columns, PetscReal n, MpmEntries *e, char why[MPM_WHY_TEXT])
{
  PetscFunctionBegin;
  if (!(rows >= 1 && columns >= 1))
    (void)snprintf(why, MPM_WHY_TEXT, "it is empty, %.0f x %.0f; allowed: a square matrix", rows, columns);
  else if (rows != columns)
    (void)snprintf(why, MPM_WHY_TEXT, "it is not square, %.0f x %.0f; allowed: a matrix from a state to a state", rows,
                   columns);
  else if (rows != rint(rows) || rows > PETSC_MAX_INT / 2 || !(n >= 0 && n <= MPM_MATRIX_ENTRIES))
    (void)snprintf(why, MPM_WHY_TEXT, "order %.10g with %.10g entries; allowed: up to %d, with up to %.2g", rows, n,
                   PETSC_MAX_INT / 2, MPM_MATRIX_ENTRIES);
  if (!why[0]) MpmMemoryRoom((n + rows) * (2 * sizeof(PetscInt) + sizeof(PetscReal)), MPM_WHY_TEXT, why);
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  e->rows    = (PetscInt64)rows;
  e->columns = (PetscInt64)columns;
  e->n       = (PetscInt64)n;
  PetscCall(PetscMalloc3(e->n + e->rows, &e->row, e->n + e->rows, &e->column, e->n + e->rows, &e->value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmEntriesCheck(const MpmEntries *e, char why[MPM_WHY_TEXT])
{
  for (PetscInt64 i = 0; i < e->n && !why[0]; i++) {
    if (e->row[i] < 0 || e->row[i] >= e->rows || e->column[i] < 0 || e->column[i] >= e->columns)
      (void)snprintf(why, MPM_WHY_TEXT,
                     "entry %" PetscInt64_FMT " is in row %" PetscInt_FMT " and column %" PetscInt_FMT
                     "; allowed: from 0 to %" PetscInt64_FMT ", counted from 0",
                     i + 1, e->row[i], e->column[i], e->rows - 1);
    else if (!isfinite(e->value[i]))
      (void)snprintf(why, MPM_WHY_TEXT,
                     "row %" PetscInt_FMT ", column %" PetscInt_FMT ", counted from 0, is %s; allowed: finite "
                     "numbers",
                     e->row[i], e->column[i], isnan(e->value[i]) ? "nan" : "infinite");
  }
}

void MpmEntriesToScales(MpmEntries *e)
{
  const MpmHooked *h     = &e->hooked;
  const PetscInt   width = (PetscInt)h->scales;

  if (width < 1 || width > MPM_HOOKED_NUMBERS || h->numbers != (PetscReal)width || e->rows % width) return;
  for (PetscInt64 k = 0; k < e->n; k++) e->value[k] *= h->scale[e->column[k] % width] / h->scale[e->row[k] % width];
}

PetscErrorCode MpmEntriesFree(MpmEntries *e)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(e->row, e->column, e->value));
  PetscCall(MpmHookedFree(&e->hooked));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMatrixOfEntries(MPI_Comm comm, MpmEntries *e, Mat *A)
{
  PetscInt order = (PetscInt)e->rows;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(&order, 1, MPIU_INT, 0, comm));
  for (PetscInt i = 0; i < order && MpmRankOf(comm) == 0; i++) {
    e->row[e->n] = e->column[e->n] = i;
    e->value[e->n++]               = 0;
  }
  PetscCall(MatCreate(comm, A));
  PetscCall(MatSetSizes(*A, PETSC_DECIDE, PETSC_DECIDE, order, order));
  PetscCall(MatSetType(*A, MATMPIAIJ));
  PetscCall(MatSetPreallocationCOO(*A, e->n, e->row, e->column));
  PetscCall(MatSetValuesCOO(*A, e->value, INSERT_VALUES));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCsrGather(Mat A, PetscInt exponent, MpmCsr *c)
{
  const PetscMPIInt rank = MpmRankOf(PetscObjectComm((PetscObject)A));
  PetscInt          rows;
  PetscBool         done;

  PetscFunctionBegin;
  PetscCall(MatGetSize(A, &c->order, NULL));
  PetscCall(MpmDenseWhole(A, rank ? PETSC_FALSE : PETSC_TRUE, &c->whole));
  PetscCall(MatGetRowIJ(*c->whole, 0, PETSC_FALSE, PETSC_FALSE, &rows, &c->begin, &c->column, &done));
  PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_SUP, "a matrix without rows");
  PetscCall(MatSeqAIJGetArray(*c->whole, &c->value));
  for (PetscInt k = 0; k < c->begin[rows]; k++) c->value[k] = scalbn(c->value[k], (int)exponent);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCsrFree(MpmCsr *c)
{
  PetscFunctionBegin;
  PetscCall(MatSeqAIJRestoreArray(*c->whole, &c->value));
  PetscCall(MatDestroySubMatrices(1, &c->whole));
  PetscFunctionReturn(PETSC_SUCCESS);
}
