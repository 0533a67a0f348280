/* The largest stable Courant number at rest in two and three dimensions: that of the closed form, confirmed by the symbol. */
#include "analysis/critical_parts.h"
#include "analysis/waves.h"
#include <math.h>

#define CLOSE 1e-6 /* relative distance from the limit at which the symbol is looked at, */
#define FAR 1e-2   /* and the largest, where growth begins slowly */

/*
   Compares growth by the symbol just below and just above the Courant number at which the closed form leaves the
   tolerance, at the wave where it does. Where growth is slow the two are farther apart.
*/
static PetscErrorCode ConfirmAbove(const MpmCriticalCase *of, PetscReal courant, MpmCritical *c)
{
  MpmWaves  waves;
  PetscReal growth[2], rounding;

  PetscFunctionBegin;
  c->disputed = PETSC_TRUE;
  PetscCall(MpmWavesCreate(of->layout, of->scheme, of->step.drift, &waves));
  PetscCall(MpmWavesRounding(&waves, courant, c->beta, NAN, &rounding, NULL));
  for (PetscReal beside = CLOSE; beside <= FAR * (1 + CLOSE) && c->disputed; beside *= 10) {
    c->stable_at   = courant * (1 - beside);
    c->unstable_at = courant * (1 + beside);
    PetscCall(MpmWavesGrowth(&waves, c->stable_at, c->beta, &growth[0]));
    PetscCall(MpmWavesGrowth(&waves, c->unstable_at, c->beta, &growth[1]));
    if (growth[0] <= 1 + PetscMax(of->tolerance, rounding) && growth[1] > 1 + of->tolerance) c->disputed = PETSC_FALSE;
  }
  c->evaluations += waves.evaluations;
  PetscCall(MpmWavesDestroy(&waves));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Looks for growth below the limit at other phases. */
static PetscErrorCode ConfirmBelow(const MpmCriticalCase *of, MpmCritical *c)
{
  MpmCriticalCase below   = *of;
  MpmFinding      finding = {0};
  PetscReal       beta[MPM_MAX_DIM];

  PetscFunctionBegin;
  below.step.courant = isfinite(c->stable_at) ? c->stable_at : MPM_CRITICAL_TO;
  PetscCall(MpmCriticalSampleGrowth(&below, PETSC_FALSE, &finding, beta, &c->evaluations));
  if (finding.growth > 1 + PetscMax(of->tolerance, finding.defective_error)) c->disputed = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalSpaceAtRest(const MpmCriticalCase *of, const MpmCriticalStart *start, MpmCritical *c)
{
  MpmPredictor predictor;
  PetscReal    tolerated;

  PetscFunctionBegin;
  PetscCall(MpmPredictorCreate(of->layout, of->scheme, PETSC_FALSE, &predictor));
  c->order     = of->scheme->table->nstate * MpmLayoutPpc(of->layout);
  c->phases    = MpmCriticalSamples(of->layout, of->scheme);
  c->courant   = c->closed;
  c->stable_at = c->unstable_at = INFINITY;
  PetscCall(MpmCriticalClosedTolerated(&predictor, of->tolerance, c, c->beta, &tolerated));
  if (isfinite(tolerated)) PetscCall(ConfirmAbove(of, tolerated, c));
  if (!start->alone) PetscCall(ConfirmBelow(of, c));
  if (c->closed == 0 && isfinite(tolerated)) MpmCriticalClosedFading(&predictor, c);
  if (c->disputed) c->courant = NAN;
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}
