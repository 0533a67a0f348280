/* What a step moves between memory and processor. */
#pragma once
#include "march/passes.h"

/*
   MpmScheduleBytes - bytes per particle and step that a march moves when its arrays fit no cache.

   Not collective. NaN for a table with SOLVE, whose iterations are not known. Ghosts, and what a sampled step adds, are
   left out. alike: all cells are, so that no particle's place is read (MpmParticles, per_cell).
*/
PetscReal MpmScheduleBytes(const MpmTable *table, const MpmSchedule *schedule, PetscReal particles_per_node,
                           PetscBool alike);
