/* The parts of MpmCriticalFind. */
#pragma once
#include "analysis/search.h"
#include "analysis/zoom.h"
#include "symbol/predict.h"
#include <mpmstab/critical.h>

/*
   MpmCriticalAtRest, MpmCriticalUnderDrift - find the limit through the symbol, at rest and under drift.

   Collective. unstable: infinite for a search over all phases. Otherwise it is a Courant number at which phase beta is
   known to grow, and the search covers only what can be reached from there.
*/
PetscErrorCode MpmCriticalAtRest(const MpmCriticalCase *of, PetscReal unstable, PetscReal beta, MpmCritical *critical);
PetscErrorCode MpmCriticalUnderDrift(const MpmCriticalCase *of, PetscReal unstable, PetscReal beta,
                                     MpmCritical *critical);

/*
   MpmCriticalScanned - the limit at rest through the symbol, and windows of growth below it, without taking for granted that
   a phase that has become unstable stays so.

   Collective. asked: the phase that grows most at the case's own Courant number, which are both looked at too; NaN where
   that is not asked for.
*/
PetscErrorCode MpmCriticalScanned(const MpmCriticalCase *of, PetscReal asked, MpmCritical *critical);

/*
   Collective. Finds the limit through all eigenvalues of the assembled operator, and growth at the case's Courant
   number.
*/
PetscErrorCode MpmCriticalAssembled(const MpmCriticalCase *of, MpmCritical *critical);

/* A search for the first window of growth by following eigenvalues, up to a Courant number; what came of it. */
typedef struct {
  PetscReal  to, bracket[2], doubtful;
  PetscInt64 evaluations;
  PetscBool  done;
} MpmCriticalWay;

/*
   MpmCriticalFollow - follows the eigenvalues of the assembled operator upwards in the Courant number to way->to.

   Collective on PETSC_COMM_WORLD; the first rank does the work. done: whether it got there or found growth, else the
   operator is too large for that, or there was too much to look at. bracket: as of MpmFollowLine, where done.
*/
PetscErrorCode MpmCriticalFollow(const MpmCriticalCase *of, MpmCriticalWay *way);

/*
   MpmCriticalInSpace - the limit in two and three dimensions, on a uniform layout; the closed form's is in the result
   already. With alone, growth at the case's own Courant number is left out.

   MpmCriticalClosedInSpace - sets closed and closed_beta. The predictor must cover the case.

   MpmCriticalBySamples - the limit by samples of the symbol. unstable, beta: as of MpmCriticalUnderDrift.

   MpmCriticalSampleGrowth - the largest growth at the case's Courant number that samples find, the verdict on it, and its
   phases. With uphill the search goes on from the largest ones on the grid.

   Collective on PETSC_COMM_WORLD, but for MpmCriticalClosedInSpace.
*/
PetscErrorCode MpmCriticalInSpace(const MpmCriticalCase *of, PetscBool alone, MpmCritical *critical);
PetscErrorCode MpmCriticalClosedInSpace(const MpmPredictor *predictor, MpmCritical *critical);
PetscErrorCode MpmCriticalBySamples(const MpmCriticalCase *of, PetscReal unstable, const PetscReal beta[],
                                    MpmCritical *critical);
PetscErrorCode MpmCriticalSampleGrowth(const MpmCriticalCase *of, PetscBool uphill, MpmFinding *finding,
                                       PetscReal beta[], PetscInt64 *evaluations);

/*
   MpmCriticalPolarise - what particles do in the modes of a phase that grow most at a Courant number.
   MpmCriticalSamples  - the number of phases in (0, pi] of each direction at which the symbol is taken: fewer where its
                         matrices are large
   MpmCriticalBound    - bound of MpmCritical, for particles at rest
   MpmCriticalZoom     - a search over phases with the symmetries of a layout, a prestress and a drift, and nothing else set

   Not collective.
*/
PetscErrorCode MpmCriticalPolarise(const MpmCriticalCase *of, PetscReal courant, const PetscReal beta[],
                                   MpmWaveType *wave);
PetscReal      MpmCriticalBound(const MpmLayout *layout, const MpmScheme *scheme);
PetscInt       MpmCriticalSamples(const MpmLayout *layout, const MpmScheme *scheme);
MpmZoom        MpmCriticalZoom(const MpmLayout *layout, const MpmSpace *space, const MpmFraction drift[]);

/* Not collective. Leaves out the windows that are not below the limit, which refining has moved down. */
static inline void MpmCriticalKeepBelow(MpmCritical *c)
{
  while (c->windows.n && c->windows.window[c->windows.n - 1].to > c->stable_at) c->windows.n--;
}

/* Not collective. Whether a Courant number is in a window of growth. */
static inline PetscBool MpmCriticalHasWindowAt(const MpmCritical *c, PetscReal courant)
{
  for (PetscInt i = 0; i < c->windows.n; i++)
    if (courant >= c->windows.window[i].from && courant <= c->windows.window[i].to) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Not collective. The type of modes whose shares along beta are from least to most. */
static inline MpmWaveType MpmCriticalWaveOf(PetscReal least, PetscReal most)
{
  return least >= MPM_WAVE_SHARE ? MPM_WAVE_P : most <= 1 - MPM_WAVE_SHARE ? MPM_WAVE_S : MPM_WAVE_MIXED;
}

/*
   MpmCriticalGrowthAt - finds growth and verdict at the case's Courant number, over all phases. beta: the phase that
   grows most.

   Collective. It takes the symbol at twice MPM_CRITICAL_PHASES phases. Where nothing grows there, it follows the
   symbol's amplification factors from phase to phase. The verdict is undecided where some of them could not be told
   apart.
*/
PetscErrorCode MpmCriticalGrowthAt(const MpmCriticalCase *of, MpmFinding *finding, PetscReal *beta);

/*
   MpmCriticalGrowthOfPhase, MpmCriticalRounding - growth per step of one phase at a Courant number, and the growth that
   rounding may make of a defective pair there.

   Not collective.
*/
PetscErrorCode MpmCriticalGrowthOfPhase(const MpmCriticalCase *of, PetscReal courant, const PetscReal beta[],
                                        PetscReal *growth);
PetscErrorCode MpmCriticalRounding(const MpmCriticalCase *of, PetscReal courant, const PetscReal beta[],
                                   PetscReal *growth);
