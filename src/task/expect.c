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

static PetscErrorCode CheckRange(const char what[], PetscReal value, const PetscReal range[2], PetscInt *missed)
{
  char expected[80], found[40];

  PetscFunctionBegin;
  if (value >= range[0] && value <= range[1]) PetscFunctionReturn(PETSC_SUCCESS);
  (void)snprintf(expected, sizeof expected, "in [%.10g, %.10g]", range[0], range[1]);
  if (isnan(value))
    (void)snprintf(found, sizeof found, "%s", "no value");
  else
    (void)snprintf(found, sizeof found, "%.10g", value);
  PetscCall(Miss(what, found, expected, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmExpectRun(const MpmRun *run, PetscInt *missed)
{
  const MpmExpect *expect = &run->request->expect;
  const MpmGrowth *growth = &run->growth;
  PetscReal        worst  = 0;
  const char      *name[MPM_MOST_ERRORS];

  PetscFunctionBegin;
  *missed = 0;
  if (expect->has_verdict && expect->verdict != run->verdict)
    PetscCall(Miss("verdict", MpmVerdictNames[run->verdict], MpmVerdictNames[expect->verdict], missed));
  if (expect->has_kind && (!growth->measured || growth->kind != expect->kind))
    PetscCall(Miss("growth of kind", growth->measured ? MpmGrowthKindNames[growth->kind] : "none measured",
                   MpmGrowthKindNames[expect->kind], missed));
  if (expect->has_growth)
    PetscCall(CheckRange("growth", growth->measured ? growth->per_step : NAN, expect->growth, missed));
  if (expect->has_energy) PetscCall(CheckRange("final / initial energy", run->energy_ratio, expect->energy, missed));
  for (PetscInt f = 0; run->has_errors && f < MpmSceneErrorFields(run->scene, name); f++)
    if (!(run->error[f].l2 <= worst)) worst = run->error[f].l2; /* NaN is the worst */
  if (expect->has_error) PetscCall(CheckRange("largest l2 error", worst, expect->error, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmExpectFinding(const MpmExpect *expect, const MpmFinding *finding, PetscInt *missed)
{
  PetscFunctionBegin;
  *missed = 0;
  if (expect->has_verdict && expect->verdict != finding->verdict)
    PetscCall(Miss("verdict", MpmVerdictNames[finding->verdict], MpmVerdictNames[expect->verdict], missed));
  if (expect->has_spectrum) PetscCall(CheckRange("growth of the spectrum", finding->growth, expect->spectrum, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmExpectCritical(const MpmExpect *expect, PetscReal courant, PetscInt *missed)
{
  PetscFunctionBegin;
  if (expect->has_critical) PetscCall(CheckRange("critical Courant number", courant, expect->critical, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmExpectShare(const MpmExpect *expect, PetscReal share, PetscInt *missed)
{
  PetscFunctionBegin;
  if (expect->has_share) PetscCall(CheckRange("share of unstable layouts", share, expect->share, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}
