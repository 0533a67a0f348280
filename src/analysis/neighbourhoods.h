/* Neighbourhoods: limits and growth where a particle may be, in the bulk, at a free surface, alone, among voids. */
#pragma once
#include "analysis/neighbourhood.h"

/*S
   MpmNeighbourhoods - the n neighbourhoods that a request asks for, and the worst of them.

   least, fastest - which of them has the least limit, and which the largest growth; MPM_NONE where none is known
   courant  - the largest Courant number that is stable in all of them; NaN where one that could be worse is undecided
   bound    - no layout of such particles at rest grows up to this Courant number; 0: no such bound is known
   finding  - growth and verdict at the scene's own Courant number, of all of them
S*/
typedef struct {
  PetscInt         n, least, fastest;
  MpmNeighbourhood of[MPM_NEIGHBOURHOODS];
  PetscReal        courant, bound;
  MpmFinding       finding;
} MpmNeighbourhoods;

#define MPM_TABLE_ROWS 5

/*S
   MpmStepTable - the largest stable steps of a scheme at rest by layout: lattice, disordered layouts, an edge of the
   lattice, a lone particle, the worst layout that a short search finds.

   row     - what was found of each
   limit   - its Courant number; of disordered layouts that up to which 5 % of them have their own, or the least where
             that is not known. NaN: it is undecided, or was not sought
   of      - the row that the limit of the last is of
   left_out - it was not sought, since that takes long
   bound   - no layout of such particles at rest grows up to it; 0: none is known
   advised - the Courant number that is recommended: bound, or else the least limit of the rows. Where limits fall to 0
             as a particle comes to a node the least above 0, but for the worst. Infinite: nothing limits it. NaN: none,
             since row never grows at every Courant number
   moving  - growth per step at advised, if the lattice drifts by 1/MPM_CRITICAL_DRIFT of a cell per step, the larger of
             MpmCriticalMoving; NaN: not known
   least, never - the row that advised is of, and that row; MPM_NONE: none
   falls   - the limit of some row falls to 0 so
S*/
typedef struct {
  MpmNeighbourhood row[MPM_TABLE_ROWS];
  PetscReal        limit[MPM_TABLE_ROWS], bound, advised, moving, seconds;
  PetscBool        left_out[MPM_TABLE_ROWS], falls;
  PetscInt         of, least, never;
} MpmStepTable;

/* Not collective. Whether some of them grow in windows below their limits. */
PetscBool MpmNeighbourhoodsHaveWindows(const MpmNeighbourhoods *all);

/* Not collective. Whether a request asks for more than the bulk. */
PetscBool MpmNeighbourhoodsWanted(const MpmRequest *request);

/*
   MpmNeighbourhoodsFind - finds what a request asks for of the neighbourhoods of a scene's lattice.

   Collective on PETSC_COMM_WORLD, with SLEPc initialized. bulk: what was found of the bulk already; read where the
   request asks for it. limits: whether the limits of random layouts are sought, besides their growth. Neighbourhoods
   other than the bulk are of particles at rest, whatever the scene's drift is.

   A lone particle has a closed form for many schemes (MpmLoneFind). What has none, and edges and corners, are those of
   MpmPatchFind.
*/
PetscErrorCode MpmNeighbourhoodsFind(const MpmScene *scene, const MpmRequest *request, const MpmNeighbourhood *bulk,
                                     PetscBool limits, MpmNeighbourhoods *all);

/*
   MpmStepTableFind - finds such a table for the lattice of a scene.

   Collective on PETSC_COMM_WORLD, with SLEPc initialized. bulk: what was found of the lattice; all: what was found of
   neighbourhoods besides, which is not sought again, or NULL.
*/
PetscErrorCode MpmStepTableFind(const MpmScene *scene, const MpmRequest *request, const MpmNeighbourhood *bulk,
                                const MpmNeighbourhoods *all, MpmStepTable *table);

/* Not collective. The bulk, from the results of the tasks critical and spectrum. */
MpmNeighbourhood MpmNeighbourhoodOfCritical(const MpmCritical *critical);
MpmNeighbourhood MpmNeighbourhoodOfFinding(const MpmFinding *finding);
