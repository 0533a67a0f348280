/* Task farm: work that falls into parts, each of which one rank does alone. */
#pragma once
#include "base/progress.h"

/* Not collective. Part i of the work. */
typedef PetscErrorCode (*MpmPart)(void *context, PetscInt i);

/*
   MpmFarm - does parts 0 .. n - 1, dealt to the ranks in turn, so that the result does not depend on how many there
   are, with a progress line in the unit given.

   Collective on PETSC_COMM_WORLD; the parts are not.
*/
PetscErrorCode MpmFarm(MpmProgressWish wish, const char unit[], PetscInt n, MpmPart part, void *context);

/* Collective. Gives every rank the numbers that parts have set in arrays that were 0 before. */
PetscErrorCode MpmFarmSumReals(PetscInt n, PetscReal values[]);
PetscErrorCode MpmFarmSumInts(PetscInt n, PetscInt values[]);
