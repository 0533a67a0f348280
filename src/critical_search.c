/* Searches in one variable. */
#include <mpmstab/critical.h>
#include <math.h>

#define GOLDEN 0.6180339887498949
#define GOLDEN_STEPS 34 /* the interval becomes 8e-8 of itself: a minimum is flat below */

PetscErrorCode MpmCriticalCross(MpmCriticalGrowth growth, void *context, PetscReal tolerance, PetscReal from,
                                PetscReal to, PetscReal ratio, PetscReal precision, PetscReal bracket[2])
{
  PetscReal g, stable = 0, k = from;

  PetscFunctionBegin;
  for (;; k = PetscMin(k * ratio, to)) {
    PetscCall(growth(context, k, &g));
    if (!(g <= 1 + tolerance)) break;
    stable = k;
    if (k >= to) {
      bracket[0] = to;
      bracket[1] = INFINITY;
      PetscFunctionReturn(PETSC_SUCCESS);
    }
  }
  bracket[0] = stable;
  bracket[1] = k;
  if (stable == 0) PetscFunctionReturn(PETSC_SUCCESS);
  while (bracket[1] - bracket[0] > precision * bracket[1]) {
    k = (bracket[0] + bracket[1]) / 2;
    PetscCall(growth(context, k, &g));
    bracket[g <= 1 + tolerance ? 0 : 1] = k;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGoldenSection(MpmFunction f, void *context, PetscReal lo, PetscReal hi, PetscReal *x,
                                PetscReal *value)
{
  PetscReal a = hi - GOLDEN * (hi - lo), b = lo + GOLDEN * (hi - lo), at_a, at_b;

  PetscFunctionBegin;
  PetscCall(f(context, a, &at_a));
  PetscCall(f(context, b, &at_b));
  for (PetscInt i = 0; i < GOLDEN_STEPS; i++) {
    if (at_a <= at_b) {
      hi   = b;
      b    = a;
      at_b = at_a;
      a    = hi - GOLDEN * (hi - lo);
      PetscCall(f(context, a, &at_a));
    } else {
      lo   = a;
      a    = b;
      at_a = at_b;
      b    = lo + GOLDEN * (hi - lo);
      PetscCall(f(context, b, &at_b));
    }
  }
  *x     = at_a <= at_b ? a : b;
  *value = PetscMin(at_a, at_b);
  PetscFunctionReturn(PETSC_SUCCESS);
}
