/*
   A scene with an expect block is a test: each expectation that is missed is printed, and the program ends with status
   3.
*/
#include "task/expect.h"
#include <math.h>

static PetscErrorCode Miss(const char what[], const char found[], const char expected[], PetscInt *missed)
{
  PetscFunctionBegin;
  fflush(stdout);
  PetscCall(PetscFPrintf(PETSC_COMM_WORLD, stderr, "mpmstab: expected %s %s, found %s\n", what, expected, found));
  (*missed)++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmExpectNumber(const MpmExpect *expect, MpmExpected which, PetscReal value, PetscInt *missed)
{
  static const char *const what[MPM_EXPECTED] = {"growth",
                                                 "growth of the spectrum",
                                                 "largest l2 error",
                                                 "final / initial energy",
                                                 "critical Courant number",
                                                 "share of unstable layouts"};
  const PetscReal         *range              = expect->range[which];
  char                     expected[80], found[40];

  PetscFunctionBegin;
  if (!expect->has[which] || (value >= range[0] && value <= range[1])) PetscFunctionReturn(PETSC_SUCCESS);
  (void)snprintf(expected, sizeof expected, "in [%.10g, %.10g]", range[0], range[1]);
  (void)snprintf(found, sizeof found, isnan(value) ? "no value" : "%.10g", value);
  PetscCall(Miss(what[which], found, expected, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Verdict(const MpmExpect *expect, MpmVerdict verdict, PetscInt *missed)
{
  PetscFunctionBegin;
  if (expect->has_verdict && expect->verdict != verdict)
    PetscCall(Miss("verdict", MpmVerdictNames[verdict], MpmVerdictNames[expect->verdict], missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmExpectRun(const MpmRun *run, PetscInt *missed)
{
  const MpmExpect *expect = &run->request->expect;
  const MpmGrowth *growth = &run->growth;
  PetscReal        worst  = 0;
  const char      *name[MPM_MOST_ERRORS];

  PetscFunctionBegin;
  PetscCall(Verdict(expect, run->verdict, missed));
  if (expect->has_kind && (!growth->measured || growth->kind != expect->kind))
    PetscCall(Miss("growth of kind", growth->measured ? MpmGrowthKindNames[growth->kind] : "none measured",
                   MpmGrowthKindNames[expect->kind], missed));
  PetscCall(MpmExpectNumber(expect, MPM_EXPECT_GROWTH, growth->measured ? growth->per_step : NAN, missed));
  PetscCall(MpmExpectNumber(expect, MPM_EXPECT_ENERGY, run->energy_ratio, missed));
  for (PetscInt f = 0; run->has_errors && f < MpmSceneErrorFields(run->scene, name); f++)
    if (!(run->error[f].l2 <= worst)) worst = run->error[f].l2; /* NaN is the worst */
  PetscCall(MpmExpectNumber(expect, MPM_EXPECT_ERROR, worst, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmExpectFinding(const MpmExpect *expect, const MpmFinding *finding, PetscInt *missed)
{
  PetscFunctionBegin;
  PetscCall(Verdict(expect, finding->verdict, missed));
  PetscCall(MpmExpectNumber(expect, MPM_EXPECT_SPECTRUM, finding->growth, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}
