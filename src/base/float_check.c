/* Clears the floating-point flags before a step (C11, fenv.h) and reads them after it, on all ranks together. */
#include "base/float_check.h"

#ifndef NDEBUG
#include <fenv.h>

#define FAULTS (FE_INVALID | FE_DIVBYZERO)

void MpmFloatBegin(void)
{
  (void)feclearexcept(FAULTS | FE_OVERFLOW);
}

PetscErrorCode MpmFloatEnd(MPI_Comm comm, MpmFloatCheck *check, const char work[], PetscInt64 step)
{
  int raised = fetestexcept(FAULTS | FE_OVERFLOW);

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &raised, 1, MPI_INT, MPI_BOR, comm));
  if (raised & FE_OVERFLOW) check->left = PETSC_TRUE;
  PetscCheck(check->left || !(raised & FAULTS), comm, PETSC_ERR_FP, "%s, step %" PetscInt64_FMT ": %s", work, step,
             raised & FE_INVALID ? "an invalid floating-point operation" : "a division by zero");
  PetscFunctionReturn(PETSC_SUCCESS);
}
#endif
