/* Fits growth to made-up series whose kind is known. */
#include "check.h"
#include "analysis/growth.h"

typedef PetscReal (*Shape)(PetscReal step); /* the logarithm of the norm */

static PetscReal Constant(PetscReal t)
{
  return log(3) + 0 * t;
}
static PetscReal Oscillating(PetscReal t)
{
  return log(3 + 0.1 * sin(0.37 * t));
}
static PetscReal FromZero(PetscReal t)
{
  return log(0.01 * (t + 1));
}
static PetscReal LinearLate(PetscReal t)
{
  return log(hypot(1 + 0.02 * sin(0.5 * t), 0.05 * t));
}
static PetscReal Decaying(PetscReal t)
{
  return -0.03 * t;
}
static PetscReal Slow(PetscReal t)
{
  return 0.002 * t;
}
static PetscReal Fast(PetscReal t)
{
  return 0.11 * t;
}
static PetscReal Emerging(PetscReal t)
{
  return log(hypot(1, 1e-4 * exp(0.05 * t)));
}

static PetscErrorCode Fits(const char name[], Shape shape, PetscInt64 steps, MpmGrowthKind kind, PetscReal per_step,
                           PetscReal tolerance)
{
  MpmSeries series = {0};
  MpmGrowth growth;

  PetscFunctionBegin;
  for (PetscInt64 t = 0; t <= steps; t += PetscMax(1, steps / 256))
    PetscCall(MpmSeriesAppend(&series, t, shape((PetscReal)t), shape((PetscReal)t)));
  PetscCall(MpmGrowthFit(&series, 1e-6, PETSC_FALSE, &growth));
  CHECK(growth.measured, "%s: not measured", name);
  CHECK(growth.kind == kind, "%s: %s", name, MpmGrowthKindNames[growth.kind]);
  CHECK_NEAR(growth.per_step, per_step, tolerance);
  CHECK(MpmGrowthVerdict(&growth, 1e-6) == (kind == MPM_EXPONENTIAL ? MPM_UNSTABLE : MPM_STABLE), "%s: %s", name,
        MpmVerdictNames[MpmGrowthVerdict(&growth, 1e-6)]);
  PetscCall(MpmSeriesDestroy(&series));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  MpmSeries series = {0};
  MpmGrowth growth;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(Fits("constant", Constant, 100, MPM_BOUNDED, 1, 1e-12));
  PetscCall(Fits("oscillating", Oscillating, 200, MPM_BOUNDED, 1, 1e-3));
  PetscCall(Fits("linear from zero", FromZero, 1000, MPM_LINEAR, exp(log(2) / 500), 1e-4));
  PetscCall(Fits("linear late", LinearLate, 1000, MPM_LINEAR, exp(log(2) / 500), 1e-4));
  PetscCall(Fits("decaying", Decaying, 100, MPM_BOUNDED, exp(-0.03), 1e-12));
  PetscCall(Fits("slow exponential", Slow, 400, MPM_EXPONENTIAL, exp(0.002), 1e-12));
  PetscCall(Fits("fast exponential", Fast, 100000, MPM_EXPONENTIAL, exp(0.11), 1e-9));
  PetscCall(Fits("emerging", Emerging, 400, MPM_EXPONENTIAL, exp(0.05), 2e-3));

  /* with too few samples, or when the state has vanished, nothing is measured */
  for (PetscInt64 t = 0; t < 6; t++) PetscCall(MpmSeriesAppend(&series, t, 0, 0));
  PetscCall(MpmGrowthFit(&series, 1e-6, PETSC_FALSE, &growth));
  CHECK(!growth.measured && MpmGrowthVerdict(&growth, 1e-6) == MPM_UNDECIDED, "a verdict from six steps");
  for (PetscInt64 t = 6; t < 100; t++) PetscCall(MpmSeriesAppend(&series, t, -INFINITY, -INFINITY));
  PetscCall(MpmGrowthFit(&series, 1e-6, PETSC_FALSE, &growth));
  CHECK(!growth.measured, "a verdict from nothing");
  PetscCall(MpmSeriesDestroy(&series));

  /* rigid motion: the energy is constant, the norm grows linearly; seen only when asked */
  for (PetscInt64 t = 0; t < 400; t++) PetscCall(MpmSeriesAppend(&series, t, log(hypot(1, 0.1 * t)), 0));
  PetscCall(MpmGrowthFit(&series, 1e-6, PETSC_TRUE, &growth));
  CHECK(growth.kind == MPM_LINEAR, "rigid motion: %s", MpmGrowthKindNames[growth.kind]);
  PetscCall(MpmGrowthFit(&series, 1e-6, PETSC_FALSE, &growth));
  CHECK(growth.kind == MPM_BOUNDED, "rigid motion not watched: %s", MpmGrowthKindNames[growth.kind]);
  PetscCall(MpmSeriesDestroy(&series));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
