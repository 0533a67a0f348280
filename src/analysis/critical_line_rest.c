/*
   The largest stable Courant number at rest in one dimension, through the symbol. Where a phase that is unstable stays so, the
   first growth of each is looked for, and else growth is scanned. For moving particles see critical_line_drift.c.
*/
#include "analysis/critical_parts.h"
#include "analysis/waves.h"
#include "base/progress.h"
#include <math.h>

#define RATIO 1.25 /* of Courant numbers, one over the other */
#define PRECISION MPM_CRITICAL_PRECISION
#define SCANNED 1e-4 /* the precision of a limit before it is refined over the phases */

/* The symbol as a function of Courant number and phase, and the state of the search. */
typedef struct {
  MpmWaves       waves;
  PetscReal      tolerance, beta;   /* beta: the phase */
  PetscReal      asked;             /* the phase that grows most at the case's own Courant number; NaN: not asked for */
  MpmSearchSteps steps;             /* where the limit of that phase is sought */
  PetscReal      least, least_beta; /* the least limit found so far, and its phase */
  MpmProgress    progress;
  MPI_Comm       comm;
} Probe;

static PetscErrorCode GrowthOfPhase(void *context, PetscReal courant, PetscReal *growth)
{
  Probe *p = (Probe *)context;

  PetscFunctionBegin;
  PetscCall(MpmWavesGrowth(&p->waves, courant, &p->beta, growth));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the first Courant number at which a phase grows, within the given steps. */
static PetscErrorCode LimitOfPhase(void *context, PetscReal beta, PetscReal *limit)
{
  Probe    *p = (Probe *)context;
  PetscReal bracket[2];

  PetscFunctionBegin;
  p->beta = beta;
  PetscCall(MpmSearchFirst(GrowthOfPhase, p, p->tolerance, &p->steps, PRECISION, bracket));
  *limit = bracket[1];
  if (*limit < p->least) {
    p->least      = *limit;
    p->least_beta = beta;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the limit of a phase. A phase that is stable at the least limit so far has a larger limit and is skipped. */
static PetscErrorCode SearchPhase(Probe *p, PetscInt m, MpmCritical *c)
{
  PetscReal g, limit = INFINITY;

  PetscFunctionBegin;
  if (isfinite(c->unstable_at)) {
    PetscCall(MpmWavesGrowth(&p->waves, c->unstable_at, &(PetscReal){MpmSearchPhase(m)}, &g));
    if (g <= 1 + p->tolerance) PetscFunctionReturn(PETSC_SUCCESS);
    p->steps.to   = c->unstable_at;
    p->steps.from = PetscMin(p->steps.from, c->unstable_at / 2);
  }
  PetscCall(LimitOfPhase(p, MpmSearchPhase(m), &limit));
  if (limit >= c->unstable_at) PetscFunctionReturn(PETSC_SUCCESS);
  c->unstable_at = limit;
  c->beta[0]     = MpmSearchPhase(m);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives each rank the least value of all, with its phase: of equal ones the largest, as one rank does. */
static PetscErrorCode LeastOfRanks(MPI_Comm comm, PetscReal *value, PetscReal *beta)
{
  const PetscReal mine = *value;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(&mine, value, 1, MPIU_REAL, MPI_MIN, comm));
  if (isinf(*value)) PetscFunctionReturn(PETSC_SUCCESS);
  if (mine > *value) *beta = 0;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, beta, 1, MPIU_REAL, MPI_MAX, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the least limit of all phases, from pi downwards. The phases are spread over the ranks. */
static PetscErrorCode SearchPhases(Probe *p, MpmCritical *c)
{
  PetscFunctionBegin;
  for (PetscInt m = MPM_CRITICAL_PHASES - MpmRankOf(p->comm); m > 0; m -= MpmRanksOf(p->comm)) {
    PetscCall(SearchPhase(p, m, c));
    PetscCall(MpmProgressUpdate(&p->progress, MPM_CRITICAL_PHASES - m, MPM_CRITICAL_PHASES));
  }
  PetscCall(LeastOfRanks(p->comm, &c->unstable_at, &c->beta[0]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Looks for a smaller limit at phases beside the one found, from a Courant number on, and brackets the least. */
static PetscErrorCode Refine(Probe *p, PetscReal from, MpmCritical *c)
{
  const PetscReal found = c->beta[0];
  PetscReal       limit = INFINITY, beta = 0, bracket[2];

  PetscFunctionBegin;
  p->steps.from = from;
  p->steps.to   = 2 * c->unstable_at;
  p->least      = INFINITY;
  PetscCall(MpmSearchLeast(LimitOfPhase, p, MPM_SEARCH_GOLDEN, MpmSearchBeside(found, -1), MpmSearchBeside(found, 1),
                           &beta, &limit));
  if (p->least < c->unstable_at * (1 - PRECISION)) {
    c->unstable_at = p->least;
    c->beta[0]     = p->least_beta;
    p->steps.from  = PetscMin(p->steps.from, p->least / 2);
  }
  p->beta     = c->beta[0];
  p->steps.to = c->unstable_at;
  PetscCall(MpmSearchFirst(GrowthOfPhase, p, p->tolerance, &p->steps, PRECISION, bracket));
  c->stable_at   = bracket[0];
  c->unstable_at = PetscMin(bracket[1], c->unstable_at);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Search(Probe *p, MpmCritical *c)
{
  PetscFunctionBegin;
  p->steps =
      (MpmSearchSteps){.from = MPM_CRITICAL_FROM, .to = MPM_CRITICAL_TO, .ratio = RATIO, .width = MPM_CRITICAL_TO};
  PetscCall(SearchPhases(p, c));
  c->courant = c->stable_at = INFINITY;
  if (isinf(c->unstable_at)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Refine(p, c->unstable_at / 2, c));
  PetscCall(MpmSearchThreshold(GrowthOfPhase, p, p->tolerance, 0, c));
  c->courant = c->threshold ? c->stable_at : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the limit below a Courant number at which a phase grows although the limit found is above it. */
static PetscErrorCode Below(Probe *p, PetscReal courant, PetscReal beta, MpmCritical *c)
{
  PetscFunctionBegin;
  c->unstable_at = courant;
  c->beta[0]     = beta;
  PetscCall(Refine(p, c->unstable_at / 2, c));
  PetscCall(MpmSearchThreshold(GrowthOfPhase, p, p->tolerance, 0, c));
  c->courant = c->stable_at;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- where growth may stop again ---- */

/* The largest growth of all phases, and of the one that grows at the case's own Courant number. Its phase is kept. */
static PetscErrorCode GrowthOfPhases(void *context, PetscReal courant, PetscReal *growth)
{
  Probe    *p     = (Probe *)context;
  PetscReal least = 0; /* of the negative growths */

  PetscFunctionBegin;
  p->beta = 0;
  for (PetscInt m = MPM_CRITICAL_PHASES - MpmRankOf(p->comm); m >= 0; m -= MpmRanksOf(p->comm)) {
    const PetscReal beta = m > 0 ? MpmSearchPhase(m) : p->asked;
    PetscReal       g;

    if (isnan(beta)) continue;
    PetscCall(MpmWavesGrowth(&p->waves, courant, &beta, &g));
    if (!(-g < least)) continue;
    least   = -g;
    p->beta = beta;
  }
  PetscCall(LeastOfRanks(p->comm, &least, &p->beta));
  *growth = -least;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Scans growth of all phases, and refines the limit over the phases from the middle of the range without growth on. A phase
   between those that were scanned may grow further down: windows that are not below the limit then are part of what is above.
*/
static PetscErrorCode ScanPhases(Probe *p, PetscReal courant, MpmCritical *c)
{
  const MpmCriticalWindows *w = &c->windows;
  PetscReal                 growth, middle;

  PetscFunctionBegin;
  PetscCall(MpmSearchScan(GrowthOfPhases, p, p->tolerance, courant, SCANNED, c));
  c->courant = INFINITY;
  if (isinf(c->unstable_at)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GrowthOfPhases(p, c->unstable_at, &growth));
  c->beta[0] = p->beta;
  if (c->stable_at > 0) {
    middle   = (c->unstable_at + (w->n ? w->window[w->n - 1].to : 0)) / 2;
    p->steps = (MpmSearchSteps){.from = middle, .to = c->unstable_at, .ratio = RATIO, .width = MPM_CRITICAL_TO};
    PetscCall(LimitOfPhase(p, c->beta[0], &c->unstable_at));
    PetscCall(Refine(p, middle, c));
  }
  MpmCriticalKeepBelow(c);
  c->courant = c->threshold ? c->stable_at : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Begin(const MpmCriticalCase *of, MpmCritical *c, Probe *p)
{
  PetscFunctionBegin;
  *p = (Probe){.tolerance = of->tolerance, .comm = PETSC_COMM_WORLD};
  PetscCall(MpmWavesCreate(of->layout, of->scheme, of->step.drift, &p->waves));
  c->order = p->waves.bloch.size;
  PetscCall(MpmProgressBegin("phase", &p->progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode End(Probe *p, MpmCritical *c)
{
  PetscFunctionBegin;
  PetscCall(MpmProgressEnd(&p->progress));
  c->evaluations += p->waves.evaluations;
  PetscCall(MpmWavesDestroy(&p->waves));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalLineAtRest(const MpmCriticalCase *of, const MpmCriticalStart *start, MpmCritical *c)
{
  Probe probe;

  PetscFunctionBegin;
  PetscCall(Begin(of, c, &probe));
  PetscCall(isfinite(start->unstable) ? Below(&probe, start->unstable, start->beta[0], c) : Search(&probe, c));
  PetscCall(End(&probe, c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalLineScanned(const MpmCriticalCase *of, const MpmCriticalStart *start, MpmCritical *c)
{
  Probe probe;

  PetscFunctionBegin;
  PetscCall(Begin(of, c, &probe));
  probe.asked = start->beta[0];
  PetscCall(ScanPhases(&probe, start->alone ? 0 : of->step.courant, c));
  PetscCall(End(&probe, c));
  PetscFunctionReturn(PETSC_SUCCESS);
}
