/* Finds the largest growth over all phases, on finer and finer grids of phases. */
#include "analysis/refined.h"
#include "analysis/critical_parts.h"
#include "analysis/waves.h"
#include <math.h>

#define WITHIN 10       /* the search goes on from growths - 1 of at least this part of the largest */
#define STARTS 12       /* and from so many of them at most */
#define LEAST_BETA 2e-4 /* no waves longer than this, whose growth is that of rounding */
#define NONE 1e-13      /* a growth - 1 up to this is rounding, */
#define SMALL 1e-9      /* and up to this it need not settle */

/* By dimension: the phases in (0, pi] of the coarsest and of the finest grid, and the last step uphill. */
static const PetscInt  first[] = {0, 32, 8, 4}, last[] = {0, 2048, 64, 8};
static const PetscReal finest[] = {0, 1e-7, 1e-5, 1e-3};

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
