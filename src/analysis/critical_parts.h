/* The parts of MpmCriticalFind. */
#pragma once
#include "analysis/search.h"
#include "analysis/zoom.h"
#include "symbol/predict.h"
#include <mpmstab/critical.h>

/*S
   MpmCriticalStart - where a search for the limit starts.

   alone    - only the limit is asked for
   unstable - infinite for a search over all phases. Else it is a Courant number at which phase beta is known to grow,
              and the search covers only what can be reached from there.
   beta     - where growth at the case's own Courant number was computed before, the phase that grows most there; else
              NaN
   axes     - in two and three dimensions, the limit of waves along the axes
S*/
typedef struct {
  PetscBool          alone;
  PetscReal          unstable;
  const PetscReal   *beta;
  const MpmCritical *axes;
} MpmCriticalStart;

/*
   A search for the limit of a case. The closed form's is in the result already. Collective on PETSC_COMM_WORLD.

   MpmCriticalAssembled      - through all eigenvalues of the assembled operator, and growth at the case's Courant
                               number
   MpmCriticalLineUnderDrift - in one dimension for particles that move
   MpmCriticalConfirmed      - at rest by the closed form, confirmed by the symbol
   MpmCriticalSampled        - by samples of the symbol, with the windows of growth below the limit at rest
*/
typedef PetscErrorCode (*MpmCriticalSearch)(const MpmCriticalCase *of, const MpmCriticalStart *start, MpmCritical *c);
PetscErrorCode MpmCriticalAssembled(const MpmCriticalCase *of, const MpmCriticalStart *start, MpmCritical *c);
PetscErrorCode MpmCriticalLineUnderDrift(const MpmCriticalCase *of, const MpmCriticalStart *start, MpmCritical *c);
PetscErrorCode MpmCriticalConfirmed(const MpmCriticalCase *of, const MpmCriticalStart *start, MpmCritical *c);
PetscErrorCode MpmCriticalSampled(const MpmCriticalCase *of, const MpmCriticalStart *start, MpmCritical *c);

/*
   MpmCriticalAxes - the least limit of the waves along the axes, each of which find finds in one dimension. Infinite:
   there is none. Collective on PETSC_COMM_WORLD.
*/
typedef PetscErrorCode (*MpmCriticalFinder)(const MpmCriticalCase *of, PetscBool alone, MpmCritical *c);
PetscErrorCode MpmCriticalAxes(const MpmCriticalCase *of, MpmCriticalFinder find, MpmCritical *least);

/*
   MpmCriticalLineGrowth - growth and verdict at the case's Courant number, over all phases of one dimension. beta: the
   phase that grows most. It takes the symbol at twice MPM_CRITICAL_PHASES phases. Where nothing grows there, it follows
   the symbol's amplification factors from phase to phase. The verdict is undecided where some of them could not be told
   apart.

   MpmCriticalSampleGrowth - the same in two and three dimensions, by samples. With uphill the search goes on from the
   largest ones on the grid.

   Collective on PETSC_COMM_WORLD.
*/
PetscErrorCode MpmCriticalLineGrowth(const MpmCriticalCase *of, MpmFinding *finding, PetscReal *beta);
PetscErrorCode MpmCriticalSampleGrowth(const MpmCriticalCase *of, PetscBool uphill, MpmFinding *finding,
                                       PetscReal beta[], PetscInt64 *evaluations);

/*
   MpmCriticalWhyNotQuiet - the condition of the theorem that does not hold; NULL: all hold. Not collective.
   MpmCriticalQuiet       - quiet of MpmCritical: the least over the layouts that a period of the drift meets.
   MpmCriticalQuieten     - sets quiet; without such a number no_theorem, and under drift cure and cured.

   The last two are collective. Errors: those of MpmStepPeriod.
*/
const char    *MpmCriticalWhyNotQuiet(const MpmCriticalCase *of);
PetscErrorCode MpmCriticalQuiet(const MpmCriticalCase *of, PetscReal *quiet);
PetscErrorCode MpmCriticalQuieten(const MpmCriticalCase *of, MpmCritical *c);

/*
   Not collective. The number of phases in (0, pi] of each direction at which the symbol is taken: fewer where its
   matrices are large.
*/
PetscInt MpmCriticalSamples(const MpmLayout *layout, const MpmScheme *scheme);

/* Not collective. The type of modes whose shares along beta are from least to most. */
static inline MpmWaveType MpmCriticalWaveOf(PetscReal least, PetscReal most)
{
  return least >= MPM_WAVE_SHARE ? MPM_WAVE_P : most <= 1 - MPM_WAVE_SHARE ? MPM_WAVE_S : MPM_WAVE_MIXED;
}
