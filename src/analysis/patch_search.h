/*
   A lattice of particles at one place in the grid and one set of phases, and a search over places and phases, where a
   limit is least, or growth largest.
*/
#pragma once
#include "analysis/cluster.h"

/*E
   MpmPatchEnd - how a lattice is in a direction: it has no end, begins at a free surface, or is a single particle.
E*/
typedef enum { MPM_PATCH_ENDLESS, MPM_PATCH_SURFACE, MPM_PATCH_SINGLE } MpmPatchEnd;

/*S
   MpmPatchSpot - a place of the lattice and its phases. The first particle is at (j + t) / ppc in its cell, 0 <= j <
   ppc and 0 <= t < 1, in each direction: with j apart, t near 0 or 1 is exact. beta counts where there is no end.
S*/
typedef struct {
  PetscInt  j[MPM_MAX_DIM];
  PetscReal t[MPM_MAX_DIM], beta[MPM_MAX_DIM];
} MpmPatchSpot;

/*S
   MpmPatchLattice - what all spots of a lattice share.

   end   - in each direction
   depth - the number of cells behind a surface
   held  - the nodes of the first half of them are held too: what is left has no surface
   count - the number of limits and growths computed
S*/
typedef struct {
  const MpmCriticalCase *of;
  const MpmNodalPlan    *plan;
  MpmPatchEnd            end[MPM_MAX_DIM];
  PetscInt               depth;
  PetscBool              held;
  PetscInt64             count;
} MpmPatchLattice;

/*
   MpmPatchCluster - the particles of a spot; destroyed with MpmClusterDestroy.

   Not collective.

   Behind a surface the nodes beyond depth are held: their values are 0. On them nothing happens that could grow, and
   for apic with equal maps there and back the limit comes from above as depth grows, since the quotient that has it is
   largest over fewer nodal fields. With pic it may come from below. Waves of a gas may gain at each reflection, so that
   a shallow lattice grows and a deep one does not. A held end may even have a mode of its own: held shows it. A second
   surface there would have its own limit.
*/
PetscErrorCode MpmPatchCluster(const MpmPatchLattice *lattice, const MpmPatchSpot *spot, MpmCluster *cluster);

/* Not collective. MpmClusterCrossing and MpmClusterGrowth of a spot. */
PetscErrorCode MpmPatchCrossing(MpmPatchLattice *lattice, const MpmPatchSpot *spot, PetscReal *courant);
PetscErrorCode MpmPatchGrowth(MpmPatchLattice *lattice, const MpmPatchSpot *spot, PetscReal courant, PetscReal *growth,
                              PetscReal *rounding);

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
