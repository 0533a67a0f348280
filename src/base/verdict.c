/* Verdicts on stability, and the uncertainties of growth that they rest on. */
#include <mpmstab/verdict.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define STILL_SMALL 0.1

const char *const MpmVerdictNames[]    = {"stable", "unstable", "undecided", NULL};
const char *const MpmGrowthKindNames[] = {"bounded", "linear", "exponential", NULL};

PetscReal MpmGrowthPerStep(PetscReal size, PetscInt exponent, PetscInt period)
{
  return exp((log(size) + M_LN2 * exponent) / period);
}

PetscReal MpmUncertaintyOf(PetscReal growth, PetscReal relative, PetscInt period)
{
  return relative <= STILL_SMALL ? growth * relative / period : INFINITY;
}

PetscReal MpmOperatorErrorOf(PetscReal norm, PetscReal mismatch, PetscReal residual)
{
  return norm * (PetscMax(MPM_ROUNDING, mismatch) + residual);
}

PetscReal MpmDefectiveErrorOf(PetscReal error, PetscInt exponent, PetscInt period)
{
  return sqrt(scalbn(error, (int)exponent)) / period;
}

MpmVerdict MpmVerdictOf(const MpmFinding *f)
{
  if (isnan(f->growth)) return MPM_UNDECIDED;
  if (f->growth <= 1 + f->tolerance) return f->defective_error <= f->tolerance ? MPM_STABLE : MPM_UNDECIDED;
  return isinf(f->growth) || f->growth - 1 > f->uncertainty ? MPM_UNSTABLE : MPM_UNDECIDED;
}

PetscErrorCode MpmFindingDispute(MpmFinding *f, const char words[])
{
  const size_t said = strlen(f->evidence);

  PetscFunctionBegin;
  f->verdict = MPM_UNDECIDED;
  (void)snprintf(f->evidence + said, sizeof f->evidence - said, ", but %s", words);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFindingDecide(MpmFinding *finding, const char words[])
{
  const size_t said = strlen(finding->evidence);

  PetscFunctionBegin;
  if (finding->verdict != MPM_UNDECIDED) PetscFunctionReturn(PETSC_SUCCESS);
  finding->verdict = MPM_STABLE;
  (void)snprintf(finding->evidence + said, sizeof finding->evidence - said, "; %s", words);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFindingOfPhases(MpmFinding *f, PetscInt phases, PetscInt cells)
{
  char words[80];

  PetscFunctionBegin;
  if (f->verdict != MPM_STABLE || phases % cells == 0) PetscFunctionReturn(PETSC_SUCCESS);
  (void)snprintf(words, sizeof words, "they leave out waves of the grid of %" PetscInt_FMT " cells", cells);
  PetscCall(MpmFindingDispute(f, words));
  PetscFunctionReturn(PETSC_SUCCESS);
}
