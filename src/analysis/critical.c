/* Finds the largest stable Courant number through the symbol or the operator, and compares it with the closed form. */
#include "analysis/critical_parts.h"
#include "analysis/leftmost.h"
#include "symbol/predict.h"
#include <math.h>

#define AGREE 1e-5      /* relative difference of closed form and search */
#define BEYOND 0.01     /* relative distance above the limit at which growth is compared with that of rounding */
#define GROWS 1e-12     /* smallest growth of one phase that is no rounding */
#define PRECISION 1e-10 /* relative precision of the closed form */

/* The limit of a phase, in one dimension. */
static PetscErrorCode ClosedLimit(void *context, PetscReal beta, PetscReal *limit)
{
  const MpmPredictor *predictor = (const MpmPredictor *)context;
  MpmCellSymbols      cell[MPM_MAX_DIM];

  PetscFunctionBegin;
  (void)MpmPredictorSymbols(predictor, &beta, cell);
  *limit = predictor->scheme->formulation->limit(cell);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ClosedOnLine(const MpmPredictor *predictor, MpmCritical *c)
{
  PetscReal limit, beta;

  PetscFunctionBegin;
  for (PetscInt m = MPM_CRITICAL_PHASES; m > 0; m--) {
    PetscCall(ClosedLimit((void *)predictor, MpmSearchPhase(m), &limit));
    if (limit >= c->closed) continue;
    c->closed         = limit;
    c->closed_beta[0] = MpmSearchPhase(m);
  }
  if (!(c->closed > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSearchLeast(ClosedLimit, (void *)predictor, MPM_SEARCH_GOLDEN, MpmSearchBeside(c->closed_beta[0], -1),
                           MpmSearchBeside(c->closed_beta[0], 1), &beta, &limit));
  if (limit < c->closed * (1 - PRECISION)) {
    c->closed         = limit;
    c->closed_beta[0] = beta;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keeps the symbols of the problem that has the limit. */
static void KeepSymbols(const MpmPredictor *predictor, MpmCritical *c)
{
  MpmCellSymbols cell[MPM_MAX_DIM];
  const PetscInt n     = MpmPredictorSymbols(predictor, c->closed_beta, cell);
  PetscReal      least = NAN;

  for (PetscInt i = 0; i < n; i++) {
    const PetscReal limit = predictor->scheme->formulation->limit(&cell[i]);

    if (limit >= least) continue;
    least   = limit;
    c->cell = cell[i];
  }
}

PetscErrorCode MpmCriticalByClosedForm(const MpmLayout *layout, const MpmScheme *scheme, PetscBool drifts,
                                       MpmCritical *c)
{
  MpmPredictor predictor;

  PetscFunctionBegin;
  PetscCall(MpmPredictorCreate(layout, scheme, drifts, &predictor));
  c->closed = NAN;
  if (!predictor.why_not && scheme->formulation->limit && scheme->formulation->corrected &&
      !MpmSpaceIsPrestressed(&scheme->space)) {
    PetscCall(layout->dim == 1 ? ClosedOnLine(&predictor, c) : MpmCriticalClosedInSpace(&predictor, c));
    if (!isnan(c->closed)) KeepSymbols(&predictor, c);
  }
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes growth with a small drift, since a limit of particles at rest says nothing about moving ones. */
static PetscErrorCode WhenMoving(const MpmCriticalCase *of, MpmCritical *c)
{
  MpmCriticalCase moving = *of;
  MpmFinding      finding;
  PetscReal       beta;

  PetscFunctionBegin;
  moving.step.drift[0] = (MpmFraction){.num = 1, .den = MPM_CRITICAL_DRIFT, .value = 1.0 / MPM_CRITICAL_DRIFT};
  PetscCall(MpmCriticalGrowthAt(&moving, &finding, &beta));
  c->moving = finding.growth;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   If the limit found is above a Courant number that is known to grow, the search has missed the true limit. It then
   goes on down from that Courant number.
*/
static PetscErrorCode BySymbol(const MpmCriticalCase *of, PetscBool alone, MpmCritical *c)
{
  const PetscBool drifts = MpmStepDrifts(&of->step);
  PetscErrorCode (*find)(const MpmCriticalCase *, PetscReal, PetscReal, MpmCritical *) =
      drifts ? MpmCriticalUnderDrift : MpmCriticalAtRest;
  PetscReal beta;

  PetscFunctionBegin;
  PetscCall(find(of, INFINITY, NAN, c));
  if (alone) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmCriticalGrowthAt(of, &c->asked, &beta));
  if (c->asked.verdict == MPM_UNSTABLE && of->step.courant < c->stable_at)
    PetscCall(find(of, of->step.courant, beta, c));
  if (!drifts) PetscCall(WhenMoving(of, c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same where growth at rest may stop again. */
static PetscErrorCode ByScan(const MpmCriticalCase *of, PetscBool alone, MpmCritical *c)
{
  PetscReal beta = NAN;

  PetscFunctionBegin;
  if (!alone) PetscCall(MpmCriticalGrowthAt(of, &c->asked, &beta));
  PetscCall(MpmCriticalScanned(of, beta, c));
  if (!alone) PetscCall(WhenMoving(of, c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Whether what has become unstable at rest stays so on a uniform layout: by the theorem of docs/theory.md, section 5, or as the
   conditions of the closed form of each phase are linear in the square of the Courant number.
*/
static PetscBool Stays(const MpmCriticalCase *of, const MpmCritical *c)
{
  return !isnan(c->closed) || MpmLeftmostDecides(of->layout, of->scheme, &of->step) ? PETSC_TRUE : PETSC_FALSE;
}

/*
   Where rounding makes more growth than the tolerance, and growth above the limit is not larger than that, the limit is
   not known.
*/
static PetscErrorCode CheckRounding(const MpmCriticalCase *of, MpmCritical *c)
{
  PetscReal growth;

  PetscFunctionBegin;
  if (c->assembled || isinf(c->unstable_at)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmCriticalRounding(of, c->unstable_at, c->beta, &c->rounding));
  if (c->rounding > of->tolerance) {
    PetscCall(MpmCriticalGrowthOfPhase(of, c->unstable_at * (1 + BEYOND), c->beta, &growth));
    if (growth <= 1 + c->rounding) c->courant = NAN;
  }
  if (!isnan(c->courant)) c->rounding = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Finds whether any of the phases whose closed form gives a smaller limit really grows at a Courant number. Growth
   within tolerance counts too.
*/
static PetscErrorCode GrowsThere(const MpmCriticalCase *of, PetscReal courant, PetscBool *grows)
{
  MpmPredictor predictor;
  PetscReal    limit, growth;

  PetscFunctionBegin;
  *grows = PETSC_FALSE;
  PetscCall(MpmPredictorCreate(of->layout, of->scheme, MpmStepDrifts(&of->step), &predictor));
  for (PetscInt m = MPM_CRITICAL_PHASES; m > 0 && !*grows; m--) {
    PetscCall(ClosedLimit(&predictor, MpmSearchPhase(m), &limit));
    if (limit >= courant) continue;
    PetscCall(MpmCriticalGrowthOfPhase(of, courant, &(PetscReal){MpmSearchPhase(m)}, &growth));
    *grows = growth > 1 + GROWS ? PETSC_TRUE : PETSC_FALSE;
  }
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Dispute(MpmCritical *c)
{
  PetscFunctionBegin;
  c->disputed = PETSC_TRUE;
  c->courant  = NAN;
  PetscCall(MpmFindingDispute(&c->asked, "the closed form of the limit says otherwise"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Compares the closed form with the limit found. The closed form may be smaller, where long waves beyond it grow by
   less than the tolerance; then it is the limit. Every other difference is a contradiction.
*/
static PetscErrorCode Compare(const MpmCriticalCase *of, MpmCritical *c)
{
  PetscBool agrees = c->closed <= c->stable_at * (1 + AGREE) ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  if (isnan(c->closed) || isnan(c->courant) || (c->closed == 0 && c->courant == 0)) PetscFunctionReturn(PETSC_SUCCESS);
  if (c->closed < c->stable_at * (1 - AGREE)) {
    PetscCall(GrowsThere(of, isinf(c->stable_at) ? 2 * c->closed : (c->closed + c->stable_at) / 2, &agrees));
    if (agrees) c->courant = c->closed;
  }
  if (!agrees) PetscCall(Dispute(c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static MpmCritical Nothing(PetscReal tolerance)
{
  MpmCritical c = {.unstable_at     = INFINITY,
                   .doubtful        = INFINITY,
                   .null_share      = NAN,
                   .fading          = NAN,
                   .moving          = NAN,
                   .moving_diagonal = NAN,
                   .closed          = NAN,
                   .threshold       = PETSC_TRUE,
                   .asked           = {.tolerance = tolerance, .growth = NAN, .verdict = MPM_UNDECIDED}};

  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) c.beta[a] = c.closed_beta[a] = NAN;
  return c;
}

PetscErrorCode MpmCriticalFind(const MpmCriticalCase *of, PetscBool alone, MpmCritical *c)
{
  const PetscReal begin  = MPI_Wtime();
  const PetscBool drifts = MpmStepDrifts(&of->step), line = of->layout->dim == 1 ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  *c = Nothing(of->tolerance);
  PetscCall(MpmCriticalByClosedForm(of->layout, of->scheme, drifts, c));
  if (MpmSymbolWhyNot(of->layout))
    PetscCall(MpmCriticalAssembled(of, c));
  else if (!line)
    PetscCall(MpmCriticalInSpace(of, alone, c));
  else
    PetscCall(drifts || Stays(of, c) ? BySymbol(of, alone, c) : ByScan(of, alone, c));
  MpmZoomFold(of->layout->dim, c->beta);
  if (!drifts) c->bound = MpmCriticalBound(of->layout, of->scheme);
  PetscCall(CheckRounding(of, c));
  if (line)
    PetscCall(Compare(of, c));
  else if (c->disputed)
    PetscCall(Dispute(c));
  c->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}
