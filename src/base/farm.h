/* Task farm: work in parts that do not depend on one another. One rank does a part alone. */
#pragma once
#include "base/progress.h"

/* Not collective. Does part i of the work; context is what the caller of MpmFarm gives. */
typedef PetscErrorCode (*MpmPart)(void *context, PetscInt i);

/*
   MpmFarm - does parts 0 .. n - 1. Rank r of R does parts r, r + R, r + 2 R and so on, so the results do not depend on
   the number of ranks. A progress line counts the parts; unit is the word for one of them, such as "layout".

   Collective on PETSC_COMM_WORLD, but part is not: it must not communicate.
*/
PetscErrorCode MpmFarm(const char unit[], PetscInt n, MpmPart part, void *context);

/*
   MpmFarmSumReals, MpmFarmSumInts - give all ranks the n results of the parts.

   Collective on PETSC_COMM_WORLD. values holds on each rank what its own parts have set, and 0 elsewhere; afterwards it
   holds the sum over the ranks.
*/
PetscErrorCode MpmFarmSumReals(PetscInt n, PetscReal values[]);
PetscErrorCode MpmFarmSumInts(PetscInt n, PetscInt values[]);
