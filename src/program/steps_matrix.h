/* The operator of some steps: as matrices, or without its matrix as their program. */
#pragma once
#include "program/program.h"

/*
   MpmStepsMatrix - a MATSHELL whose product with a state is what the steps first .. first + steps - 1 make of it: a
   program's matrix (MpmStepProgramMatrix). It holds the maps of every step, and MatGetInfo counts their numbers.

   Collective. The rows are those of MpmMatricesStep. layout and scheme must outlive it.
*/
PetscErrorCode MpmStepsMatrix(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                              PetscInt first, PetscInt steps, Mat *matrix);

/* Not collective. An upper bound of the numbers in the maps of one step, over all ranks. */
PetscReal MpmStepsNonzeros(const MpmLayout *layout, const MpmScheme *scheme);

/*
   MpmMatricesOfSlab - registers as matrices, for the steps of a slab's scheme; degree is that of MpmMatricesCreate.
   MpmMatricesStep - takes them through a step.

   Collective.
*/
PetscErrorCode MpmMatricesOfSlab(const MpmSlab *slab, PetscInt degree, MpmMatrices *m);
PetscErrorCode MpmMatricesStep(MpmMatrices *m, const MpmSlab *slab, PetscInt64 step);
