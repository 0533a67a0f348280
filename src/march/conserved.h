/* Conserved: what a run must not lose. */
#pragma once
#include "march/march_private.h"

#define MPM_MASS_ROUNDING 1e-10 /* of the nodes' mass, relative */

/*S
   MpmConserved - sums over the grid and over all particles.

   particles, mass: how many there are, and the mass the nodes have of them, in particles of the first material.
   momentum: sum m v of the field that the formulation conserves, and size, sum m abs(v), both times 2^exponent; has_
   momentum: whether scheme and ends conserve one.
S*/
typedef struct {
  PetscInt64 particles;
  PetscReal  mass, momentum, size;
  PetscInt   exponent;
  PetscBool  has_momentum;
} MpmConserved;

/* Collective. */
PetscErrorCode MpmConservedSum(const MpmMarch *march, MpmConserved *sums);

/*
   MpmConservedCheck - whether nothing has been lost between two steps of a march.

   Collective. That particles or mass have changed is an error of the program; momentum may be lost at nodes without
   mass. changes[]: relative changes of mass, of what the particles have, and of momentum, of its size; NaN where
   there is none to conserve.
*/
PetscErrorCode MpmConservedCheck(const MpmMarch *march, const MpmConserved *before, PetscReal changes[2]);
