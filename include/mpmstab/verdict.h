/* Verdicts on a growth that was computed, and what they rest on. */
#pragma once
#include <mpmstab/compat.h>

typedef enum { MPM_STABLE, MPM_UNSTABLE, MPM_UNDECIDED } MpmVerdict;
extern const char *const MpmVerdictNames[];

/* The way in which the norm of the state grew over the late part of a run. */
typedef enum { MPM_BOUNDED, MPM_LINEAR, MPM_EXPONENTIAL } MpmGrowthKind;
extern const char *const MpmGrowthKindNames[];

/*S
   MpmFinding - a verdict, and what it rests on.

   verdict         - see MpmVerdictOf
   growth          - the spectral radius per step; NaN when it is not known
   tolerance       - growth up to 1 + tolerance counts as stable
   uncertainty     - an estimate of the error of growth by rounding: an eigenvalue of condition number c moves by about
                     c times the rounding of the matrix
   defective_error - the error of a defective eigenvalue at 1: rounding splits a defective pair by about the square root
                     of the rounding of the matrix; this is the growth per step that comes of it
   lost            - what an uncertainty without bound comes of; NULL: rounding
   evidence        - says where growth comes from
S*/
typedef struct {
  MpmVerdict  verdict;
  PetscReal   growth, tolerance, uncertainty, defective_error;
  const char *lost;
  char        evidence[1024];
} MpmFinding;

/*
   MpmVerdictOf - the verdict on growth. Growth up to 1 + tolerance is stable, and growth above is unstable. The verdict
   is undecided when growth is above but its excess over 1 is within the uncertainty, when it is not but the
   defective_error is more than the tolerance, or when growth is not known (NaN).

   Not collective. verdict of the finding is not read.

   A defective pair at 1 comes of rigid motion, which grows linearly with time and is no instability. Rounding splits it
   to about 1 +- 1e-8, below any sensible tolerance. Larger defective blocks at 1 split further, and their condition
   number says so.
*/
MpmVerdict MpmVerdictOf(const MpmFinding *finding);

/*
   MpmFindingDispute - makes a verdict undecided because something else contradicts it. Appends ", but" and the words to
   its evidence.

   Not collective.
*/
PetscErrorCode MpmFindingDispute(MpmFinding *finding, const char words[]);

/*
   Not collective. Makes an undecided verdict stable because something proves it, and appends the words to its evidence.
*/
PetscErrorCode MpmFindingDecide(MpmFinding *finding, const char words[]);

/*
   MpmFindingOfPhases - makes the verdict stable undecided where its phases are not all waves of a grid with this number
   of cells. They are all waves when phases is a multiple of cells; the verdict is then exact for that grid. The verdict
   unstable is certain in any case.

   Not collective.
*/
PetscErrorCode MpmFindingOfPhases(MpmFinding *finding, PetscInt phases, PetscInt cells);

/*
   Not collective. The growth per step of an eigenvalue of a period's operator, (size 2^exponent)^(1/period). The
   product may be out of the range of doubles.
*/
PetscReal MpmGrowthPerStep(PetscReal size, PetscInt exponent, PetscInt period);

/*
   Not collective. The error of growth when its eigenvalue, of a period's operator, has a relative error. It is infinite
   when the relative error is more than 0.1.
*/
PetscReal MpmUncertaintyOf(PetscReal growth, PetscReal relative, PetscInt period);

/*
   MPM_ROUNDING is the relative rounding error of one step's matrix, with room to spare. MPM_MISMATCH is the largest
   relative difference of operator and march that passes.
*/
#define MPM_ROUNDING (10 * PETSC_MACHINE_EPSILON)
#define MPM_MISMATCH 1e-6

/*
   Not collective.

   MpmOperatorErrorOf  - the error of an operator of this norm, in the same units. It comes of rounding, of the mismatch
                         of operator and march, and of the relative residual that the solver has left.
   MpmDefectiveErrorOf - the defective_error that an error of an operator makes; the operator is times 2^exponent
*/
PetscReal MpmOperatorErrorOf(PetscReal norm, PetscReal mismatch, PetscReal residual);
PetscReal MpmDefectiveErrorOf(PetscReal error, PetscInt exponent, PetscInt period);
