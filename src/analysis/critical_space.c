/*
   The largest stable Courant number in two and three dimensions, on uniform layouts: at rest by the closed form, which
   is then confirmed by the symbol.
*/
#include "analysis/critical_parts.h"
#include "symbol/predict.h"
#include <mpmstab/symbol.h>
#include <math.h>

#define PLANE_POINTS 48 /* phases in (0, pi] of each direction with which the search by closed forms begins */
#define SPACE_POINTS 16
#define WEDGE_POINTS 24 /* the same in three dimensions where they are all alike */
#define WITHIN 1.25     /* the search goes on from limits on this grid that are within this factor of the least */
#define FINEST 1e-8     /* last step in beta */
#define LEAST_BETA 2e-4 /* no waves longer than this: closed forms cancel there */
#define LONG 1e-3       /* phases below this are of long waves; */
#define FALLS 0.9       /* where their limit at twice the length is smaller by this factor it goes to 0 */
#define BISECTIONS 40
#define BEYOND 1e-5 /* relative distance from the limit within which growth should leave the tolerance */
#define CLOSE 1e-6  /* relative distance from the limit at which the symbol is looked at, */
#define FAR 1e-2    /* and the largest, where growth begins slowly */
#define GROWS 1e-12 /* smallest growth of one phase that is no rounding */

const char *const MpmWaveTypeNames[] = {"", "P", "S", "mixed", "MpmWaveType", "MPM_WAVE_", NULL};

MpmZoom MpmCriticalZoom(const MpmLayout *layout, const MpmSpace *space, const MpmFraction drift[])
{
  MpmZoom zoom = {.dim = layout->dim};

  for (PetscInt a = 0; a < layout->dim; a++) {
    zoom.mirror[a] =
        layout->offset[a].value == 0.5 && drift[a].value == 0 && MpmSpaceMirrors(space, a) ? PETSC_TRUE : PETSC_FALSE;
    zoom.alike[a] = a;
    for (PetscInt b = a - 1; b >= 0; b--)
      if (layout->ppc[a] == layout->ppc[b] && layout->offset[a].value == layout->offset[b].value &&
          drift[a].value == drift[b].value && MpmSpaceAlike(space, a, b))
        zoom.alike[a] = b;
  }
  return zoom;
}

/* ---- the closed form ---- */

/* A closed form as a function of the phases. least: the least limit with growth beyond the tolerance so far. */
typedef struct {
  const MpmPredictor *predictor;
  PetscReal           tolerance, least;
} Closed;

static MpmZoom ClosedZoom(const MpmPredictor *predictor)
{
  const MpmFraction rest[MPM_MAX_DIM] = {{.den = 1}, {.den = 1}, {.den = 1}};
  const MpmLayout  *layout            = predictor->layout;
  MpmZoom           zoom              = MpmCriticalZoom(layout, &predictor->scheme->space, rest);

  zoom.points = layout->dim == 2                                             ? PLANE_POINTS
                : zoom.alike[1] == 0 && zoom.alike[2] == 0 && zoom.mirror[0] ? WEDGE_POINTS
                                                                             : SPACE_POINTS;
  zoom.starts = MPM_ZOOM_STARTS;
  zoom.within = WITHIN;
  zoom.finest = FINEST;
  zoom.least  = LEAST_BETA;
  zoom.comm   = PETSC_COMM_SELF;
  return zoom;
}

/* The least limit of the problems of a phase. */
static PetscErrorCode LimitAt(void *context, const PetscReal beta[], PetscReal *limit)
{
  const Closed         *closed = (const Closed *)context;
  const MpmFormulation *f      = closed->predictor->scheme->formulation;
  MpmCellSymbols        cell[MPM_MAX_DIM];
  const PetscInt        n = MpmPredictorSymbols(closed->predictor, beta, cell);

  PetscFunctionBegin;
  *limit = INFINITY;
  for (PetscInt i = 0; i < n; i++) *limit = fmin(*limit, f->limit(&cell[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The limits of long waves may go to 0 with beta (gas1 with xpic). Then the least one is 0, and at no phase. */
PetscErrorCode MpmCriticalClosedInSpace(const MpmPredictor *predictor, MpmCritical *c)
{
  const MpmZoom zoom    = ClosedZoom(predictor);
  Closed        closed  = {.predictor = predictor};
  PetscReal     largest = 0, beta[MPM_MAX_DIM], shorter;

  PetscFunctionBegin;
  PetscCall(MpmZoomLeast(&zoom, LimitAt, &closed, c->closed_beta, &c->closed));
  for (PetscInt a = 0; a < zoom.dim; a++) {
    largest = PetscMax(largest, PetscAbsReal(c->closed_beta[a]));
    beta[a] = 2 * c->closed_beta[a];
  }
  if (!(largest < LONG)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(LimitAt(&closed, beta, &shorter));
  if (c->closed < FALLS * shorter) c->closed = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal GrowthOf(const MpmPredictor *p, PetscReal courant, PetscInt n, const MpmCellSymbols cell[])
{
  PetscReal growth = 0;

  for (PetscInt i = 0; i < n; i++) growth = fmax(growth, p->scheme->formulation->corrected(&cell[i], courant));
  return growth;
}

/*
   The Courant number at which growth of a phase leaves the tolerance, by bisection. It is beyond the limit, so where
   that is no less than the least one found so far it is not computed.
*/
static PetscErrorCode ToleratedAt(void *context, const PetscReal beta[], PetscReal *courant)
{
  Closed        *closed = (Closed *)context;
  MpmCellSymbols cell[MPM_MAX_DIM];
  const PetscInt n = MpmPredictorSymbols(closed->predictor, beta, cell);
  PetscReal      bracket[2];

  PetscFunctionBegin;
  PetscCall(LimitAt(context, beta, courant));
  if (!(*courant < closed->least)) PetscFunctionReturn(PETSC_SUCCESS);
  bracket[0] = *courant;
  bracket[1] = PetscMax(2 * bracket[0], MPM_CRITICAL_FROM);
  while (bracket[1] < MPM_CRITICAL_TO && GrowthOf(closed->predictor, bracket[1], n, cell) <= 1 + closed->tolerance)
    bracket[1] *= 2;
  for (int i = 0; i < BISECTIONS; i++) {
    const PetscReal middle = (bracket[0] + bracket[1]) / 2;

    bracket[GrowthOf(closed->predictor, middle, n, cell) <= 1 + closed->tolerance ? 0 : 1] = middle;
  }
  *courant      = bracket[1];
  closed->least = PetscMin(closed->least, *courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds where growth leaves the tolerance, and at which phases. Mostly it is at the limit itself. */
static PetscErrorCode FindTolerated(const MpmPredictor *predictor, PetscReal tolerance, const MpmCritical *c,
                                    PetscReal beta[], PetscReal *courant)
{
  const MpmZoom zoom   = ClosedZoom(predictor);
  Closed        closed = {.predictor = predictor, .tolerance = tolerance, .least = INFINITY};

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(beta, c->closed_beta, zoom.dim));
  PetscCall(ToleratedAt(&closed, beta, courant));
  if (*courant <= c->closed * (1 + BEYOND)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmZoomLeast(&zoom, ToleratedAt, &closed, beta, courant));
  if (*courant >= MPM_CRITICAL_TO) *courant = INFINITY;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- with the symbol ---- */

/*
   Compares growth by the symbol just below and just above the Courant number at which the closed form leaves the
   tolerance, at the wave where it does. Where growth is slow the two are farther apart.
*/
static PetscErrorCode ConfirmAbove(const MpmCriticalCase *of, PetscReal courant, MpmCritical *c)
{
  PetscReal growth[2], rounding;

  PetscFunctionBegin;
  c->disputed = PETSC_TRUE;
  PetscCall(MpmCriticalRounding(of, courant, c->beta, &rounding));
  for (PetscReal beside = CLOSE; beside <= FAR * (1 + CLOSE) && c->disputed; beside *= 10) {
    c->stable_at   = courant * (1 - beside);
    c->unstable_at = courant * (1 + beside);
    PetscCall(MpmCriticalGrowthOfPhase(of, c->stable_at, c->beta, &growth[0]));
    PetscCall(MpmCriticalGrowthOfPhase(of, c->unstable_at, c->beta, &growth[1]));
    c->evaluations += 2;
    if (growth[0] <= 1 + PetscMax(of->tolerance, rounding) && growth[1] > 1 + of->tolerance) c->disputed = PETSC_FALSE;
  }
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

/* The power with which growth fades where every Courant number grows. */
static PetscErrorCode FindFading(const MpmPredictor *predictor, MpmCritical *c)
{
  MpmCellSymbols cell[MPM_MAX_DIM];
  const PetscInt n = MpmPredictorSymbols(predictor, c->beta, cell);

  PetscFunctionBegin;
  c->threshold = PETSC_FALSE;
  c->fading =
      log2((GrowthOf(predictor, c->unstable_at, n, cell) - 1) / (GrowthOf(predictor, c->unstable_at / 2, n, cell) - 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The limit by the closed form, confirmed by the symbol; alone: at the wave that limits only. */
static PetscErrorCode AtRest(const MpmCriticalCase *of, PetscBool alone, MpmCritical *c)
{
  MpmPredictor predictor;
  PetscReal    tolerated;

  PetscFunctionBegin;
  PetscCall(MpmPredictorCreate(of->layout, of->scheme, PETSC_FALSE, &predictor));
  c->order     = of->scheme->table->nstate * MpmLayoutPpc(of->layout);
  c->phases    = MpmCriticalSamples(of->layout, of->scheme);
  c->courant   = c->closed;
  c->stable_at = c->unstable_at = INFINITY;
  PetscCall(FindTolerated(&predictor, of->tolerance, c, c->beta, &tolerated));
  if (isfinite(tolerated)) PetscCall(ConfirmAbove(of, tolerated, c));
  if (!alone) PetscCall(ConfirmBelow(of, c));
  if (c->closed == 0 && isfinite(tolerated)) PetscCall(FindFading(&predictor, c));
  if (c->disputed) c->courant = NAN;
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Growth and verdict at the case's own Courant number: of samples, and of the wave that limits it. */
static PetscErrorCode Ask(const MpmCriticalCase *of, MpmCritical *c, PetscReal beta[])
{
  MpmFinding *asked = &c->asked;
  PetscReal   growth;

  PetscFunctionBegin;
  PetscCall(MpmCriticalSampleGrowth(of, isnan(c->closed) ? PETSC_TRUE : PETSC_FALSE, asked, beta, &c->evaluations));
  if (isnan(c->beta[0])) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmCriticalGrowthOfPhase(of, of->step.courant, c->beta, &growth));
  if (!(growth > asked->growth)) PetscFunctionReturn(PETSC_SUCCESS);
  asked->growth = growth;
  PetscCall(PetscArraycpy(beta, c->beta, of->layout->dim));
  asked->verdict = MpmVerdictOf(asked);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes growth with a small drift, along x and along the diagonal. */
static PetscErrorCode WhenMoving(const MpmCriticalCase *of, MpmCritical *c)
{
  MpmCriticalCase moving  = *of;
  MpmFinding      finding = {0};
  PetscReal       beta[MPM_MAX_DIM];

  PetscFunctionBegin;
  moving.step.drift[0] = (MpmFraction){.num = 1, .den = MPM_CRITICAL_DRIFT, .value = 1.0 / MPM_CRITICAL_DRIFT};
  PetscCall(MpmCriticalSampleGrowth(&moving, PETSC_TRUE, &finding, beta, &c->evaluations));
  c->moving = finding.growth;
  for (PetscInt a = 1; a < of->layout->dim; a++) moving.step.drift[a] = moving.step.drift[0];
  PetscCall(MpmCriticalSampleGrowth(&moving, PETSC_TRUE, &finding, beta, &c->evaluations));
  c->moving_diagonal = finding.growth;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalInSpace(const MpmCriticalCase *of, PetscBool alone, MpmCritical *c)
{
  const PetscBool drifts  = MpmStepDrifts(&of->step);
  const PetscBool sampled = drifts || isnan(c->closed) ? PETSC_TRUE : PETSC_FALSE;
  PetscReal       beta[MPM_MAX_DIM];

  PetscFunctionBegin;
  if (sampled)
    PetscCall(MpmCriticalBySamples(of, INFINITY, NULL, c));
  else
    PetscCall(AtRest(of, alone, c));
  if (!alone) {
    PetscCall(Ask(of, c, beta));
    if (sampled && c->asked.verdict == MPM_UNSTABLE && of->step.courant < c->stable_at &&
        !MpmCriticalHasWindowAt(c, of->step.courant))
      PetscCall(MpmCriticalBySamples(of, of->step.courant, beta, c));
    if (!drifts) PetscCall(WhenMoving(of, c));
  }
  if (isfinite(c->unstable_at)) PetscCall(MpmCriticalPolarise(of, c->unstable_at * (1 + BEYOND), c->beta, &c->wave));
  PetscFunctionReturn(PETSC_SUCCESS);
}
