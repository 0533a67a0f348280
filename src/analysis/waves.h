/*
   Waves: growth(k, beta) of a scheme on a uniform layout, which every search over phases and Courant numbers asks for,
   and the largest of all phases.
*/
#pragma once
#include "symbol/bloch.h"
#include "symbol/source.h"
#include <mpmstab/verdict.h>

/*S
   MpmWaves - bloch and eigen: of its matrices. evaluations: the number of times that growth was computed.
S*/
typedef struct {
  MpmBloch      bloch;
  MpmSmallEigen eigen;
  PetscInt64    evaluations;
} MpmWaves;

/* Not collective. layout and scheme must outlive it. drift: as of MpmBlochCreate. */
PetscErrorCode MpmWavesCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmFraction drift[],
                              MpmWaves *waves);
PetscErrorCode MpmWavesDestroy(MpmWaves *waves);

/* Not collective. Growth per step of a phase at a Courant number. */
PetscErrorCode MpmWavesGrowth(MpmWaves *waves, PetscReal courant, const PetscReal beta[], PetscReal *growth);

/*
   MpmWavesRounding - what rounding makes of growth at a phase: the difference of two matrices whose steps are rounded
   differently. Sets defective_error, and where uncertainty is not NULL that of a growth: its eigenvalue moves by its
   condition number times this difference.

   Not collective.
*/
PetscErrorCode MpmWavesRounding(MpmWaves *waves, PetscReal courant, const PetscReal beta[], PetscReal growth,
                                PetscReal *defective_error, PetscReal *uncertainty);

/*S
   MpmRefined - what MpmRefinedGrowth has found.

   growth  - the largest growth per step
   beta    - its phases, in (-pi, pi]; NaN where no phase grows
   points  - the phases in (0, pi] of each direction, on the finest grid
   settled - growth - 1 has moved by less than MPM_REFINED of itself, or by less than 1e-9, between the last grids
   uncertainty, defective_error - as of MpmFinding, at these phases; 0 where no phase grows
   evaluations - the number of times that growth was computed
S*/
#define MPM_REFINED 1e-3
typedef struct {
  PetscReal  growth, uncertainty, defective_error, beta[MPM_MAX_DIM];
  PetscInt   points;
  PetscBool  settled;
  PetscInt64 evaluations;
} MpmRefined;

/*
   MpmRefinedGrowth - the largest growth per step of a scheme on a uniform layout, at a step's Courant number and drift.

   Collective on comm, whose ranks share the work. The result does not depend on their number.

   Each grid has twice the phases of the one before it. From its largest growths the search goes on uphill with ever
   smaller steps. It ends when the growth found has not moved over two grids, or at the finest grid. With to_finest it
   also goes on where nothing grows on two grids: a narrow peak may show on a finer one. A peak that is narrower than
   the distances of the last grid may still be missed.
*/
PetscErrorCode MpmRefinedGrowth(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                PetscBool to_finest, MpmRefined *refined);

/* Not collective. The verdict on refined growth: stable only where it is settled. */
PetscErrorCode MpmRefinedFinding(const MpmRefined *refined, PetscReal tolerance, MpmFinding *finding);

/*
   MpmWorstPhase - the phase of largest growth of a source, sought over all phases and not only at equally spaced ones
   by MpmZoomLeast, which begins with about as many phases as a symbol has.

   Collective. phases: of the symbol in each direction. Output: the phase in (-pi, pi], and what is there.
*/
PetscErrorCode MpmWorstPhase(MPI_Comm comm, const MpmSource *source, const PetscInt phases[], PetscReal beta[],
                             MpmSourceGrowth *at);
