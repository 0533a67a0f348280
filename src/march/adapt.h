/*
   Steps at finite deformation that are not taken as they are.

   Halving: a step that cannot be taken, because its system does not converge or a particle is inverted or goes a cell
   or further, is taken in 2, 4 and more equal parts.

   Relaxation: a step changes velocity and stretch of all particles by one factor times its increments, at most 1, so
   that the energy of the particles does not rise. Places change as they do without it, since the energy does not depend
   on them.

   Source of the second: Ketcheson 2019, in the form that leaves the time of a step as it is; docs/theory.md, section
   12.
*/
#pragma once
#include "march/march_private.h"

/*S
   MpmHalve_ - the state before a part of a step.

   state, cell - the registers of the state and the places of each particle of this rank; room: the particles that they
                 have room for
   most        - a step has at most 2^most parts
   steps       - the number of steps that were taken in parts; finest: the largest number of parts of a step
S*/
struct MpmHalve_ {
  PetscReal *state;
  PetscInt  *cell, room, most;
  PetscInt64 steps, finest;
};

/* Collective. Takes a step, in parts if need be. take: takes one part. Where that fails, march->failure says so. */
PetscErrorCode MpmHalveStep(MpmMarch *march, PetscErrorCode (*take)(MpmMarch *march));
PetscErrorCode MpmHalveDestroy(MpmHalve **halve);

/*S
   MpmRelax_ - the state before a step, and then its increments.

   change - nstate numbers for each particle of this rank, and one more; room: the particles that it has room for
   energy - of the particles before the step
   steps  - the number of steps with a factor below 1; least: the least factor
S*/
struct MpmRelax_ {
  PetscReal *change, energy, least;
  PetscInt   room;
  PetscInt64 steps;
};

/*
   MpmRelaxBegin - keeps the state before a step.

   Collective. MpmRelaxEnd is called when all of the state is that after the step, and before particles migrate. scaled:
   whether the state is now another one.
*/
PetscErrorCode MpmRelaxBegin(MpmMarch *march);
PetscErrorCode MpmRelaxEnd(MpmMarch *march, PetscBool *scaled);
PetscErrorCode MpmRelaxDestroy(MpmRelax **relax);
