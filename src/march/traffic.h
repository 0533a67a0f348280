/* The memory traffic of a step. */
#pragma once
#include "march/passes.h"

/*
   MpmScheduleBytes - bytes per particle and step that a march moves between memory and processor, when its arrays fit
   in no cache.

   Not collective. NaN for a table with SOLVE, whose number of iterations is not known. Ghosts and the sums of a sampled
   step are left out. alike says that all cells are alike, so that no particle's place is read.
*/
PetscReal MpmScheduleBytes(const MpmTable *table, const MpmSchedule *schedule, PetscReal particles_per_node,
                           PetscBool alike);
