/* The largest stable Courant number: by symbol or operator, and by closed form. */
#include "analysis/critical_parts.h"
#include <math.h>

#define SAME 1e-5       /* closed form and search, relative */
#define PRECISION 1e-10 /* of the closed form, relative */

static PetscErrorCode ClosedLimit(void *context, PetscReal beta, PetscReal *limit)
{
  const MpmPredictor  *predictor = (const MpmPredictor *)context;
  const MpmCellSymbols cell      = MpmPredictorSymbols(predictor, beta);

  PetscFunctionBegin;
  *limit = predictor->scene->formulation->limit(&cell);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalByClosedForm(const MpmScene *scene, MpmCritical *c)
{
  MpmPredictor predictor;
  PetscReal    limit, beta;

  PetscFunctionBegin;
  PetscCall(MpmPredictorCreate(scene, &predictor));
  c->closed = NAN;
  for (PetscInt m = MPM_CRITICAL_PHASES; m > 0 && !predictor.why_not && scene->formulation->limit; m--) {
    PetscCall(ClosedLimit(&predictor, MpmCriticalPhase(m), &limit));
    if (limit >= c->closed) continue;
    c->closed      = limit;
    c->closed_beta = MpmCriticalPhase(m);
  }
  if (c->closed > 0) {
    PetscCall(MpmGoldenSection(ClosedLimit, &predictor, MpmCriticalBeside(c->closed_beta, -1),
                               MpmCriticalBeside(c->closed_beta, 1), &beta, &limit));
    if (limit < c->closed * (1 - PRECISION)) {
      c->closed      = limit;
      c->closed_beta = beta;
    }
  }
  if (!isnan(c->closed)) c->cell = MpmPredictorSymbols(&predictor, c->closed_beta);
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether growth appears when particles move: a limit at rest does not say. */
static PetscErrorCode WhenMoving(const MpmScene *scene, MpmCritical *c)
{
  MpmScene   drifting = *scene;
  MpmFinding finding;
  PetscReal  beta;

  PetscFunctionBegin;
  drifting.drift = (MpmFraction){.num = 1, .den = MPM_CRITICAL_DRIFT, .value = 1.0 / MPM_CRITICAL_DRIFT};
  PetscCall(MpmCriticalGrowthAt(&drifting, scene->courant, &finding, &beta));
  c->moving = finding.growth;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A limit above a Courant number that grows has missed it: the search goes on from there. */
static PetscErrorCode BySymbol(const MpmScene *scene, PetscBool alone, MpmCritical *c)
{
  PetscErrorCode (*find)(const MpmScene *, PetscReal, PetscReal, MpmCritical *) =
      MpmSceneDrifts(scene) ? MpmCriticalUnderDrift : MpmCriticalAtRest;
  PetscReal beta;

  PetscFunctionBegin;
  PetscCall(find(scene, INFINITY, NAN, c));
  if (alone) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmCriticalGrowthAt(scene, scene->courant, &c->asked, &beta));
  if (c->asked.verdict == MPM_UNSTABLE && scene->courant < c->stable_at)
    PetscCall(find(scene, scene->courant, beta, c));
  if (!MpmSceneDrifts(scene)) PetscCall(WhenMoving(scene, c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalFind(const MpmScene *scene, PetscBool alone, MpmCritical *c)
{
  const PetscReal begin = MPI_Wtime();

  PetscFunctionBegin;
  *c = (MpmCritical){.unstable_at = INFINITY,
                     .doubtful    = INFINITY,
                     .beta        = NAN,
                     .null_share  = NAN,
                     .fading      = NAN,
                     .moving      = NAN,
                     .closed      = NAN,
                     .closed_beta = NAN,
                     .threshold   = PETSC_TRUE,
                     .asked       = {.tolerance = scene->tolerance, .growth = NAN, .verdict = MPM_UNDECIDED}};
  if (MpmSymbolWhyNot(scene))
    PetscCall(MpmCriticalAssembled(scene, c));
  else
    PetscCall(BySymbol(scene, alone, c));
  PetscCall(MpmCriticalByClosedForm(scene, c));
  /* long waves may grow by less than tolerance per step: the closed form knows */
  if (c->closed < c->stable_at * (1 - SAME)) c->courant = c->closed;
  c->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}
