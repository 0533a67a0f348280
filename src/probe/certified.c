/* Verdicts on operators that were probed. */
#include "probe/certified.h"
#include <math.h>

#define MOVES_BY 1e-3 /* the share of a mode's growth by which the base state may move */

PetscErrorCode MpmCertifiedVerdict(const MpmCertificates *c, PetscReal condition, PetscInt period, MpmFinding *f)
{
  PetscReal error = 0;

  PetscFunctionBegin;
  if (!isnan(c->value[MPM_CERTIFY_SIZES])) error += c->value[MPM_CERTIFY_SIZES];
  if (!isnan(c->value[MPM_CERTIFY_REPEAT])) error += c->value[MPM_CERTIFY_REPEAT];
  if (f->growth > 1 + f->tolerance) {
    const PetscReal relative = condition * error / pow(f->growth, period);

    f->uncertainty = PetscMax(f->uncertainty, MpmUncertaintyOf(f->growth, relative, period));
  }
  f->verdict = MpmVerdictOf(f);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Whether growth is beyond what the fault that a certificate shows can make of an eigenvalue of this condition. What is felt
   too far away may be felt in every cell.
*/
static PetscBool IsBeyond(const MpmCertificates *c, MpmCertificate which, PetscReal condition, const MpmFinding *f)
{
  const PetscReal value  = c->value[which] * (PetscReal)(which == MPM_CERTIFY_REACH ? c->cells : 1),
                  excess = f->growth - 1;

  if (which == MPM_CERTIFY_EQUILIBRIUM) return value < MOVES_BY * excess ? PETSC_TRUE : PETSC_FALSE;
  return excess > f->tolerance + condition * value ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmCertifiedDispute(const MpmCertificates *c, PetscReal condition, MpmFinding *f)
{
  PetscFunctionBegin;
  for (MpmCertificate which = 0; which < MPM_CERTIFICATES; which++) {
    if (!MpmCertificateFails(c, which)) continue;
    if (f->verdict == MPM_UNSTABLE && IsBeyond(c, which, condition, f)) continue;
    PetscCall(MpmFindingDispute(f, MpmCertificateFaults[which]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
