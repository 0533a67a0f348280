/* Mach numbers as multiples of one fraction, and the drifts that they make. */
#include "scene/mach.h"
#include <mpmstab/scheme.h>
#include <math.h>

void MpmMachCreate(PetscInt dim, const MpmFraction number[], MpmMach *mach, PetscBool *ok)
{
  PetscInt64 common = 1, divisor = 0;

  *mach = (MpmMach){.dim = dim, .unit = {.den = 1}};
  *ok   = PETSC_FALSE;
  for (PetscInt a = 0; a < dim; a++) {
    if (!number[a].den) return;
    if (__builtin_mul_overflow(common / MpmCommonDivisor(common, number[a].den), number[a].den, &common)) return;
  }
  for (PetscInt a = 0; a < dim; a++) {
    if (__builtin_mul_overflow(number[a].num, common / number[a].den, &mach->times[a])) return;
    divisor = MpmCommonDivisor(divisor, mach->times[a]);
  }
  *ok = PETSC_TRUE;
  if (!divisor) return;
  for (PetscInt a = 0; a < dim; a++) mach->times[a] /= divisor;
  mach->unit = MpmFractionProduct(
      2, (const MpmFraction[]){{divisor, 1, (PetscReal)divisor}, {1, common, 1 / (PetscReal)common}});
  if (!mach->unit.den) *ok = PETSC_FALSE;
}

void MpmMachDrift(const MpmMach *mach, const MpmFraction *part, MpmFraction drift[])
{
  for (PetscInt a = 0; a < mach->dim; a++) {
    const MpmFraction factors[2] = {{mach->times[a], 1, (PetscReal)mach->times[a]}, *part};

    drift[a] = MpmFractionProduct(2, factors);
  }
}

MpmFraction MpmMachNearest(const MpmMach *mach, PetscReal courant, PetscInt64 most)
{
  const PetscReal part = courant * mach->unit.value, steps = PetscMax((PetscReal)most, ceil(1 / part));

  if (!(steps <= MPM_LONGEST_PERIOD)) return (MpmFraction){.value = part};
  return MpmFractionNearest(part, (PetscInt64)steps);
}

MpmFraction MpmMachCourant(const MpmMach *mach, const MpmFraction *part)
{
  const MpmFraction over = {mach->unit.den, mach->unit.num, 1 / mach->unit.value}, factors[2] = {*part, over};

  return MpmFractionProduct(2, factors);
}
