/* A sparse matrix on its way between the first rank, which has the file, and all ranks. */
#include "base/memory.h"
#include "io/matrix_csr.h"
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
  if (!why[0]) MpmMemoryRoom(n * (2 * sizeof(PetscInt) + sizeof(PetscReal)), MPM_WHY_TEXT, why);
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  e->rows    = (PetscInt64)rows;
  e->columns = (PetscInt64)columns;
  e->n       = (PetscInt64)n;
  PetscCall(PetscMalloc3(e->n, &e->row, e->n, &e->column, e->n, &e->value));
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

/* Sorts each row by columns and adds what has the same place. */
static PetscErrorCode Merge(MpmCsr *c)
{
  PetscInt to = 0, begin = 0;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < c->order; i++) {
    const PetscInt end = c->begin[i + 1], first = to;

    PetscCall(PetscSortIntWithScalarArray(end - begin, c->column + begin, c->value + begin));
    for (PetscInt k = begin; k < end; k++) {
      if (to > first && c->column[to - 1] == c->column[k]) {
        c->value[to - 1] += c->value[k];
        continue;
      }
      c->column[to]  = c->column[k];
      c->value[to++] = c->value[k];
    }
    c->begin[i + 1] = to;
    begin           = end;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCsrFromEntries(const MpmEntries *e, MpmCsr *c)
{
  PetscInt *next;

  PetscFunctionBegin;
  c->order = (PetscInt)e->rows;
  PetscCall(PetscMalloc3(c->order + 1, &c->begin, e->n + c->order, &c->column, e->n + c->order, &c->value));
  PetscCall(PetscArrayzero(c->begin, c->order + 1));
  for (PetscInt64 i = 0; i < e->n; i++) c->begin[e->row[i] + 1]++;
  for (PetscInt i = 0; i < c->order; i++) c->begin[i + 1] += c->begin[i] + 1;
  PetscCall(PetscMalloc1(c->order, &next));
  PetscCall(PetscArraycpy(next, c->begin, c->order));
  for (PetscInt64 i = 0; i < e->n; i++) {
    const PetscInt place = next[e->row[i]]++;

    c->column[place] = e->column[i];
    c->value[place]  = e->value[i];
  }
  for (PetscInt i = 0; i < c->order; i++) {
    c->column[next[i]] = i;
    c->value[next[i]]  = 0;
  }
  PetscCall(PetscFree(next));
  PetscCall(Merge(c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCsrFree(MpmCsr *c)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(c->begin, c->column, c->value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many of the first rank's rows, and of their entries, go to each rank or come from it, and where they begin. */
typedef struct {
  PetscMPIInt *rows, *first, *entries, *begin;
} Deal;

static PetscErrorCode DealCreate(MPI_Comm comm, PetscInt rows, PetscInt entries, Deal *d)
{
  const PetscMPIInt size    = MpmRanksOf(comm);
  PetscMPIInt       mine[2] = {(PetscMPIInt)rows, (PetscMPIInt)entries};

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(size, &d->rows, size, &d->first, size, &d->entries, size, &d->begin));
  PetscCallMPI(MPI_Allgather(&mine[0], 1, MPI_INT, d->rows, 1, MPI_INT, comm));
  PetscCallMPI(MPI_Allgather(&mine[1], 1, MPI_INT, d->entries, 1, MPI_INT, comm));
  d->first[0] = d->begin[0] = 0;
  for (PetscMPIInt r = 1; r < size; r++) {
    d->first[r] = d->first[r - 1] + d->rows[r - 1];
    d->begin[r] = d->begin[r - 1] + d->entries[r - 1];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DealDestroy(Deal *d)
{
  PetscFunctionBegin;
  PetscCall(PetscFree4(d->rows, d->first, d->entries, d->begin));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCsrScatter(MPI_Comm comm, const MpmCsr *c, Mat *A)
{
  PetscInt          order = c->order, rows = PETSC_DECIDE, *begin, *column, *count, entries = 0;
  PetscReal        *value;
  const PetscMPIInt rank = MpmRankOf(comm);
  Deal              deal;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(&order, 1, MPIU_INT, 0, comm));
  PetscCall(PetscSplitOwnership(comm, &rows, &order));
  PetscCall(DealCreate(comm, rows, 0, &deal));
  PetscCall(PetscMalloc2(rows + 1, &begin, rank ? 0 : order, &count));
  for (PetscInt i = 0; i < order && rank == 0; i++) count[i] = c->begin[i + 1] - c->begin[i];
  PetscCallMPI(MPI_Scatterv(count, deal.rows, deal.first, MPIU_INT, begin + 1, (PetscMPIInt)rows, MPIU_INT, 0, comm));
  begin[0] = 0;
  for (PetscInt i = 0; i < rows; i++) begin[i + 1] += begin[i];
  entries = begin[rows];
  PetscCall(DealDestroy(&deal));
  PetscCall(DealCreate(comm, rows, entries, &deal));
  PetscCall(PetscMalloc2(entries, &column, entries, &value));
  PetscCallMPI(
      MPI_Scatterv(c->column, deal.entries, deal.begin, MPIU_INT, column, (PetscMPIInt)entries, MPIU_INT, 0, comm));
  PetscCallMPI(
      MPI_Scatterv(c->value, deal.entries, deal.begin, MPIU_REAL, value, (PetscMPIInt)entries, MPIU_REAL, 0, comm));
  PetscCall(MatCreateMPIAIJWithArrays(comm, rows, rows, order, order, begin, column, value, A));
  PetscCall(PetscFree2(column, value));
  PetscCall(PetscFree2(begin, count));
  PetscCall(DealDestroy(&deal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of this rank: how many entries each has, and the entries times 2^exponent. */
static PetscErrorCode TakeRows(Mat A, PetscInt exponent, PetscInt count[], PetscInt column[], PetscReal value[])
{
  PetscInt first, end, at = 0;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(A, &first, &end));
  for (PetscInt row = first; row < end; row++) {
    const PetscInt    *columns;
    const PetscScalar *values;

    PetscCall(MatGetRow(A, row, &count[row - first], &columns, &values));
    for (PetscInt i = 0; i < count[row - first]; i++) {
      column[at]  = columns[i];
      value[at++] = scalbn(values[i], (int)exponent);
    }
    PetscCall(MatRestoreRow(A, row, NULL, &columns, &values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCsrGather(Mat A, PetscInt exponent, MpmCsr *c)
{
  const MPI_Comm    comm = PetscObjectComm((PetscObject)A);
  PetscInt          rows, all, *count, *column;
  PetscReal        *value;
  MatInfo           local, global;
  const PetscMPIInt rank = MpmRankOf(comm);
  Deal              deal;

  PetscFunctionBegin;
  PetscCall(MatGetSize(A, &c->order, NULL));
  PetscCall(MatGetLocalSize(A, &rows, NULL));
  PetscCall(MatGetInfo(A, MAT_LOCAL, &local));
  PetscCall(MatGetInfo(A, MAT_GLOBAL_SUM, &global));
  all = rank ? 0 : (PetscInt)global.nz_used;
  PetscCall(PetscMalloc3(rows, &count, (PetscInt)local.nz_used, &column, (PetscInt)local.nz_used, &value));
  PetscCall(PetscMalloc3(rank ? 0 : c->order + 1, &c->begin, all, &c->column, all, &c->value));
  PetscCall(TakeRows(A, exponent, count, column, value));
  PetscCall(DealCreate(comm, rows, (PetscInt)local.nz_used, &deal));
  PetscCallMPI(MPI_Gatherv(count, (PetscMPIInt)rows, MPIU_INT, rank ? NULL : c->begin + 1, deal.rows, deal.first,
                           MPIU_INT, 0, comm));
  PetscCallMPI(MPI_Gatherv(column, (PetscMPIInt)local.nz_used, MPIU_INT, c->column, deal.entries, deal.begin, MPIU_INT,
                           0, comm));
  PetscCallMPI(MPI_Gatherv(value, (PetscMPIInt)local.nz_used, MPIU_REAL, c->value, deal.entries, deal.begin, MPIU_REAL,
                           0, comm));
  if (rank == 0) c->begin[0] = 0;
  for (PetscInt i = 0; i < c->order && rank == 0; i++) c->begin[i + 1] += c->begin[i];
  PetscCall(DealDestroy(&deal));
  PetscCall(PetscFree3(count, column, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}
