/* The largest stable Courant number of a scene, and what limits it. */
#pragma once
#include <mpmstab/scene.h>
#include <mpmstab/verdict.h>

/*S
   MpmCritical - the result of the task critical.

   courant: the largest Courant number up to which growth stays within 1 + tolerance, or the closed form's where that is
   less (growth within tolerance); 0 when there is none, infinite when none was found that is unstable. Growth is within
   tolerance at stable_at and beyond it at unstable_at. beta: phase of the mode that grows there first (NaN: none, or
   its trace has no phase); null_share: the part of it that no node sees (NaN: not known). threshold: whether below
   stable_at there is no growth at all; if not, it fades as the Courant number to the power of fading, and only
   tolerance gives a limit. At rest such a scheme has courant 0.

   moving: growth at the scene's own Courant number if particles at rest drifted by MPM_CRITICAL_DRIFT (NaN: not asked).

   courant is NaN where it is undecided: disputed says that search and closed form contradict each other; rounding,
   where it is not 0, is the growth per step that rounding alone may make at the limit found, which is more than
   tolerance. doubtful: under drift a Courant number below the limit at which factors could not be told apart, so that a
   window may be missed there; infinite for none.

   followed: under drift, whether amplification factors were followed over all Courant numbers below the limit, so that
   no window is narrower than what was looked at; else it was sought in steps.

   closed, closed_beta: the same by the closed form, NaN without one; cell: what enters it at that phase. asked is at
   the scene's own Courant number. assembled: from the operator, of order unknowns; else from the symbol.
S*/
typedef struct {
  PetscReal      courant, stable_at, unstable_at, doubtful, beta, null_share, fading, moving, closed, closed_beta;
  PetscReal      rounding, seconds;
  PetscBool      threshold, assembled, disputed, followed;
  PetscInt       order;
  PetscInt64     evaluations;
  MpmCellSymbols cell;
  MpmFinding     asked;
} MpmCritical;

/*S
   MpmCriticalCase - whose limit is sought: a scheme on a layout, with the drift of step. step.courant is only where
   growth is asked for besides. Growth per step up to 1 + tolerance counts as none.
S*/
typedef struct {
  const MpmLayout *layout;
  const MpmScheme *scheme;
  MpmStep          step;
  PetscReal        tolerance;
} MpmCriticalCase;

/* Not collective. The case of a scene. */
static inline MpmCriticalCase MpmCriticalCaseOf(const MpmScene *scene, PetscReal tolerance)
{
  return (MpmCriticalCase){
      .layout = &scene->layout, .scheme = &scene->scheme, .step = scene->step, .tolerance = tolerance};
}

/* Courant numbers that are looked at, and how many phases in (0, pi] at first. */
#define MPM_CRITICAL_PHASES 160
#define MPM_CRITICAL_FROM 1e-4
#define MPM_CRITICAL_TO 64.0
#define MPM_CRITICAL_PRECISION 1e-10 /* of a bracket through the symbol, relative */
#define MPM_CRITICAL_DRIFT 8         /* one cell in so many steps, where it is asked what motion does */
#define MPM_CRITICAL_STEP 0.003      /* under drift, at most */

/*
   MpmCriticalFind - searches upwards; scheme alone: without growth at the scene's own Courant number.

   Collective on PETSC_COMM_WORLD. Through the symbol on uniform layouts: the limit of each phase, the least of them
   refined over all phases (golden section), so that it does not depend on those looked at first. At rest a phase that
   is unstable stays so; under drift windows of instability open where two factors meet, and close again, so steps are
   small (MPM_CRITICAL_STEP) and each near approach is looked at more closely.
   Else through all eigenvalues of the assembled operator, which needs SLEPc initialized; refuses orders too large for
   that. Under drift the eigenvalues of small operators are followed as k grows, those of larger ones are taken in steps
   of 0.02 (see followed).
*/
PetscErrorCode MpmCriticalFind(const MpmCriticalCase *of, PetscBool alone, MpmCritical *critical);

/*
   MpmCriticalSurvey - the limit of every formulation, transfer and basis at a case's layout and drift, in its scheme's
   place; bases vary fastest. Calls row with each as it comes.

   Collective on PETSC_COMM_WORLD. Refuses layouts without a symbol.
*/
typedef PetscErrorCode (*MpmCriticalRow)(void *context, const MpmScheme *scheme, const MpmCritical *critical);
PetscErrorCode MpmCriticalSurvey(const MpmCriticalCase *of, MpmCriticalRow row, void *context);

/* Not collective. Sets closed, closed_beta and cell: the least of the closed form over all phases. */
PetscErrorCode MpmCriticalByClosedForm(const MpmLayout *layout, const MpmScheme *scheme, PetscBool drifts,
                                       MpmCritical *critical);

/* Growth per step at a Courant number. */
typedef PetscErrorCode (*MpmCriticalGrowth)(void *context, PetscReal courant, PetscReal *growth);

/* Where a search looks: from, then on by a ratio but by no more than width, to the end. */
typedef struct {
  PetscReal from, to, ratio, width;
} MpmCriticalSteps;

/*
   MpmCriticalCross - where growth first leaves 1 + tolerance: [stable_at, unstable_at], infinite when nowhere; 0 when
   there is no stable Courant number, found by halving where growth is beyond at the first. Then bisection.

   Collective when growth is. A window of instability narrower than a step may be missed.
*/
PetscErrorCode MpmCriticalCross(MpmCriticalGrowth growth, void *context, PetscReal tolerance,
                                const MpmCriticalSteps *steps, PetscReal precision, PetscReal bracket[2]);

/*
   MpmCriticalThreshold - whether growth at half the limit found is none but for rounding, and if not, with which power
   of the Courant number it fades.

   Collective when growth is.
*/
PetscErrorCode MpmCriticalThreshold(MpmCriticalGrowth growth, void *context, PetscReal tolerance,
                                    MpmCritical *critical);

/*
   Not collective. Phase m of those looked at, more of them near 0 and pi, where what happens may be squeezed against
   the end; and the phase looked at d after that of beta.
*/
PetscReal MpmCriticalPhase(PetscReal m);
PetscReal MpmCriticalBeside(PetscReal beta, PetscReal d);

/* Not collective. Golden section: the place in [lo, hi] of the least value of a function with one minimum there. */
typedef PetscErrorCode (*MpmFunction)(void *context, PetscReal x, PetscReal *value);
PetscErrorCode MpmGoldenSection(MpmFunction f, void *context, PetscReal lo, PetscReal hi, PetscReal *x,
                                PetscReal *value);
