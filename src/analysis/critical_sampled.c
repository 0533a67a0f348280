/*
   The largest Courant number with growth within tolerance, by samples of the symbol: in two and three dimensions for
   particles that move and for formulations without a closed form, and at rest in one where growth may stop again.

   In two and three dimensions the limit of waves along an axis is an upper bound. Oblique waves are sampled below it.
*/
#include "analysis/critical_parts.h"
#include "analysis/lone.h"
#include "scene/layout.h"
#include "analysis/waves.h"
#include "symbol/source.h"
#include <math.h>

#define WITHIN 2        /* the largest ratio of growths from which a search goes on */
#define LEAST_BETA 2e-4 /* no waves longer than this */
#define FEWEST 4        /* phases in (0, pi] of each direction, */
#define MOST 16         /* and the largest number of them */
#define WORK 1e10       /* multiplications on one grid of phases that are bearable */
#define FACTORS 100     /* the eigenvalues of a complex matrix of order n take so many times n^3 of them */
#define BELOW 100       /* samples begin at this part of the limit of axis waves, */
#define FROM 1e-2       /* or here where these have none */
#define RATIO 1.3       /* of Courant numbers, one over the other */
#define SCANNED 0.01    /* the same before it is narrowed down */
#define ROUNDS 20       /* of bisection at the phases that grow most, and of the search for these */
#define SAME 1e-6       /* relative distance within which limits are those of axis waves */

/* How a search goes on from the grid, by dimension: from so many places, and its first and last step at one wave. */
static const PetscInt  starts[] = {0, 6, 6, 3};
static const PetscReal finest[] = {0, 1e-3, 1e-3, 0.1}, last_step[] = {0, 1e-7, 1e-4, 1e-4};
#define FIRST_STEP 0.02

/* The relative width of a bracket. */
static const PetscReal precision[] = {0, MPM_CRITICAL_PRECISION, 1e-7, 1e-7};

/* ---- waves along an axis, which are those of one dimension with that direction's drift ---- */

/*
   The space of waves along an axis, of one dimension. Returns the speed of P waves along it in units of c: with a
   prestress it depends on the direction (docs/theory.md, section 9).
*/
static PetscReal AlongAxis(const MpmSpace *of, PetscInt axis, MpmSpace *along)
{
  const PetscReal sigma0 = MpmSpacePrestress(of, axis, axis);
  PetscReal       square = 1;

  *along     = *of;
  along->dim = 1;
  if (!MpmSpaceIsPrestressed(of)) return 1;
  square = MpmSpaceTangent(of, axis, axis, axis, axis) - sigma0;
  for (PetscInt c = 0; c < MPM_MAX_STRESS; c++) along->prestress[c] = 0;
  along->prestress[0] = sigma0 / square;
  along->displaced    = sigma0 != 0 && of->curved ? PETSC_TRUE : PETSC_FALSE;
  return sqrt(square);
}

/* Finds the limit of the waves along one axis. */
static PetscErrorCode LimitOfAxis(const MpmCriticalCase *of, MpmCriticalFinder find, PetscInt axis, MpmCritical *c)
{
  MpmLayout       layout = *of->layout;
  MpmScheme       scheme = *of->scheme;
  MpmCriticalCase along  = *of;
  PetscReal       speed;

  PetscFunctionBegin;
  layout.dim       = 1;
  layout.grid[0]   = layout.grid[axis];
  layout.offset[0] = layout.offset[axis];
  MpmLayoutSetPpc(&layout, layout.ppc[axis]);
  speed = AlongAxis(&of->scheme->space, axis, &scheme.space);
  PetscCall(MpmTableCreate(scheme.formulation, scheme.transfer, &scheme.numbers, &scheme.space, &scheme.table));
  along.layout = &layout;
  along.scheme = &scheme;
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) along.step.drift[a] = (MpmFraction){.den = 1};
  along.step.drift[0] = of->step.drift[axis];
  along.step.courant *= speed;
  PetscCall(find(&along, PETSC_TRUE, c));
  c->stable_at /= speed;
  c->unstable_at /= speed;
  c->courant /= speed;
  c->doubtful /= speed;
  PetscCall(MpmTableDestroy(&scheme.table));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalAxes(const MpmCriticalCase *of, MpmCriticalFinder find, MpmCritical *least)
{
  PetscBool mirror[MPM_MAX_DIM];
  PetscInt  alike[MPM_MAX_DIM];

  PetscFunctionBegin;
  MpmPhasesSymmetries(of->layout, &of->scheme->space, of->step.drift, mirror, alike);
  *least = (MpmCritical){.stable_at = INFINITY, .unstable_at = INFINITY, .courant = INFINITY, .fading = NAN};
  for (PetscInt axis = 0; axis < of->layout->dim; axis++) {
    MpmCritical c;

    if (alike[axis] < axis) continue; /* it has the same waves as one before it */
    PetscCall(LimitOfAxis(of, find, axis, &c));
    least->evaluations += c.evaluations;
    if (!(c.unstable_at < least->unstable_at)) continue;
    c.evaluations = least->evaluations;
    *least        = c;
    for (PetscInt a = 0; a < MPM_MAX_DIM; a++) least->beta[a] = 0;
    least->beta[axis] = c.beta[0];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- samples ---- */

/* The symbol as a function of Courant number and phases. beta: the phases of the largest growth found last. */
typedef struct {
  const MpmCriticalCase *of;
  MpmWaves               waves;
  MpmZoom                zoom;
  PetscReal              courant, beta[MPM_MAX_DIM];
  const MpmCritical     *axes; /* the limit of axis waves */
} Samples;

static PetscErrorCode SamplesCreate(const MpmCriticalCase *of, Samples *s)
{
  PetscFunctionBegin;
  *s = (Samples){.of = of};
  PetscCall(MpmWavesCreate(of->layout, of->scheme, of->step.drift, &s->waves));
  s->zoom        = MpmZoomOf(of->layout, &of->scheme->space, of->step.drift);
  s->zoom.points = MpmCriticalSamples(of->layout, of->scheme);
  s->zoom.starts = starts[of->layout->dim];
  s->zoom.within = WITHIN;
  s->zoom.finest = finest[of->layout->dim];
  s->zoom.least  = LEAST_BETA;
  s->zoom.comm   = PETSC_COMM_WORLD;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt MpmCriticalSamples(const MpmLayout *layout, const MpmScheme *scheme)
{
  const PetscReal order = (PetscReal)scheme->table->nstate * MpmLayoutPpc(layout),
                  each  = FACTORS * order * order * order;
  PetscInt n            = MOST;

  if (layout->dim == 1) return MPM_CRITICAL_PHASES;
  while (n > FEWEST && pow(2.0 * n, (PetscReal)layout->dim) / 2 * each > WORK) n--;
  return n;
}

/* The zoom looks for the least of a positive number. */
static PetscErrorCode Inverse(void *context, const PetscReal beta[], PetscReal *value)
{
  Samples  *s = (Samples *)context;
  PetscReal growth;

  PetscFunctionBegin;
  PetscCall(MpmWavesGrowth(&s->waves, s->courant, beta, &growth));
  *value = 1 / growth;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest growth of all phases at a Courant number. Where it is beyond tolerance its phases are kept. */
static PetscErrorCode GrowthOfAll(void *context, PetscReal courant, PetscReal *growth)
{
  Samples  *s = (Samples *)context;
  PetscReal beta[MPM_MAX_DIM], value;

  PetscFunctionBegin;
  s->courant = courant;
  PetscCall(MpmZoomLeast(&s->zoom, Inverse, s, beta, &value));
  *growth = 1 / value;
  if (*growth > 1 + s->of->tolerance) PetscCall(PetscArraycpy(s->beta, beta, s->zoom.dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Growth at the phases that are kept. */
static PetscErrorCode GrowthThere(void *context, PetscReal courant, PetscReal *growth)
{
  Samples *s = (Samples *)context;

  PetscFunctionBegin;
  PetscCall(MpmWavesGrowth(&s->waves, courant, s->beta, growth));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Narrows a bracket down to the limit of the wave that is kept and of those beside it: by turns the limit of a wave,
   and the wave that grows most there. Every rank does this.
*/
static PetscErrorCode Narrow(Samples *s, PetscReal bracket[2])
{
  MpmZoom zoom = s->zoom;

  PetscFunctionBegin;
  zoom.finest = last_step[zoom.dim];
  for (int round = 0; round < ROUNDS; round++) {
    const PetscReal      before = bracket[1];
    const MpmSearchSteps steps  = {
         .from = bracket[0] > 0 ? bracket[0] : bracket[1], .to = bracket[1], .ratio = 2, .width = MPM_CRITICAL_TO};
    PetscReal value;

    PetscCall(MpmSearchFirst(GrowthThere, s, s->of->tolerance, &steps, precision[zoom.dim], bracket));
    if (round > 0 && !(bracket[1] < before * (1 - precision[zoom.dim]))) break;
    s->courant = bracket[1];
    PetscCall(Inverse(s, s->beta, &value));
    PetscCall(MpmZoomFrom(&zoom, Inverse, s, FIRST_STEP, s->beta, &value));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the search ---- */

/* Takes over the limit of axis waves, if the symbol of all dimensions has them grow there too. */
static PetscErrorCode TakeAxes(Samples *s, const MpmCritical *axes, MpmCritical *c)
{
  PetscReal growth;

  PetscFunctionBegin;
  c->stable_at   = axes->stable_at;
  c->unstable_at = axes->unstable_at;
  c->threshold   = axes->threshold;
  c->fading      = axes->fading;
  c->doubtful    = axes->doubtful;
  PetscCall(PetscArraycpy(c->beta, axes->beta, MPM_MAX_DIM));
  PetscCall(MpmWavesGrowth(&s->waves, c->unstable_at * (1 + SAME), c->beta, &growth));
  if (growth <= 1 + s->of->tolerance / 2) c->disputed = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The largest growth of samples and of axis waves, as far as their windows and their limit tell. Beyond that limit
   samples are not looked at.
*/
static PetscErrorCode GrowthWithAxes(void *context, PetscReal courant, PetscReal *growth)
{
  Samples           *s    = (Samples *)context;
  const MpmCritical *axes = s->axes;

  PetscFunctionBegin;
  *growth = INFINITY;
  if (courant >= axes->unstable_at) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GrowthOfAll(s, courant, growth));
  for (PetscInt i = 0; i < axes->windows.n; i++) {
    const MpmCriticalWindow *w = &axes->windows.window[i];

    if (courant >= w->from && courant <= w->to) *growth = PetscMax(*growth, w->growth);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the first Courant number at which a sample grows, up to the limit of axis waves, above windows of growth. */
static PetscErrorCode ScanSamples(Samples *s, MpmCritical *c, PetscReal bracket[2])
{
  PetscReal growth;

  PetscFunctionBegin;
  PetscCall(MpmSearchScan(GrowthWithAxes, s, s->of->tolerance, s->of->step.courant, SCANNED, c));
  bracket[0] = c->stable_at;
  bracket[1] = PetscMin(c->unstable_at, s->axes->unstable_at);
  if (isinf(bracket[1])) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GrowthOfAll(s, bracket[1], &growth));
  if (growth <= 1 + s->of->tolerance) bracket[1] = INFINITY;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the first Courant number at which a sample grows, up to the limit of axis waves. */
static PetscErrorCode FindSample(Samples *s, const MpmCritical *axes, PetscReal bracket[2])
{
  MpmSearchSteps steps = {.from = FROM, .to = MPM_CRITICAL_TO, .ratio = RATIO, .width = MPM_CRITICAL_TO};

  PetscFunctionBegin;
  if (isfinite(axes->unstable_at)) {
    steps.to   = axes->unstable_at;
    steps.from = axes->unstable_at / BELOW;
  }
  PetscCall(MpmSearchFirst(GrowthOfAll, s, s->of->tolerance, &steps, 1, bracket));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Leaves out the windows that are not below the limit, which refining has moved down. */
static void KeepBelow(MpmCritical *c)
{
  while (c->windows.n && c->windows.window[c->windows.n - 1].to > c->stable_at) c->windows.n--;
}

static PetscErrorCode Search(Samples *s, const MpmCriticalStart *start, MpmCritical *c)
{
  const MpmCritical *axes       = s->axes;
  PetscReal          bracket[2] = {0, start->unstable};

  PetscFunctionBegin;
  if (isfinite(start->unstable))
    PetscCall(PetscArraycpy(s->beta, start->beta, s->zoom.dim));
  else if (MpmStepDrifts(&s->of->step) || MpmLeftmostDecides(s->of->layout, s->of->scheme, &s->of->step))
    PetscCall(FindSample(s, axes, bracket));
  else
    PetscCall(ScanSamples(s, c, bracket));
  if (isfinite(bracket[1])) PetscCall(Narrow(s, bracket));
  c->stable_at   = isfinite(bracket[1]) ? bracket[0] : INFINITY;
  c->unstable_at = bracket[1];
  if (isfinite(axes->unstable_at) && !(bracket[1] < axes->unstable_at * (1 - SAME)))
    PetscCall(TakeAxes(s, axes, c));
  else if (isfinite(bracket[1])) {
    PetscCall(PetscArraycpy(c->beta, s->beta, s->zoom.dim));
    if (!c->windows.n) PetscCall(MpmSearchThreshold(GrowthThere, s, s->of->tolerance, 0, c));
  }
  KeepBelow(c);
  c->courant = c->threshold || MpmStepDrifts(&s->of->step) ? c->stable_at : 0;
  if (c->disputed) c->courant = NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalSampled(const MpmCriticalCase *of, const MpmCriticalStart *start, MpmCritical *c)
{
  Samples samples;

  PetscFunctionBegin;
  PetscCall(SamplesCreate(of, &samples));
  samples.axes = start->axes;
  c->order     = samples.waves.bloch.size;
  c->phases    = of->layout->dim > 1 ? samples.zoom.points : 0;
  PetscCall(Search(&samples, start, c));
  c->evaluations += samples.waves.evaluations;
  PetscCall(MpmWavesDestroy(&samples.waves));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalSampleGrowth(const MpmCriticalCase *of, PetscBool uphill, MpmFinding *finding,
                                       PetscReal beta[], PetscInt64 *evaluations)
{
  Samples   s;
  PetscReal value;

  PetscFunctionBegin;
  PetscCall(SamplesCreate(of, &s));
  s.courant = of->step.courant;
  if (!uphill) s.zoom.starts = 1;
  if (!uphill) s.zoom.finest = PETSC_PI;
  PetscCall(MpmZoomLeast(&s.zoom, Inverse, &s, beta, &value));
  finding->tolerance = of->tolerance;
  finding->growth    = 1 / value;
  PetscCall(MpmWavesRounding(&s.waves, of->step.courant, beta, NAN, &finding->defective_error, NULL));
  finding->uncertainty = finding->defective_error;
  finding->verdict     = MpmVerdictOf(finding);
  PetscCall(PetscSNPrintf(finding->evidence, sizeof finding->evidence,
                          "the symbol at %" PetscInt_FMT " phases in (0, pi] of each direction%s", s.zoom.points,
                          uphill ? ", and uphill from the largest growths" : ""));
  *evaluations += s.waves.evaluations;
  PetscCall(MpmWavesDestroy(&s.waves));
  PetscFunctionReturn(PETSC_SUCCESS);
}
