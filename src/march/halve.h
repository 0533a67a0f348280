/*
   Halving: a step that cannot be taken, because its system does not converge or a particle is inverted or goes a cell or further,
   is taken in 2, 4 and more equal parts.
*/
#pragma once
#include "march/march_private.h"

/*S
   MpmHalve_ - the state before a part of a step.

   state, cell - the registers of the state and the places of each particle of this rank; room: the particles that they have
                 room for
   most        - a step has at most 2^most parts
   steps       - the number of steps that were taken in parts; finest: the largest number of parts of a step
S*/
struct MpmHalve_ {
  PetscReal *state;
  PetscInt  *cell, room, most;
  PetscInt64 steps, finest;
};

/* Collective. Takes a step, in parts if need be. take: takes one part. Where that fails, march->failure says so. */
PetscErrorCode MpmHalveStep(MpmMarch *march, PetscErrorCode (*take)(MpmMarch *march, PetscBool sample),
                            PetscBool sample);
PetscErrorCode MpmHalveDestroy(MpmHalve **halve);
