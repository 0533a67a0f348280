/* Arrays by name in memory. */
#include "io/arrays.h"
#include <math.h>
#include <string.h>

#define EXACT 9007199254740992.0 /* 2^53: doubles beyond it are not all whole numbers */

PetscErrorCode MpmArraysAdd(MpmArrays *arrays, const char name[], int dims, const PetscInt64 shape[], MpmArray **array)
{
  MpmArray *a = &arrays->array[arrays->n];

  PetscFunctionBegin;
  PetscCheck(arrays->n < MPM_MOST_ARRAYS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MOST_ARRAYS");
  *a = (MpmArray){.dims = dims, .n = dims < 0 ? 0 : 1};
  (void)snprintf(a->name, sizeof a->name, "%s", name);
  for (int i = 0; i < dims; i++) {
    a->shape[i] = shape[i];
    a->n *= shape[i];
  }
  PetscCall(PetscMalloc1((size_t)a->n, &a->real));
  arrays->n++;
  *array = a;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmArraysFree(MpmArrays *arrays)
{
  PetscFunctionBegin;
  for (int i = 0; i < arrays->n; i++) PetscCall(PetscFree(arrays->array[i].real));
  arrays->n = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

const MpmArray *MpmArraysFind(const MpmArrays *arrays, const char name[])
{
  for (int i = 0; i < arrays->n; i++)
    if (!strcmp(arrays->array[i].name, name)) return &arrays->array[i];
  return NULL;
}

PetscBool MpmArrayIsWhole(const MpmArray *array, PetscReal lo)
{
  for (PetscInt64 i = 0; i < array->n; i++)
    if (!(array->real[i] >= lo && array->real[i] <= EXACT && array->real[i] == rint(array->real[i])))
      return PETSC_FALSE;
  return PETSC_TRUE;
}
