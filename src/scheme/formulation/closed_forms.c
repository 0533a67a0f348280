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

  const PetscReal lost = alpha * k * cell->drag;

  if (cell->projected) return MpmQuadraticRadius(1 + f - alpha * (s + x) - lost, f - lost);
  return MpmQuadraticRadius(1 + f - alpha * s - x - lost, f - (f - alpha) * x - lost);
}

/* Jury's conditions are abs(det) <= 1 and abs(trace) <= 1 + det. So alpha s <= 2 (1 + f) with s = k^2 kappa. */
PetscReal MpmStressAheadLimit(const MpmCellSymbols *cell)
{
  return MpmDampedLimit(cell, sqrt(2 * (1 + cell->filter) / (cell->alpha * cell->kappa)));
}

/* With y = 2 (1 + f), Jury's condition k^2 (y / limit^2) + 2 alpha drag k <= y is linear in what is lost per time. */
PetscReal MpmDampedLimit(const MpmCellSymbols *cell, PetscReal limit)
{
  const PetscReal lost = cell->alpha * cell->drag / (1 + cell->filter), square = isinf(limit) ? 0 : 1 / (limit * limit);

  return lost == 0 ? limit : 2 / (lost + sqrt(lost * lost + 4 * square));
}

PetscReal MpmStressAheadBound(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer)
{
  (void)numbers;
  return transfer->step_bound ? 2 : 0;
}
