/* What a march does on nodes alone: sums over ranks, images beyond walls, and the operations between node fields. */
#pragma once
#include "march/march_private.h"

/*
   MpmNodesSum - completes what this rank's particles gave to n node fields: adds what images beyond walls got, sums over
   ranks, divides by the masses, and sets ghosts and images. parity[f]: that of sums[f]. Fields become 0 where there is no
   mass. With with_mass the masses were summed too, and become their inverses.

   Collective.
*/
PetscErrorCode MpmNodesSum(const MpmMarch *march, PetscInt n, PetscReal *const sums[], const MpmParity *const parity[],
                           PetscBool with_mass, PetscReal mass[]);

/* Collective. Sets ghosts to the values that their owners have, and images beyond walls. */
PetscErrorCode MpmNodesRefresh(const MpmMarch *march, const MpmParity parity[], PetscReal field[]);

/*
   Collective. An operation between node fields, at this rank's nodes and as many ghosts as op->depth leaves. step is that of
   the particles' places.
*/
PetscErrorCode MpmNodesRun(const MpmMarchArrays *arrays, const MpmNodeOp *op, PetscInt64 step,
                           PetscReal *const field[]);
