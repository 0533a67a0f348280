/* Searches in one variable: bisection, the threshold of growth, golden section. */
#include "symbol/predict.h"
#include <mpmstab/critical.h>
#include <math.h>

#define LEAST 1e-24 /* Courant number; a second material may be that much stiffer and lighter */
#define FADES 0.03  /* growth at half a limit, over the tolerance, that shows that there is no threshold */
#define GOLDEN 0.6180339887498949
#define GOLDEN_STEPS 34 /* they shrink the interval to 8e-8 of itself; a minimum is flat on a smaller one */

/*
   Halves an unstable Courant number until it is stable, and sets the bracket. bracket[0] stays 0 when none is stable.
*/
static PetscErrorCode FindStable(MpmCriticalGrowth growth, void *context, PetscReal tolerance, PetscReal bracket[2])
{
  PetscReal g;

  PetscFunctionBegin;
  for (PetscReal k = bracket[1] / 2; k >= LEAST; k /= 2) {
    PetscCall(growth(context, k, &g));
    bracket[g <= 1 + tolerance ? 0 : 1] = k;
    if (bracket[0] > 0) break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Bisect(MpmCriticalGrowth growth, void *context, PetscReal tolerance, PetscReal precision,
                             PetscReal bracket[2])
{
  PetscReal g, k;

  PetscFunctionBegin;
  while (bracket[0] > 0 && bracket[1] - bracket[0] > precision * bracket[1]) {
    k = (bracket[0] + bracket[1]) / 2;
    PetscCall(growth(context, k, &g));
    bracket[g <= 1 + tolerance ? 0 : 1] = k;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalCross(MpmCriticalGrowth growth, void *context, PetscReal tolerance,
                                const MpmCriticalSteps *steps, PetscReal precision, PetscReal bracket[2])
{
  PetscReal g, k = steps->from;

  PetscFunctionBegin;
  bracket[0] = 0;
  for (;; k = PetscMin(PetscMin(k * steps->ratio, k + steps->width), steps->to)) {
    PetscCall(growth(context, k, &g));
    if (!(g <= 1 + tolerance)) break;
    bracket[0] = k;
    if (k < steps->to) continue;
    bracket[1] = INFINITY;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  bracket[1] = k;
  if (bracket[0] == 0) PetscCall(FindStable(growth, context, tolerance, bracket));
  PetscCall(Bisect(growth, context, tolerance, precision, bracket));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalThreshold(MpmCriticalGrowth growth, void *context, PetscReal tolerance, MpmCritical *c)
{
  PetscReal at[2];

  PetscFunctionBegin;
  if (c->stable_at == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(growth(context, c->unstable_at, &at[0]));
  PetscCall(growth(context, c->unstable_at / 2, &at[1]));
  c->threshold = at[1] - 1 <= FADES * tolerance ? PETSC_TRUE : PETSC_FALSE;
  if (!c->threshold) c->fading = log2((at[0] - 1) / (at[1] - 1));
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

PetscReal MpmCriticalPhase(PetscReal m)
{
  return PETSC_PI / 2 * (1 - cos(PETSC_PI * PetscMin(PetscMax(m, 0), MPM_CRITICAL_PHASES) / MPM_CRITICAL_PHASES));
}

PetscReal MpmCriticalBeside(PetscReal beta, PetscReal d)
{
  return MpmCriticalPhase(acos(1 - 2 * beta / PETSC_PI) / PETSC_PI * MPM_CRITICAL_PHASES + d);
}
