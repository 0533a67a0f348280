/* Debug builds check the processor's floating-point flags after each step of the march and of the assembly. */
#pragma once
#include <mpmstab/compat.h>
#include <fenv.h>

/*S
   MpmFloatCheck - what the checks of a run remember.

   left says whether a number has left the range of doubles. An unstable scheme does that in the end, and it is no
   error. From then on sound operations meet infinities and become invalid, so the checks report nothing more.
S*/
typedef struct {
  PetscBool left;
} MpmFloatCheck;

/*
   MpmFloatBegin, MpmFloatEnd - are called before and after a step. An invalid operation between them (0/0, inf - inf, a
   conversion out of range) or a division by 0 is an error, PETSC_ERR_FP; its message names the work and the step.

   MpmFloatBegin is not collective. MpmFloatEnd is collective on comm: all ranks return the error when one of them has
   met it. In release builds both do nothing, since optimised code may raise flags for numbers that it does not use.
*/
#ifdef NDEBUG
static inline void MpmFloatBegin(void)
{
}

static inline PetscErrorCode MpmFloatEnd(MPI_Comm comm, MpmFloatCheck *check, const char work[], PetscInt64 step)
{
  (void)comm;
  (void)check;
  (void)work;
  (void)step;
  return PETSC_SUCCESS;
}
#else
#define MPM_FLOAT_FAULTS (FE_INVALID | FE_DIVBYZERO)

static inline void MpmFloatBegin(void)
{
  (void)feclearexcept(MPM_FLOAT_FAULTS | FE_OVERFLOW);
}

static inline PetscErrorCode MpmFloatEnd(MPI_Comm comm, MpmFloatCheck *check, const char work[], PetscInt64 step)
{
  int raised = fetestexcept(MPM_FLOAT_FAULTS | FE_OVERFLOW);

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &raised, 1, MPI_INT, MPI_BOR, comm));
  if (raised & FE_OVERFLOW) check->left = PETSC_TRUE;
  PetscCheck(check->left || !(raised & MPM_FLOAT_FAULTS), comm, PETSC_ERR_FP, "%s, step %" PetscInt64_FMT ": %s", work,
             step, raised & FE_INVALID ? "an invalid floating-point operation" : "a division by zero");
  PetscFunctionReturn(PETSC_SUCCESS);
}
#endif
