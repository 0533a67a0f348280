/*
   The largest stable Courant number: chooses how it is sought, and checks what was found. Files: critical_line.c for
   one dimension, critical_sampled.c for samples of the symbol, critical_assembled.c for what has no symbol,
   critical_closed.c for the closed form.
*/
#include "analysis/critical_parts.h"
#include "analysis/lone.h"
#include "analysis/modes.h"
#include "analysis/waves.h"
#include "base/progress.h"
#include <mpmstab/errors.h>
#include <mpmstab/symbol.h>
#include <math.h>

#define AGREE 1e-5        /* relative difference of closed form and search */
#define BEYOND 0.01       /* relative distance above the limit at which growth is compared with that of rounding */
#define BEYOND_LIMIT 1e-5 /* the same at which the type of a wave is looked at */
#define GROWS 1e-12       /* smallest growth of one phase that is no rounding */
#define NEARLY 0.9        /* modes whose growth is at least this part of the largest count as equally fast */
#define STILL 1e-9        /* a mode whose nodal vector is smaller than this part of it does not move the nodes */

const char *const MpmWaveTypeNames[] = {"", "P", "S", "mixed", "MpmWaveType", "MPM_WAVE_", NULL};

/*S
   Strategy - how the limit of a case is sought. It is the first whose conditions hold, each of which may be ANY.

   symbol, line, drifts, closed - the layout has a symbol, of one dimension, particles move, there is a closed form
   theorem     - the theorem of docs/theory.md, section 5, says that what has become unstable stays so
   find        - finds it
   axes        - the limit of waves along the axes is found before
   again       - where that Courant number grows below the limit found, the search has missed the true limit, and goes
                 on down from there
S*/
#define ANY -1
typedef struct {
  int               symbol, line, drifts, closed, theorem;
  MpmCriticalSearch find;
  PetscBool         axes, again;
} Strategy;

/*
   The conditions of a closed form of a phase are linear in the square of the Courant number: what is unstable stays so.
*/
static const Strategy strategies[] = {
    {0, ANY, ANY, ANY, ANY, MpmCriticalAssembled, PETSC_FALSE, PETSC_FALSE},
    {1, 1, 1, ANY, ANY, MpmCriticalLineUnderDrift, PETSC_FALSE, PETSC_TRUE},
    {1, 1, 0, 1, ANY, MpmCriticalLineAtRest, PETSC_FALSE, PETSC_TRUE},
    {1, 1, 0, 0, 1, MpmCriticalLineAtRest, PETSC_FALSE, PETSC_TRUE},
    {1, 1, 0, 0, 0, MpmCriticalSampled, PETSC_FALSE, PETSC_TRUE},
    {1, 0, 0, 1, ANY, MpmCriticalSpaceAtRest, PETSC_FALSE, PETSC_FALSE},
    {1, 0, ANY, ANY, ANY, MpmCriticalSampled, PETSC_TRUE, PETSC_TRUE},
};

static PetscBool Fits(int condition, PetscBool is)
{
  return condition == ANY || condition == (is ? 1 : 0) ? PETSC_TRUE : PETSC_FALSE;
}

static const Strategy *StrategyOf(const MpmCriticalCase *of, const MpmCritical *c)
{
  const Strategy *s      = strategies;
  const PetscBool symbol = MpmSymbolWhyNot(of->layout) ? PETSC_FALSE : PETSC_TRUE;
  const PetscBool line = of->layout->dim == 1 ? PETSC_TRUE : PETSC_FALSE, drifts = MpmStepDrifts(&of->step);
  const PetscBool closed  = isnan(c->closed) ? PETSC_FALSE : PETSC_TRUE;
  const PetscBool theorem = MpmLeftmostDecides(of->layout, of->scheme, &of->step);

  while (!Fits(s->symbol, symbol) || !Fits(s->line, line) || !Fits(s->drifts, drifts) || !Fits(s->closed, closed) ||
         !Fits(s->theorem, theorem))
    s++;
  return s;
}

/* ---- growth at one Courant number ---- */

/* Growth and verdict at the case's own Courant number, and the phases that grow most. */
static PetscErrorCode GrowthAt(const MpmCriticalCase *of, PetscBool uphill, MpmFinding *finding, PetscReal beta[],
                               PetscInt64 *evaluations)
{
  PetscFunctionBegin;
  if (of->layout->dim == 1)
    PetscCall(MpmCriticalLineGrowth(of, finding, beta));
  else
    PetscCall(MpmCriticalSampleGrowth(of, uphill, finding, beta, evaluations));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same for a search. In two and three dimensions samples may have less growth than the wave that limits. */
static PetscErrorCode Ask(const MpmCriticalCase *of, MpmCritical *c, PetscReal beta[])
{
  MpmFinding *asked = &c->asked;
  MpmWaves    waves;
  PetscReal   growth;

  PetscFunctionBegin;
  PetscCall(GrowthAt(of, isnan(c->closed) ? PETSC_TRUE : PETSC_FALSE, asked, beta, &c->evaluations));
  if (of->layout->dim == 1 || isnan(c->beta[0])) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmWavesCreate(of->layout, of->scheme, of->step.drift, &waves));
  PetscCall(MpmWavesGrowth(&waves, of->step.courant, c->beta, &growth));
  PetscCall(MpmWavesDestroy(&waves));
  if (!(growth > asked->growth)) PetscFunctionReturn(PETSC_SUCCESS);
  asked->growth = growth;
  PetscCall(PetscArraycpy(beta, c->beta, of->layout->dim));
  asked->verdict = MpmVerdictOf(asked);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A limit of particles at rest says nothing about moving ones. */
PetscErrorCode MpmCriticalMoving(const MpmCriticalCase *of, PetscReal courant, PetscReal growth[2],
                                 PetscInt64 *evaluations)
{
  MpmCriticalCase moving  = *of;
  MpmFinding      finding = {0};
  PetscReal       beta[MPM_MAX_DIM];

  PetscFunctionBegin;
  moving.step.courant  = courant;
  moving.step.drift[0] = (MpmFraction){.num = 1, .den = MPM_CRITICAL_DRIFT, .value = 1.0 / MPM_CRITICAL_DRIFT};
  PetscCall(GrowthAt(&moving, PETSC_TRUE, &finding, beta, evaluations));
  growth[0] = finding.growth;
  growth[1] = NAN;
  if (of->layout->dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 1; a < of->layout->dim; a++) moving.step.drift[a] = moving.step.drift[0];
  PetscCall(GrowthAt(&moving, PETSC_TRUE, &finding, beta, evaluations));
  growth[1] = finding.growth;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- checks ---- */

/*
   Where rounding makes more growth than the tolerance, and growth above the limit is not larger than that, the limit is
   not known.
*/
static PetscErrorCode CheckRounding(const MpmCriticalCase *of, MpmCritical *c)
{
  MpmWaves  waves;
  PetscReal growth;

  PetscFunctionBegin;
  if (c->assembled || isinf(c->unstable_at)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmWavesCreate(of->layout, of->scheme, of->step.drift, &waves));
  PetscCall(MpmWavesRounding(&waves, c->unstable_at, c->beta, NAN, &c->rounding, NULL));
  if (c->rounding > of->tolerance) {
    PetscCall(MpmWavesGrowth(&waves, c->unstable_at * (1 + BEYOND), c->beta, &growth));
    if (growth <= 1 + c->rounding) c->courant = NAN;
  }
  PetscCall(MpmWavesDestroy(&waves));
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
  MpmWaves     waves;
  PetscReal    growth;

  PetscFunctionBegin;
  *grows = PETSC_FALSE;
  PetscCall(MpmWavesCreate(of->layout, of->scheme, of->step.drift, &waves));
  PetscCall(MpmPredictorCreate(of->layout, of->scheme, MpmStepDrifts(&of->step), NULL, &predictor));
  for (PetscInt m = MPM_CRITICAL_PHASES; m > 0 && !*grows; m--) {
    const PetscReal beta = MpmSearchPhase(m);

    if (MpmCriticalClosedLimit(&predictor, &beta) >= courant) continue;
    PetscCall(MpmWavesGrowth(&waves, courant, &beta, &growth));
    *grows = growth > 1 + GROWS ? PETSC_TRUE : PETSC_FALSE;
  }
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscCall(MpmWavesDestroy(&waves));
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

/* ---- what particles do in the modes that limit: P waves, S waves or both ---- */

/* What an operation sends of a mode to its node. */
static double complex Sent(const MpmBloch *b, const MpmOp *op, const double complex mode[])
{
  double complex sum = 0;

  for (PetscInt j = 0; j < b->ppc; j++) sum += conj(MpmBlochTie(b, op, j, NULL)) * mode[b->fields * j + op->src];
  return sum;
}

/* A component of a mode's nodal vector: P2G of the particles', with that of the affine part. */
static double complex NodalComponent(const MpmBloch *b, PetscInt particle, const double complex mode[])
{
  const MpmTable *table = b->scheme->table;
  const MpmOp    *first = MpmTableSeenBy(table, particle);
  double complex  sum   = Sent(b, first, mode);

  for (const MpmOp *op = first + 1; op < table->ops + table->nops && op->kind == MPM_P2G_AFFINE; op++)
    if (op->dst == first->dst) sum += Sent(b, op, mode);
  return sum;
}

/* The share along beta of a mode's nodal vector; NaN for a mode that does not move the nodes. */
static PetscReal ShareAlong(const MpmBloch *b, const double complex mode[], PetscInt vector, const PetscReal beta[])
{
  double complex along = 0;
  PetscReal      all = 0, length = 0, size = 0;

  for (PetscInt a = 0; a < b->layout->dim; a++) {
    const double complex node = NodalComponent(b, vector + a, mode);

    along += beta[a] * node;
    all += PetscSqr(cabs(node));
    length += PetscSqr(beta[a]);
  }
  for (PetscInt i = 0; i < b->size; i++) size += PetscSqr(cabs(mode[i]));
  return all > PetscSqr(STILL) * size ? PetscSqr(cabs(along)) / (all * length) : NAN;
}

/* What particles do in the modes of a phase that grow most at a Courant number. */
static PetscErrorCode Polarise(const MpmCriticalCase *of, PetscReal courant, const PetscReal beta[], MpmWaveType *wave)
{
  const PetscInt vector  = MpmModesVectorOf(of->scheme);
  PetscReal      largest = 0, least = 1, most = 0, excess;
  PetscInt       exponent;
  MpmBloch       bloch;
  MpmSmallEigen  whole;

  PetscFunctionBegin;
  *wave = MPM_WAVE_NONE;
  if (vector == MPM_NONE) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmBlochCreate(of->layout, of->scheme, of->step.drift, &bloch));
  PetscCall(MpmSmallEigenCreate(bloch.size, &whole));
  PetscCall(MpmBlochMatrices(&bloch, 1, &courant, beta, PETSC_FALSE, whole.matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(&whole, PETSC_TRUE));
  MpmBlochSetStep(&bloch, 0);
  for (PetscInt i = 0; i < whole.n; i++) largest = fmax(largest, cabs(whole.value[i]));
  excess = log(largest) + (PetscReal)exponent * M_LN2;
  for (PetscInt i = 0; i < whole.n; i++) {
    const PetscReal share = ShareAlong(&bloch, whole.right + whole.n * i, vector, beta);

    if (log(cabs(whole.value[i])) + (PetscReal)exponent * M_LN2 < NEARLY * excess || isnan(share)) continue;
    least = PetscMin(least, share);
    most  = PetscMax(most, share);
  }
  if (excess > 0 && most >= least) *wave = MpmCriticalWaveOf(least, most);
  PetscCall(MpmSmallEigenDestroy(&whole));
  PetscCall(MpmBlochDestroy(&bloch));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- all of it ---- */

static MpmCritical Nothing(PetscReal tolerance)
{
  MpmCritical c = {.unstable_at = INFINITY,
                   .doubtful    = INFINITY,
                   .null_share  = NAN,
                   .fading      = NAN,
                   .moving      = {NAN, NAN},
                   .closed      = NAN,
                   .threshold   = PETSC_TRUE,
                   .mode_at     = {.id = MPM_NONE},
                   .asked       = {.tolerance = tolerance, .growth = NAN, .verdict = MPM_UNDECIDED}};

  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) c.beta[a] = c.closed_beta[a] = NAN;
  return c;
}

/* Whether a Courant number is in a window of growth. */
static PetscBool HasWindowAt(const MpmCritical *c, PetscReal courant)
{
  for (PetscInt i = 0; i < c->windows.n; i++)
    if (courant >= c->windows.window[i].from && courant <= c->windows.window[i].to) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Searches as a strategy says, and for what is asked besides. */
static PetscErrorCode Search(const MpmCriticalCase *of, const Strategy *s, PetscBool alone, MpmCritical *c)
{
  PetscReal        beta[MPM_MAX_DIM] = {NAN, NAN, NAN};
  MpmCritical      axes              = {.unstable_at = INFINITY};
  MpmCriticalStart start             = {.alone = alone, .unstable = INFINITY, .beta = beta, .axes = &axes};

  PetscFunctionBegin;
  if (s->axes) PetscCall(MpmCriticalAxes(of, MpmCriticalFind, &axes));
  c->evaluations += axes.evaluations;
  PetscCall(s->find(of, &start, c));
  if (!alone && !c->assembled) {
    PetscCall(Ask(of, c, beta));
    start.unstable = of->step.courant;
    if (s->again && c->asked.verdict == MPM_UNSTABLE && start.unstable < c->stable_at &&
        !HasWindowAt(c, start.unstable))
      PetscCall(s->find(of, &start, c));
    if (!MpmStepDrifts(&of->step)) PetscCall(MpmCriticalMoving(of, of->step.courant, c->moving, &c->evaluations));
  }
  if (of->layout->dim > 1 && !c->assembled && isfinite(c->unstable_at))
    PetscCall(Polarise(of, c->unstable_at * (1 + BEYOND_LIMIT), c->beta, &c->wave));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalQuieten(const MpmCriticalCase *of, MpmCritical *c)
{
  const PetscBool drifts = MpmStepDrifts(&of->step), damped = MpmSpaceIsDamped(&of->scheme->space);
  MpmScheme       other = *of->scheme;
  MpmCriticalCase cured = *of;

  PetscFunctionBegin;
  PetscCall(MpmCriticalQuiet(of, &c->quiet));
  if (of->scheme->formulation->quiet) c->no_theorem = MpmCriticalWhyNotQuiet(of);
  if (!drifts && isfinite(c->quiet)) c->quiet = 0; /* at rest the limit itself says more */
  if (of->step.courant <= c->quiet && !(c->asked.growth > 1 + of->tolerance))
    PetscCall(MpmFindingDecide(&c->asked, "a theorem says that nothing grows here"));
  cured.scheme = &other;
  for (PetscInt f = 0; drifts && !damped && MpmFormulations[f] && !c->quiet && !c->cure; f++) {
    other.formulation = MpmFormulations[f];
    if (!other.formulation->quiet || other.formulation->wave != of->scheme->formulation->wave) continue;
    if (other.transfer->affine && other.formulation->affine == MPM_NONE) continue;
    PetscCall(MpmTableCreate(other.formulation, other.transfer, &other.numbers, &other.space, &other.table));
    PetscCall(MpmCriticalQuiet(&cured, &c->cured));
    PetscCall(MpmTableDestroy(&other.table));
    if (c->cured > 0) c->cure = other.formulation;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalFind(const MpmCriticalCase *of, PetscBool alone, MpmCritical *c)
{
  const PetscReal begin  = MPI_Wtime();
  const PetscBool drifts = MpmStepDrifts(&of->step);

  PetscFunctionBegin;
  *c = Nothing(of->tolerance);
  PetscCall(MpmCriticalByClosedForm(of->layout, of->scheme, drifts, c));
  PetscCall(Search(of, StrategyOf(of, c), alone, c));
  MpmZoomFold(of->layout->dim, c->beta);
  if (!drifts && !of->layout->colliders) c->bound = MpmCriticalBound(of->layout, of->scheme);
  if (!alone && (drifts || of->scheme->formulation->quiet)) PetscCall(MpmCriticalQuieten(of, c));
  PetscCall(CheckRounding(of, c));
  if (of->layout->dim == 1)
    PetscCall(Compare(of, c));
  else if (c->disputed)
    PetscCall(Dispute(c));
  c->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the limits of all schemes at one layout ---- */

static PetscInt CountSchemes(void)
{
  PetscInt n = 0;

  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (PetscInt t = 0; MpmTransfers[t]; t++)
      for (PetscInt b = 0; MpmBases[b]; b++) n += MpmSchemeCombines(MpmFormulations[f], MpmTransfers[t]);
  return n;
}

PetscErrorCode MpmCriticalSurvey(const MpmCriticalCase *of, MpmCriticalRow row, void *context)
{
  const PetscInt  n      = CountSchemes();
  MpmScheme       scheme = *of->scheme;
  MpmCriticalCase each   = *of;
  MpmCritical     critical;
  MpmProgress     progress;
  PetscInt        done = 0;

  PetscFunctionBegin;
  MpmCheckInput(!MpmSymbolWhyNot(of->layout),
                "survey: %s; allowed: the same particles in every cell, and boundary periodic",
                MpmSymbolWhyNot(of->layout));
  each.scheme = &scheme;
  PetscCall(MpmProgressBegin("scheme", &progress));
  for (PetscInt f = 0; MpmFormulations[f]; f++) {
    for (PetscInt t = 0; MpmTransfers[t]; t++) {
      if (!MpmSchemeCombines(MpmFormulations[f], MpmTransfers[t])) continue;
      for (PetscInt b = 0; MpmBases[b]; b++) {
        scheme.formulation = MpmFormulations[f];
        scheme.transfer    = MpmTransfers[t];
        scheme.basis       = MpmBases[b];
        PetscCall(MpmTableCreate(scheme.formulation, scheme.transfer, &scheme.numbers, &scheme.space, &scheme.table));
        PetscCall(MpmCriticalFind(&each, PETSC_TRUE, &critical));
        PetscCall(row(context, &scheme, &critical));
        PetscCall(MpmTableDestroy(&scheme.table));
        PetscCall(MpmProgressUpdate(&progress, ++done, n));
      }
    }
  }
  PetscCall(MpmProgressEnd(&progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}
