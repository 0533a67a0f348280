/* Closed forms of two-by-two amplification matrices, for more than one formulation. */
#include "scheme/formulation/closed_forms.h"
#include <mpmstab/transfer.h>
#include <math.h>

const MpmEnergyTerm MpmMomentumEnergy[2] = {{MPM_ON_PARTICLES, 0, PETSC_FALSE}, {MPM_ON_PARTICLES, 1, PETSC_TRUE}};

PetscReal MpmQuadraticRadius(double complex trace, double complex det)
{
  const double complex root = csqrt(trace * trace / 4 - det);
  return fmax(cabs(trace / 2 + root), cabs(trace / 2 - root));
}

PetscReal MpmStressAheadGrowth(const MpmCellSymbols *cell, PetscReal k)
{
  const PetscReal      f = cell->filter, alpha = cell->alpha, s = k * k * cell->kappa;
  const double complex x = k * k * cell->chi;

  if (cell->projected) return MpmQuadraticRadius(1 + f - alpha * (s + x), f);
  return MpmQuadraticRadius(1 + f - alpha * s - x, f - (f - alpha) * x);
}

/* Jury's conditions are abs(det) <= 1 and abs(trace) <= 1 + det. So alpha s <= 2 (1 + f) with s = k^2 kappa. */
PetscReal MpmStressAheadLimit(const MpmCellSymbols *cell)
{
  return sqrt(2 * (1 + cell->filter) / (cell->alpha * cell->kappa));
}

PetscReal MpmStressAheadBound(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer)
{
  (void)numbers;
  return transfer->step_bound ? 2 : 0;
}
