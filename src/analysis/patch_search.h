/* A search over the places and phases of a lattice: where a limit is least, or growth largest. */
#pragma once
#include "analysis/patch_lattice.h"

#define MPM_PATCH_MARGIN 0x1p-20 /* a place is this far from the ends of its panel, in panels */
#define MPM_PATCH_MORE 64        /* the most spots that the caller may name */

/* Computes what is made least; not collective. */
typedef PetscErrorCode (*MpmPatchFunction)(void *context, const MpmPatchSpot *spot, PetscReal *value);

/*S
   MpmPatchSearch - how the least value is sought. In a direction with an end the place of the first particle runs over
   its whole cell, in panels of half a particle spacing: at faces of cells, in their middles and where particles of a
   width begin to reach a node, values may jump or have a kink. Without an end it runs over one spacing, and the phase
   over (-pi, pi], in the first such direction over [0, pi].

   lattice      - whose spots are searched
   coarse, deep, fine - the depths at which the search begins, at which the places that it has come to are compared, and
                  at which it ends at the best of them. A mode near the limit of the bulk fades slowly, so which of
                  several places is the worst shows on a deep lattice only.
   alike        - directions with an end may be exchanged
   nmore, more  - spots that are compared too
S*/
typedef struct {
  MpmPatchLattice *lattice;
  PetscInt         coarse, deep, fine, nmore;
  PetscBool        alike;
  MpmPatchSpot     more[MPM_PATCH_MORE];
  MpmPatchFunction f;
  void            *context;
} MpmPatchSearch;

/*
   MpmPatchLeast - the spot of least value: on a grid of spots first, from the best ones on by steps in all directions,
   on all diagonals of two, and half as long where none goes down. The value is that at the depth fine.

   Collective on PETSC_COMM_WORLD; f is not. The result does not depend on the number of ranks.
*/
PetscErrorCode MpmPatchLeast(MpmPatchSearch *search, MpmPatchSpot *spot, PetscReal *value);

/* Not collective. The number of spots of the grid, and spot i of them; none where an exchange has been looked at. */
PetscInt  MpmPatchGridSize(const MpmPatchSearch *search);
PetscBool MpmPatchGridSpot(const MpmPatchSearch *search, PetscInt i, MpmPatchSpot *spot);
