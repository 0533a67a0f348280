/* Registers -> one matrix, rows numbered like the state. */
#include "operator/assemble.h"

/* Numbers of each row of A in this rank's and in other ranks' columns. */
static PetscErrorCode CountRows(const MpmRegisters *r, PetscInt begin, PetscInt end, PetscInt own[], PetscInt far[])
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < r->fields; f++) {
    PetscInt first;

    PetscCall(MatGetOwnershipRange(r->particle[f], &first, NULL));
    for (PetscInt p = 0; p < r->particles; p++) {
      const PetscInt  row = r->fields * p + f;
      const PetscInt *columns;
      PetscInt        n;

      PetscCall(MatGetRow(r->particle[f], first + p, &n, &columns, NULL));
      own[row] = far[row] = 0;
      for (PetscInt c = 0; c < n; c++)
        if (columns[c] >= begin && columns[c] < end)
          own[row]++;
        else
          far[row]++;
      PetscCall(MatRestoreRow(r->particle[f], first + p, &n, &columns, NULL));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CopyRows(const MpmRegisters *r, Mat A)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < r->fields; f++) {
    PetscInt begin, end;

    PetscCall(MatGetOwnershipRange(r->particle[f], &begin, &end));
    for (PetscInt p = begin; p < end; p++) {
      const PetscInt     row = r->fields * p + f;
      const PetscInt    *columns;
      const PetscScalar *values;
      PetscInt           n;

      PetscCall(MatGetRow(r->particle[f], p, &n, &columns, &values));
      PetscCall(MatSetValues(A, 1, &row, n, columns, values, INSERT_VALUES));
      PetscCall(MatRestoreRow(r->particle[f], p, &n, &columns, &values));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersGather(const MpmRegisters *r, Mat *A)
{
  PetscInt *own, *far, begin, end;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRangeColumn(r->particle[0], &begin, &end));
  PetscCall(PetscMalloc2(r->state, &own, r->state, &far));
  PetscCall(CountRows(r, begin, end, own, far));
  PetscCall(MatCreateAIJ(r->comm, r->state, r->state, PETSC_DETERMINE, PETSC_DETERMINE, 0, own, 0, far, A));
  PetscCall(PetscFree2(own, far));
  PetscCall(CopyRows(r, *A));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}
