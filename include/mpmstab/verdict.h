/* Words for what was found, and the verdict on a growth that was computed. */
#pragma once
#include <mpmstab/compat.h>

typedef enum { MPM_STABLE, MPM_UNSTABLE, MPM_UNDECIDED } MpmVerdict;
extern const char *const MpmVerdictNames[];

/* How the norm of the state grew over the late part of a run. */
typedef enum { MPM_BOUNDED, MPM_LINEAR, MPM_EXPONENTIAL } MpmGrowthKind;
extern const char *const MpmGrowthKindNames[];

/*S
   MpmFinding - a verdict with what it rests on.

   growth is per step; uncertainty, how far rounding may have moved it: eigenvalues of condition number c move by about
   c times the rounding of the matrix. defective_error: how far it may have split a defective pair at 1, by the square root
   of that rounding, per step. evidence says where growth comes from.
*/
typedef struct {
  MpmVerdict verdict;
  PetscReal  growth, tolerance, uncertainty, defective_error;
  char       evidence[256];
} MpmFinding;

/*
   MpmVerdictOf - stable up to 1 + tolerance, unstable above; undecided when the excess over 1 is within the
   uncertainty, when the tolerance is within the error of a defective pair, or when growth is not known (NaN).

   Not collective. A defective pair at 1 (rigid motion: growth like t, which is no instability) is split by rounding
   to about 1 +- 1e-8, below any sensible tolerance; larger blocks at 1 split further, and their condition number says
   so.
*/
MpmVerdict MpmVerdictOf(const MpmFinding *finding);

/*
   MpmFindingDispute - makes a verdict undecided, because something else contradicts it; evidence then ends with ", but"
   and these words.

   Not collective.
*/
PetscErrorCode MpmFindingDispute(MpmFinding *finding, const char words[]);

/*
   MpmFindingOfPhases - makes stable undecided where it rests on phases that are not all waves of a grid of so many cells:
   they are when phases is a multiple of cells, and then the verdict is exact for that grid. Unstable is certain in any
   case.

   Not collective.
*/
PetscErrorCode MpmFindingOfPhases(MpmFinding *finding, PetscInt phases, PetscInt cells);

/* Not collective. Growth per step of an eigenvalue over a period: (size 2^exponent)^(1/period), in any range. */
PetscReal MpmGrowthPerStep(PetscReal size, PetscInt exponent, PetscInt period);

/*
   Not collective. How far growth may be off when its eigenvalue over a period is off by a relative error; infinite when
   that is no longer small.
*/
PetscReal MpmUncertaintyOf(PetscReal growth, PetscReal relative, PetscInt period);

/* Rounding of one step's matrix, relative, with room to spare; and how far operator and march may part. */
#define MPM_ROUNDING (10 * PETSC_MACHINE_EPSILON)
#define MPM_MISMATCH 1e-6

/*
   Not collective. How far rounding, a mismatch of operator and march, and what the solver left over (residual) may have
   moved an operator of this norm, in the units of its numbers; and the defective_error that comes from such an error of an
   operator times 2^exponent.
*/
PetscReal MpmOperatorErrorOf(PetscReal norm, PetscReal mismatch, PetscReal residual);
PetscReal MpmDefectiveErrorOf(PetscReal error, PetscInt exponent, PetscInt period);
