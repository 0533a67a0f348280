/* Debug builds look at the processor's floating-point flags after each step of the march and of the assembly. */
#pragma once
#include <mpmstab/compat.h>

/*S
   MpmFloatCheck - left: whether numbers have left the range of doubles. That is what an unstable scheme does, and
   infinities make invalid operations of sound ones, so nothing is said from then on.
S*/
typedef struct {
  PetscBool left;
} MpmFloatCheck;

/*
   MpmFloatBegin, MpmFloatEnd - stand around a step. An invalid operation (0/0, inf - inf, a conversion out of range)
   or a
   division by 0 between them is an error that names the work and the step.

   MpmFloatEnd is collective: all ranks end when one of them has failed. Release builds have neither: optimisation may
   raise flags for numbers that nobody uses.
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
void           MpmFloatBegin(void);
PetscErrorCode MpmFloatEnd(MPI_Comm comm, MpmFloatCheck *check, const char work[], PetscInt64 step);
#endif
