/* Growth of the waves of a uniform layout, what rounding makes of it, and the largest of all phases. */
#include "analysis/waves.h"
#include "analysis/zoom.h"
#include <math.h>

#define WITHIN 10       /* refining goes on from growths - 1 of at least this part of the largest */
#define STARTS 12       /* and from so many of them at most */
#define LEAST_BETA 2e-4 /* no waves longer than this, whose growth is that of rounding */
#define NONE 1e-13      /* a growth - 1 up to this is rounding, */
#define SMALL 1e-9      /* and up to this it need not settle */

/* Refining, by dimension: the phases in (0, pi] of the coarsest and of the finest grid, and the last step uphill. */
static const PetscInt  first[] = {0, 32, 8, 4}, last[] = {0, 2048, 64, 8};
static const PetscReal finest[] = {0, 1e-7, 1e-5, 1e-3};

#define MOST_POINTS 64 /* of a source: in (0, pi] in each direction, for the phases of the symbol */
#define SOURCE_STARTS 8
#define SOURCE_WITHIN 0.5  /* searches go on from places with at least half of the largest growth */
#define SOURCE_FINEST 1e-8 /* of a phase */

/*
   Of a source, by dimension: the fewest points in (0, pi]. Under drift growth may be confined to a thousandth of the
   phases.
*/
static const PetscInt fewest[] = {0, 1024, 32, 4};

PetscErrorCode MpmWavesCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmFraction drift[], MpmWaves *w)
{
  PetscFunctionBegin;
  *w = (MpmWaves){.evaluations = 0};
  PetscCall(MpmBlochCreate(layout, scheme, drift, &w->bloch));
  PetscCall(MpmSmallEigenCreate(w->bloch.turn_size, &w->eigen));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWavesDestroy(MpmWaves *w)
{
  PetscFunctionBegin;
  PetscCall(MpmSmallEigenDestroy(&w->eigen));
  PetscCall(MpmBlochDestroy(&w->bloch));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWavesGrowth(MpmWaves *w, PetscReal courant, const PetscReal beta[], PetscReal *growth)
{
  PetscReal without_null;

  PetscFunctionBegin;
  w->evaluations++;
  PetscCall(MpmBlochGrowths(&w->bloch, &w->eigen, 1, &courant, beta, growth, &without_null));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWavesRounding(MpmWaves *w, PetscReal courant, const PetscReal beta[], PetscReal growth,
                                PetscReal *defective_error, PetscReal *uncertainty)
{
  MpmSmallEigen   whole, *e      = &whole;
  double complex *noisy, overlap = 0;
  PetscReal       norm = 0, moved = 0;
  PetscInt        largest = 0, exponent, other;

  PetscFunctionBegin;
  PetscCall(MpmSmallEigenCreate(w->bloch.size, e));
  noisy = e->left; /* vectors come later */
  PetscCall(MpmBlochMatrices(&w->bloch, 1, &courant, beta, PETSC_FALSE, e->matrix, &exponent));
  PetscCall(MpmBlochMatrices(&w->bloch, 1, &courant, beta, PETSC_TRUE, noisy, &other));
  for (PetscInt i = 0; i < e->n * e->n; i++) {
    norm  = hypot(norm, cabs(e->matrix[i]));
    moved = hypot(moved, cabs(noisy[i] * scalbn(1, (int)(other - exponent)) - e->matrix[i]));
  }
  moved            = PetscMax(moved, MPM_ROUNDING * norm);
  *defective_error = MpmDefectiveErrorOf(moved, exponent, w->bloch.period);
  if (uncertainty) {
    PetscCall(MpmSmallEigenSolve(e, PETSC_TRUE));
    for (PetscInt i = 1; i < e->n; i++)
      if (cabs(e->value[i]) > cabs(e->value[largest])) largest = i;
    for (PetscInt i = 0; i < e->n; i++) overlap += conj(e->left[e->n * largest + i]) * e->right[e->n * largest + i];
    *uncertainty = MpmUncertaintyOf(growth, moved / cabs(overlap) / cabs(e->value[largest]), w->bloch.period);
  }
  PetscCall(MpmSmallEigenDestroy(e));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the largest growth of all phases, on finer and finer grids of phases ---- */

typedef struct {
  MpmWaves  waves;
  PetscReal courant, largest; /* of all growths computed */
} Search;

/* The zoom looks for the least of a positive number. */
static PetscErrorCode Inverse(void *context, const PetscReal beta[], PetscReal *value)
{
  Search   *s = (Search *)context;
  PetscReal growth;

  PetscFunctionBegin;
  PetscCall(MpmWavesGrowth(&s->waves, s->courant, beta, &growth));
  s->largest = PetscMax(s->largest, growth);
  *value     = growth - 1 > NONE ? 1 / (growth - 1) : INFINITY;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool HasMoved(PetscReal excess, PetscReal before)
{
  return PetscAbsReal(excess - before) > PetscMax(MPM_REFINED * excess, SMALL) ? PETSC_TRUE : PETSC_FALSE;
}

/* What one grid does not find again, another one has found. */
static PetscErrorCode Refine(Search *s, MpmZoom *zoom, PetscBool to_finest, MpmRefined *r)
{
  PetscReal excess = 0;
  PetscInt  still  = 0;

  PetscFunctionBegin;
  for (PetscInt points = first[zoom->dim]; points <= last[zoom->dim] && still < 2; points *= 2) {
    PetscReal       beta[MPM_MAX_DIM], value;
    const PetscReal before = excess;

    zoom->points = points;
    PetscCall(MpmZoomLeast(zoom, Inverse, s, beta, &value));
    r->points = points;
    if (1 / value > excess) {
      excess = 1 / value;
      PetscCall(PetscArraycpy(r->beta, beta, zoom->dim));
    }
    still = points > first[zoom->dim] && !HasMoved(excess, before) && !(to_finest && excess == 0) ? still + 1 : 0;
  }
  r->settled = still == 2 || (to_finest && excess == 0 && r->points >= 4 * first[zoom->dim]) ? PETSC_TRUE : PETSC_FALSE;
  r->growth  = 1 + excess;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRefinedFinding(const MpmRefined *r, PetscReal tolerance, MpmFinding *f)
{
  PetscFunctionBegin;
  *f         = (MpmFinding){.tolerance       = tolerance,
                            .growth          = r->growth,
                            .uncertainty     = r->uncertainty,
                            .defective_error = r->defective_error};
  f->verdict = MpmVerdictOf(f);
  if (f->verdict == MPM_STABLE && !r->settled) f->verdict = MPM_UNDECIDED;
  PetscCall(PetscSNPrintf(f->evidence, sizeof f->evidence,
                          "the symbol at up to %" PetscInt_FMT " phases in (0, pi] and uphill", r->points));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRefinedGrowth(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                PetscBool to_finest, MpmRefined *r)
{
  Search  s    = {.courant = step->courant};
  MpmZoom zoom = MpmZoomOf(layout, &scheme->space, step->drift);

  PetscFunctionBegin;
  *r          = (MpmRefined){.beta = {NAN, NAN, NAN}};
  zoom.starts = STARTS;
  zoom.within = WITHIN;
  zoom.finest = finest[layout->dim];
  zoom.least  = LEAST_BETA;
  zoom.comm   = comm;
  PetscCall(MpmWavesCreate(layout, scheme, step->drift, &s.waves));
  PetscCall(Refine(&s, &zoom, to_finest, r));
  if (!isnan(r->beta[0]))
    PetscCall(MpmWavesRounding(&s.waves, s.courant, r->beta, r->growth, &r->defective_error, &r->uncertainty));
  PetscCallMPI(MPI_Allreduce(&s.waves.evaluations, &r->evaluations, 1, MPIU_INT64, MPI_SUM, comm));
  if (isnan(r->beta[0])) PetscCallMPI(MPI_Allreduce(&s.largest, &r->growth, 1, MPIU_REAL, MPI_MAX, comm));
  PetscCall(MpmWavesDestroy(&s.waves));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the same of a source ---- */

typedef struct {
  const MpmSource *source;
  MpmSmallEigen    eigen;
} OfSource;

/* Minus the growth, since the least value is sought. */
static PetscErrorCode MinusGrowth(void *context, const PetscReal beta[], PetscReal *value)
{
  OfSource *s       = context;
  PetscReal largest = 0;
  PetscInt  exponent;

  PetscFunctionBegin;
  PetscCall(MpmSourceMatrix(s->source, beta, s->eigen.matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(&s->eigen, PETSC_FALSE));
  for (PetscInt i = 0; i < s->eigen.n; i++) largest = PetscMax(largest, cabs(s->eigen.value[i]));
  *value = -MpmGrowthPerStep(largest, exponent, s->source->period);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWorstPhase(MPI_Comm comm, const MpmSource *source, const PetscInt phases[], PetscReal beta[],
                             MpmSourceGrowth *at)
{
  OfSource  search = {.source = source};
  MpmZoom   zoom   = {.dim    = source->dim,
                      .points = fewest[source->dim],
                      .starts = SOURCE_STARTS,
                      .within = SOURCE_WITHIN,
                      .finest = SOURCE_FINEST,
                      .comm   = comm};
  PetscReal value;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < source->dim; a++) {
    zoom.points    = PetscMax(zoom.points, PetscMin(MOST_POINTS, phases[a] / 2));
    zoom.mirror[a] = source->reflects[a];
  }
  PetscCall(MpmSmallEigenCreate(source->size, &search.eigen));
  PetscCall(MpmZoomLeast(&zoom, MinusGrowth, &search, beta, &value));
  PetscCall(MpmSmallEigenDestroy(&search.eigen));
  PetscCall(MpmSourceGrowthAt(source, beta, at));
  PetscFunctionReturn(PETSC_SUCCESS);
}
