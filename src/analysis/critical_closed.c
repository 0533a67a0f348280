/* The limit by the closed form, at rest: the least over all phases, and where growth by it leaves the tolerance. */
#include "analysis/critical_parts.h"
#include "analysis/lone.h"
#include "analysis/waves.h"
#include <math.h>

#define PRECISION 1e-10 /* relative difference of second moments that is rounding */
#define PLANE_POINTS 48 /* phases in (0, pi] of each direction with which the search by closed forms begins */
#define SPACE_POINTS 16
#define WEDGE_POINTS 24 /* the same in three dimensions where they are all alike */
#define WITHIN 1.25     /* the search goes on from limits on this grid that are within this factor of the least */
#define FINEST 1e-8     /* last step in beta */
#define LEAST_BETA 2e-4 /* no waves longer than this: closed forms cancel there */
#define LONG 1e-3       /* phases below this are of long waves; */
#define FALLS 0.9       /* where their limit at twice the length is smaller by this factor it goes to 0 */
#define TOLERATED 1e-12 /* relative width of the bracket in which growth leaves the tolerance */
#define CLOSE 1e-6      /* relative distance from the limit at which the symbol is looked at, */
#define FAR 1e-2        /* and the largest, where growth begins slowly */
#define GROWS 1e-12     /* smallest growth that is no rounding */
#define BEYOND 1e-5     /* relative distance from the limit within which growth should leave the tolerance */

/* A closed form, of, as a function of the phases. least: the least limit with growth beyond the tolerance so far. */
typedef struct {
  const MpmPredictor *predictor;
  PetscReal (*of)(const MpmCellSymbols *cell);
  PetscReal tolerance, least;
} Closed;

static MpmZoom ClosedZoom(const MpmPredictor *predictor)
{
  const MpmFraction rest[MPM_MAX_DIM] = {{.den = 1}, {.den = 1}, {.den = 1}};
  const MpmLayout  *layout            = predictor->layout;
  MpmZoom           zoom              = MpmZoomOf(layout, &predictor->scheme->space, rest);

  zoom.points = layout->dim == 1                                             ? MPM_CRITICAL_PHASES
                : layout->dim == 2                                           ? PLANE_POINTS
                : zoom.alike[1] == 0 && zoom.alike[2] == 0 && zoom.mirror[0] ? WEDGE_POINTS
                                                                             : SPACE_POINTS;
  zoom.starts = MPM_ZOOM_STARTS;
  zoom.within = WITHIN;
  zoom.finest = FINEST;
  zoom.least  = LEAST_BETA;
  zoom.comm   = PETSC_COMM_SELF;
  return zoom;
}

/* The least of a closed form over the problems of a phase. */
static PetscReal LeastOf(const Closed *closed, const PetscReal beta[])
{
  MpmCellSymbols cell[MPM_MAX_DIM];
  const PetscInt n     = MpmPredictorSymbols(closed->predictor, beta, cell);
  PetscReal      least = INFINITY;

  for (PetscInt i = 0; i < n; i++) least = fmin(least, closed->of(&cell[i]));
  return least;
}

static PetscErrorCode LimitAt(void *context, const PetscReal beta[], PetscReal *limit)
{
  PetscFunctionBegin;
  *limit = LeastOf(context, beta);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The limits of long waves may go to 0 with beta (gas1 with xpic). Then the least one is 0, and at no phase. */
static PetscErrorCode LeastLimit(Closed *closed, MpmCritical *c)
{
  const MpmZoom zoom    = ClosedZoom(closed->predictor);
  PetscReal     largest = 0, beta[MPM_MAX_DIM], shorter;

  PetscFunctionBegin;
  PetscCall(MpmZoomLeast(&zoom, LimitAt, closed, c->closed_beta, &c->closed));
  for (PetscInt a = 0; a < zoom.dim; a++) {
    largest = PetscMax(largest, PetscAbsReal(c->closed_beta[a]));
    beta[a] = 2 * c->closed_beta[a];
  }
  if (!(largest < LONG)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(LimitAt(closed, beta, &shorter));
  if (c->closed < FALLS * shorter) c->closed = 0;
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
  Closed       closed = {.predictor = &predictor, .of = scheme->formulation->limit};

  PetscFunctionBegin;
  PetscCall(MpmPredictorCreate(layout, scheme, drifts, NULL, &predictor));
  c->closed = NAN;
  if (!predictor.why_not && scheme->formulation->limit && scheme->formulation->corrected &&
      !MpmSpaceIsPrestressed(&scheme->space)) {
    PetscCall(LeastLimit(&closed, c));
    if (!isnan(c->closed)) KeepSymbols(&predictor, c);
  }
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- steps that cannot ring ---- */

const char *MpmCriticalWhyNotQuiet(const MpmCriticalCase *of)
{
  const MpmScheme *scheme = of->scheme;
  PetscReal        spread[2];

  if (!scheme->formulation->quiet) return "the formulation has no such theorem";
  if (!scheme->transfer->quiet) return "the transfer may raise the energy of the particles";
  if (scheme->space.finite) return "deformation is finite";
  if (MpmSpaceIsDamped(&scheme->space)) return "it has damping or viscosity";
  if (MpmSpaceIsPrestressed(&scheme->space)) return "particles have a prestress";
  if (MpmSymbolWhyNot(of->layout)) return "the layout has no symbol";
  if (MpmBasisIsAltered(scheme->basis)) return "functions of the basis differ near walls";
  for (PetscInt a = 0; a < of->layout->dim && scheme->transfer->affine; a++) {
    MpmCriticalSpread(scheme->basis, of->layout->half_width[a], spread);
    if (spread[1] > spread[0] * (1 + PRECISION))
      return "the second moment D of the weights depends on the place in a cell, and the affine field reads it";
  }
  return NULL;
}

PetscErrorCode MpmCriticalQuiet(const MpmCriticalCase *of, PetscReal *quiet)
{
  MpmPredictor predictor;
  Closed       closed = {.predictor = &predictor, .of = of->scheme->formulation->quiet};
  PetscInt     period;

  PetscFunctionBegin;
  *quiet = 0;
  if (MpmCriticalWhyNotQuiet(of)) PetscFunctionReturn(PETSC_SUCCESS);
  *quiet = INFINITY;
  PetscCall(MpmStepPeriod(&of->step, &period));
  PetscCall(MpmPredictorCreate(of->layout, of->scheme, PETSC_FALSE, of->step.drift, &predictor));
  for (; predictor.at < period; predictor.at++) {
    MpmCritical least = {.closed = NAN};

    PetscCall(LeastLimit(&closed, &least));
    *quiet = fmin(*quiet, least.closed);
  }
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- where growth leaves the tolerance ---- */

/* The problems of a phase. */
typedef struct {
  const MpmPredictor *predictor;
  PetscInt            n;
  MpmCellSymbols      cell[MPM_MAX_DIM];
} Problems;

static PetscErrorCode GrowthOf(void *context, PetscReal courant, PetscReal *growth)
{
  const Problems *p = (const Problems *)context;

  PetscFunctionBegin;
  *growth = 0;
  for (PetscInt i = 0; i < p->n; i++)
    *growth = fmax(*growth, p->predictor->scheme->formulation->corrected(&p->cell[i], courant));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The Courant number at which growth of a phase leaves the tolerance. It is beyond the limit, so where that is no less
   than the least one found so far it is not computed.
*/
static PetscErrorCode ToleratedAt(void *context, const PetscReal beta[], PetscReal *courant)
{
  Closed        *closed = (Closed *)context;
  Problems       p      = {.predictor = closed->predictor};
  MpmSearchSteps steps  = {.to = MPM_CRITICAL_TO, .ratio = 2, .width = INFINITY};
  PetscReal      bracket[2];

  PetscFunctionBegin;
  PetscCall(LimitAt(context, beta, courant));
  if (!(*courant < closed->least)) PetscFunctionReturn(PETSC_SUCCESS);
  p.n        = MpmPredictorSymbols(closed->predictor, beta, p.cell);
  steps.from = PetscMax(2 * *courant, MPM_CRITICAL_FROM);
  PetscCall(MpmSearchFirst(GrowthOf, &p, closed->tolerance, &steps, TOLERATED, bracket));
  *courant      = PetscMin(bracket[1], MPM_CRITICAL_TO);
  closed->least = PetscMin(closed->least, *courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Mostly it is at the limit itself. */
static PetscErrorCode Tolerated(const MpmPredictor *predictor, PetscReal tolerance, const MpmCritical *c,
                                PetscReal beta[], PetscReal *courant)
{
  const MpmZoom zoom   = ClosedZoom(predictor);
  Closed        closed = {
             .predictor = predictor, .of = predictor->scheme->formulation->limit, .tolerance = tolerance, .least = INFINITY};

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(beta, c->closed_beta, zoom.dim));
  PetscCall(ToleratedAt(&closed, beta, courant));
  if (*courant <= c->closed * (1 + BEYOND)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmZoomLeast(&zoom, ToleratedAt, &closed, beta, courant));
  if (*courant >= MPM_CRITICAL_TO) *courant = INFINITY;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The power with which growth fades where every Courant number grows. */
static PetscErrorCode Fading(const MpmPredictor *predictor, MpmCritical *c)
{
  Problems  p = {.predictor = predictor};
  PetscReal whole, half;

  PetscFunctionBegin;
  p.n = MpmPredictorSymbols(predictor, c->beta, p.cell);
  PetscCall(GrowthOf(&p, c->unstable_at, &whole));
  PetscCall(GrowthOf(&p, c->unstable_at / 2, &half));
  c->threshold = PETSC_FALSE;
  c->fading    = log2((whole - 1) / (half - 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the limit at rest: that of the closed form, confirmed by the symbol ---- */

/* The waves of one phase. */
typedef struct {
  MpmWaves         waves;
  const PetscReal *beta;
} Wave;

static PetscErrorCode GrowthOfWave(void *context, PetscReal courant, PetscReal *growth)
{
  Wave *w = (Wave *)context;

  PetscFunctionBegin;
  PetscCall(MpmWavesGrowth(&w->waves, courant, w->beta, growth));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Compares growth by the symbol just below and just above the Courant number at which the closed form leaves the
   tolerance, at the wave where it does. Where growth is slow the two are farther apart. In one dimension the bracket is
   then narrowed down.
*/
static PetscErrorCode ConfirmAbove(const MpmCriticalCase *of, PetscReal courant, MpmCritical *c)
{
  Wave      w = {.beta = c->beta};
  PetscReal growth[2], rounding, bracket[2];

  PetscFunctionBegin;
  c->disputed = PETSC_TRUE;
  PetscCall(MpmWavesCreate(of->layout, of->scheme, of->step.drift, &w.waves));
  PetscCall(MpmWavesRounding(&w.waves, courant, c->beta, NAN, &rounding, NULL));
  for (PetscReal beside = CLOSE; beside <= FAR * (1 + CLOSE) && c->disputed; beside *= 10) {
    c->stable_at   = courant * (1 - beside);
    c->unstable_at = courant * (1 + beside);
    PetscCall(GrowthOfWave(&w, c->stable_at, &growth[0]));
    PetscCall(GrowthOfWave(&w, c->unstable_at, &growth[1]));
    if (growth[0] <= 1 + PetscMax(of->tolerance, rounding) && growth[1] > 1 + of->tolerance) c->disputed = PETSC_FALSE;
  }
  if (of->layout->dim == 1 && !c->disputed && growth[0] > 1 + of->tolerance) {
    c->rounding = rounding;
    c->courant  = NAN;
  } else if (of->layout->dim == 1 && !c->disputed) {
    const MpmSearchSteps steps = {.from = c->stable_at, .to = c->unstable_at, .ratio = 2, .width = INFINITY};

    PetscCall(MpmSearchFirst(GrowthOfWave, &w, of->tolerance, &steps, MPM_CRITICAL_PRECISION, bracket));
    c->stable_at   = bracket[0];
    c->unstable_at = bracket[1];
    if (c->closed > c->stable_at * (1 - BEYOND)) c->courant = c->stable_at;
  }
  c->evaluations += w.waves.evaluations;
  PetscCall(MpmWavesDestroy(&w.waves));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Looks for growth beyond a tolerance at a Courant number, on a grid of phases. */
static PetscErrorCode GrowsAt(const MpmCriticalCase *of, PetscReal courant, PetscReal tolerance, MpmCritical *c,
                              PetscBool *grows)
{
  MpmCriticalCase there   = *of;
  MpmFinding      finding = {0};
  PetscReal       beta[MPM_MAX_DIM];

  PetscFunctionBegin;
  there.step.courant = courant;
  PetscCall(MpmCriticalSampleGrowth(&there, PETSC_FALSE, &finding, beta, &c->evaluations));
  if (tolerance >= of->tolerance) tolerance = PetscMax(tolerance, finding.defective_error);
  *grows = finding.growth > 1 + tolerance ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Below the limit nothing grows at other phases either. Where the limit is below the Courant number at which growth
   leaves the tolerance, long waves beyond it grow by less; in more dimensions the grid is too coarse for them.
*/
static PetscErrorCode ConfirmBelow(const MpmCriticalCase *of, PetscBool alone, MpmCritical *c)
{
  PetscBool grows;

  PetscFunctionBegin;
  if (c->closed == 0) PetscFunctionReturn(PETSC_SUCCESS); /* there is nothing below it */
  if (!alone) {
    PetscCall(GrowsAt(of, PetscMin(c->stable_at, MPM_CRITICAL_TO), of->tolerance, c, &grows));
    if (grows) c->disputed = PETSC_TRUE;
  }
  if (of->layout->dim > 1 || !(c->closed < c->stable_at * (1 - BEYOND))) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GrowsAt(of, isinf(c->stable_at) ? 2 * c->closed : (c->closed + c->stable_at) / 2, GROWS, c, &grows));
  if (!grows) c->disputed = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalConfirmed(const MpmCriticalCase *of, const MpmCriticalStart *start, MpmCritical *c)
{
  MpmPredictor predictor;
  PetscReal    tolerated;

  PetscFunctionBegin;
  PetscCall(MpmPredictorCreate(of->layout, of->scheme, PETSC_FALSE, NULL, &predictor));
  c->order     = of->scheme->table->nstate * MpmLayoutPpc(of->layout);
  c->phases    = of->layout->dim > 1 ? MpmCriticalSamples(of->layout, of->scheme) : 0;
  c->courant   = c->closed;
  c->stable_at = c->unstable_at = INFINITY;
  PetscCall(Tolerated(&predictor, of->tolerance, c, c->beta, &tolerated));
  if (isfinite(tolerated)) PetscCall(ConfirmAbove(of, tolerated, c));
  if (c->closed == 0 && isfinite(tolerated)) PetscCall(Fading(&predictor, c));
  PetscCall(ConfirmBelow(of, start->alone, c));
  if (tolerated < c->closed * (1 - BEYOND)) c->disputed = PETSC_TRUE;
  if (c->disputed) c->courant = NAN;
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}
