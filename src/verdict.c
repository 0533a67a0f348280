/* Verdicts. */
#include <mpmstab/verdict.h>
#include <math.h>

const char *const MpmVerdictNames[]    = {"stable", "unstable", "undecided", NULL};
const char *const MpmGrowthKindNames[] = {"bounded", "linear", "exponential", NULL};

MpmVerdict MpmVerdictOf(PetscReal growth, PetscReal tolerance, PetscReal uncertainty)
{
  if (isnan(growth)) return MPM_UNDECIDED;
  if (growth <= 1 + tolerance) return MPM_STABLE;
  return isinf(growth) || growth - 1 > uncertainty ? MPM_UNSTABLE : MPM_UNDECIDED;
}
