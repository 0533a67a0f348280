/* Random layouts: which share of them grows, and the least and the quantiles of their limits. */
#pragma once
#include <mpmstab/critical.h>

#define MPM_QUANTILES 3 /* 5, 50 and 95 % */

/*S
   MpmRandomLayouts - what is asked of n layouts, and what was found.

   n, seed - the number of layouts; layout i is hashed from seed + i
   cells   - of the box, in each direction; 0: 24 in one dimension, 6 in two, 3 in three. box: the number that was taken
   voids   - the share of sites without a particle
   scatter - every second layout has its particles anywhere in the box, as layout random has them
   moves   - so many times a particle of each layout is moved, or taken away, where this makes its limit smaller
   write   - file for the places of the worst layout after this, a line for each particle; NULL or empty: none
   limits  - whether limits are sought
   growth  - the largest at the case's own Courant number; NaN: it is not known of some layout
   courant - the least limit: 0 where that layout grows at every Courant number; infinite where there is none; NaN: it
             is not known, or was not asked for
   unstable, undecided - the numbers of layouts that grow, and of those whose growth is not known
   worst   - the seed of the layout with the least limit, or else of that with the largest growth
   evaluations - the number of times that growth was computed, on all ranks
   windows - as of MpmCritical: where some layout grows below courant
   quantile - in order of their limits, that of layout number MpmRankOfQuantile; NaN: not known or not asked for
   fades   - there is no threshold: growth fades with the Courant number, and courant is 0
S*/
typedef struct {
  PetscInt    n, cells, box;
  PetscInt64  seed;
  PetscReal   voids;
  PetscInt    moves;
  const char *write;
  PetscBool   scatter, limits;
  PetscReal   growth, courant, quantile[MPM_QUANTILES];
  PetscInt    unstable, undecided;
  PetscInt64  worst, evaluations;
  PetscBool   fades;

  MpmCriticalWindows windows;
} MpmRandomLayouts;

/* Not collective. Of n layouts the one that a quantile is of: a share of 5, 50 or 95 % is up to it, counted from 1. */
PetscInt MpmRankOfQuantile(PetscInt quantile, PetscInt n);

/*
   MpmRandomLayoutsFind - growth and limits of layouts in a small periodic box.

   Collective on PETSC_COMM_WORLD. Each layout is solved by one rank alone (see farm.h), so that nothing depends on the
   number of ranks.

   A layout has the sites of the case's particles in each cell, jittered by the case's jitter, or where that is 0 by a
   whole distance of particles, which puts each anywhere in its share of the cell. A site has no particle where
   MpmLayoutIsVoid says so. Particles are at rest and alike, and there are no walls.

   The eigenvalues are those of the nodal operator (operator/nodal.h). Where a layout that has become unstable stays so
   (MpmLeftmostDecides, MpmGrowthStays) the limit of each between 1e-6 and 64 is found, by one factorisation where the
   operator is linear in a power of the Courant number. Else all layouts are looked at together (MpmSearchScan).

   Errors: PETSC_ERR_SUP for a table whose nodal operator needs more than maps between particles and nodes and LAP.
*/
PetscErrorCode MpmRandomLayoutsFind(const MpmCriticalCase *of, MpmRandomLayouts *layouts);
