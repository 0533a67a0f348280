/* The largest stable Courant number of a scene, and what limits it. */
#pragma once
#include <mpmstab/predict.h>
#include <mpmstab/verdict.h>

/*S
   MpmCritical - the result of the task critical.

   courant: the largest Courant number up to which growth stays within 1 + tolerance, or the closed form's where that is less
   (growth within tolerance); 0 when there is none, infinite when none was found that is unstable. Growth is within tolerance at stable_at and beyond it at unstable_at. beta: phase of
   the mode that grows there first (NaN: none, or its trace has no phase); null_share: the part of it that no node sees
   (NaN: not known). threshold: whether below stable_at there is no growth at all; if not, it fades as the Courant number
   to the power of fading, and only tolerance gives a limit. At rest such a scheme has courant 0.

   closed, closed_beta: the same by the closed form, NaN without one; cell: what enters it at that phase. asked is at the
   scene's own Courant number. assembled: from the operator, of order unknowns; else from the symbol.
S*/
typedef struct {
  PetscReal      courant, stable_at, unstable_at, beta, null_share, fading, closed, closed_beta, seconds;
  PetscBool      threshold, assembled;
  PetscInt       order;
  PetscInt64     evaluations;
  MpmCellSymbols cell;
  MpmFinding     asked;
} MpmCritical;

/* Courant numbers that are looked at. */
#define MPM_CRITICAL_FROM 1e-4
#define MPM_CRITICAL_TO 64.0

/*
   MpmCriticalFind - searches upwards; scheme alone: without growth at the scene's own Courant number.

   Collective on PETSC_COMM_WORLD. Through the symbol on uniform layouts: at rest the limit of each phase, the least of
   them refined over all phases (golden section), so that it does not depend on those looked at first; under drift growth
   over all phases at each Courant number. Else through all eigenvalues of the assembled operator, which needs SLEPc
   initialized; refuses orders too large for that.
*/
PetscErrorCode MpmCriticalFind(const MpmScene *scene, PetscBool alone, MpmCritical *critical);

/* Growth per step at a Courant number. */
typedef PetscErrorCode (*MpmCriticalGrowth)(void *context, PetscReal courant, PetscReal *growth);

/*
   MpmCriticalCross - where growth first leaves 1 + tolerance: [stable_at, unstable_at], 0 when it is beyond at from, infinite
   when nowhere up to `to`. Steps of ratio, then bisection.

   Collective when growth is. A window of instability narrower than a step may be missed.
*/
PetscErrorCode MpmCriticalCross(MpmCriticalGrowth growth, void *context, PetscReal tolerance, PetscReal from,
                                PetscReal to, PetscReal ratio, PetscReal precision, PetscReal bracket[2]);

/* Not collective. Golden section: the place in [lo, hi] of the least value of a function with one minimum there. */
typedef PetscErrorCode (*MpmFunction)(void *context, PetscReal x, PetscReal *value);
PetscErrorCode MpmGoldenSection(MpmFunction f, void *context, PetscReal lo, PetscReal hi, PetscReal *x,
                                PetscReal *value);

/* Collective. The search through the assembled operator, a part of MpmCriticalFind. */
PetscErrorCode MpmCriticalAssembled(const MpmScene *scene, MpmCritical *critical);
