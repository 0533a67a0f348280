/* The largest stable Courant number through the symbol. */
#include "symbol/bloch.h"
#include "analysis/critical_parts.h"
#include "linalg/small_eigen.h"
#include "scene/layout.h"
#include "base/progress.h"
#include <math.h>

#define RATIO 1.25 /* steps in Courant number at rest, where a phase that is unstable stays so */
#define DRIFT_RATIO 1.05
#define PRECISION 1e-10 /* of a bracket, relative */
#define COINCIDE 1e-6   /* factors nearer than this count as one */
#define TURN 0.1        /* of a factor, in radians over a period, between two Courant numbers: about twice this */
#define BETWEEN 8       /* phases looked at to either side when a limit is refined */
#define MOST_REFINED 20
#define LEADS_ON 1e-6 /* relative gain that makes it worth to go on */
#define BESIDE 5      /* steps that a refined limit is looked for below the one found */

/* The symbol as a function of Courant number and phase. */
typedef struct {
  MpmScene         scene; /* with a Courant number of its own */
  MpmBloch         bloch;
  MpmSmallEigen    eigen;
  PetscReal        beta;              /* the phase */
  MpmCriticalSteps steps;             /* where its limit is looked for */
  PetscReal        hit;               /* least Courant number seen to be unstable */
  PetscReal        least, least_beta; /* limit of a phase that was looked at, and which */
  MpmProgress      progress;
  PetscInt64       evaluations;
  MPI_Comm         comm;
} Probe;

static PetscErrorCode GrowthAt(Probe *p, PetscReal courant, PetscReal beta, PetscReal *growth)
{
  PetscInt  exponent;
  PetscReal largest = 0;

  PetscFunctionBegin;
  p->scene.courant = courant;
  p->evaluations++;
  PetscCall(MpmBlochMatrix(&p->bloch, beta, PETSC_FALSE, p->eigen.matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(&p->eigen, PETSC_FALSE));
  for (PetscInt i = 0; i < p->eigen.n; i++) largest = fmax(largest, cabs(p->eigen.value[i]));
  *growth = MpmGrowthPerStep(largest, exponent, p->bloch.period);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GrowthOfPhase(void *context, PetscReal courant, PetscReal *growth)
{
  Probe *p = (Probe *)context;

  PetscFunctionBegin;
  PetscCall(GrowthAt(p, courant, p->beta, growth));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   How near two factors of the phase are to one another: the logarithm of the product of their distances. Windows of
   instability open where factors meet. Notes the least Courant number that is seen to be unstable.
*/
static PetscErrorCode Distance(void *context, PetscReal courant, PetscReal *distance)
{
  Probe    *p = (Probe *)context;
  PetscReal growth;

  PetscFunctionBegin;
  PetscCall(GrowthOfPhase(p, courant, &growth));
  if (!(growth <= 1 + p->scene.tolerance)) p->hit = PetscMin(p->hit, courant);
  *distance = 0;
  for (PetscInt i = 0; i < p->eigen.n; i++)
    for (PetscInt j = 0; j < i; j++) *distance += log(fmax(cabs(p->eigen.value[i] - p->eigen.value[j]), COINCIDE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The Courant number that a phase allows, within the steps given. */
static PetscErrorCode LimitOfPhase(void *context, PetscReal beta, PetscReal *limit)
{
  Probe    *p = (Probe *)context;
  PetscReal bracket[2];

  PetscFunctionBegin;
  p->beta = beta;
  PetscCall(MpmCriticalCross(GrowthOfPhase, p, p->scene.tolerance, &p->steps, PRECISION, bracket));
  *limit = bracket[1];
  if (*limit < p->least) {
    p->least      = *limit;
    p->least_beta = beta;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Under drift: the same, with a closer look wherever factors come near one another. */
static PetscErrorCode LimitUnderDrift(Probe *p, PetscReal beta, PetscReal *limit)
{
  PetscReal k[3] = {0, 0, p->steps.from}, distance[3] = {0, 0, 0}, bracket[2], least;

  PetscFunctionBegin;
  p->beta = beta;
  p->hit  = INFINITY;
  for (PetscInt n = 0;; n++) {
    PetscCall(Distance(p, k[2], &distance[2]));
    if (n > 1 && isinf(p->hit) && distance[1] < distance[0] && distance[1] <= distance[2])
      PetscCall(MpmGoldenSection(Distance, p, k[0], k[2], &k[1], &least));
    if (isfinite(p->hit) || k[2] >= p->steps.to) break;
    for (int i = 0; i < 2; i++) {
      k[i]        = k[i + 1];
      distance[i] = distance[i + 1];
    }
    k[2] = PetscMin(PetscMin(k[1] * p->steps.ratio, k[1] + p->steps.width), p->steps.to);
  }
  *limit = INFINITY;
  if (isinf(p->hit)) PetscFunctionReturn(PETSC_SUCCESS);
  /* k[0] is stable, or 0 when the first is not */
  PetscCall(MpmCriticalCross(
      GrowthOfPhase, p, p->scene.tolerance,
      &(MpmCriticalSteps){
          .from = k[0] > 0 ? k[0] : p->hit, .to = p->hit, .ratio = p->steps.ratio, .width = p->steps.width},
      PRECISION, bracket));
  *limit = bracket[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   At rest a phase that is stable at the least limit so far allows more; under drift it must be looked at all the way.
*/
static PetscErrorCode SearchPhase(Probe *p, PetscInt m, MpmCritical *c)
{
  const PetscBool drifts = MpmSceneDrifts(&p->scene);
  PetscReal       g, limit = INFINITY;

  PetscFunctionBegin;
  if (isfinite(c->unstable_at)) {
    if (!drifts) {
      PetscCall(GrowthAt(p, c->unstable_at, MpmCriticalPhase(m), &g));
      if (g <= 1 + p->scene.tolerance) PetscFunctionReturn(PETSC_SUCCESS);
    }
    p->steps.to   = c->unstable_at;
    p->steps.from = PetscMin(p->steps.from, c->unstable_at / 2);
  }
  PetscCall(drifts ? LimitUnderDrift(p, MpmCriticalPhase(m), &limit) : LimitOfPhase(p, MpmCriticalPhase(m), &limit));
  if (limit >= c->unstable_at) PetscFunctionReturn(PETSC_SUCCESS);
  c->unstable_at = limit;
  c->beta        = MpmCriticalPhase(m);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least limit of all phases, from pi down. They are spread over the ranks. */
static PetscErrorCode SearchPhases(Probe *p, MpmCritical *c)
{
  PetscReal   mine[2], *all;
  PetscMPIInt rank, size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(p->comm, &rank));
  PetscCallMPI(MPI_Comm_size(p->comm, &size));
  for (PetscInt m = MPM_CRITICAL_PHASES - rank; m > 0; m -= size) {
    PetscCall(SearchPhase(p, m, c));
    PetscCall(MpmProgressUpdate(&p->progress, MPM_CRITICAL_PHASES - m, MPM_CRITICAL_PHASES));
  }
  mine[0] = c->unstable_at;
  mine[1] = c->beta;
  PetscCall(PetscMalloc1(2 * size, &all));
  PetscCallMPI(MPI_Allgather(mine, 2, MPIU_REAL, all, 2, MPIU_REAL, p->comm));
  for (PetscMPIInt r = 0; r < size; r++) {
    /* of equal limits that of the largest phase, as on one rank */
    if (all[2 * r] > c->unstable_at || (all[2 * r] == c->unstable_at && !(all[2 * r + 1] > c->beta))) continue;
    c->unstable_at = all[2 * r];
    c->beta        = all[2 * r + 1];
  }
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least limit of the phases beside the one found, below it, and its bracket. Under drift it may jump with beta. */
static PetscErrorCode RefineOnce(Probe *p, MpmCritical *c)
{
  const PetscBool drifts = MpmSceneDrifts(&p->scene);
  const PetscReal found  = c->beta;
  PetscReal       limit = INFINITY, beta = 0, bracket[2];

  PetscFunctionBegin;
  p->steps.from =
      drifts ? PetscMax(c->unstable_at - BESIDE * MPM_CRITICAL_STEP, c->unstable_at / 2) : c->unstable_at / 2;
  p->steps.to = drifts ? c->unstable_at : 2 * c->unstable_at;
  if (drifts) p->steps.width = (c->unstable_at - p->steps.from) / (2 * BESIDE);
  p->least = INFINITY;
  for (PetscInt i = 1 - BETWEEN; drifts && i < BETWEEN; i++)
    PetscCall(LimitOfPhase(p, MpmCriticalBeside(found, (PetscReal)i / BETWEEN), &limit));
  PetscCall(
      MpmGoldenSection(LimitOfPhase, p, MpmCriticalBeside(found, -1), MpmCriticalBeside(found, 1), &beta, &limit));
  if (p->least < c->unstable_at * (1 - PRECISION)) {
    c->unstable_at = p->least;
    c->beta        = p->least_beta;
    p->steps.from  = PetscMin(p->steps.from, p->least / 2);
  }
  p->beta     = c->beta;
  p->steps.to = c->unstable_at;
  PetscCall(MpmCriticalCross(GrowthOfPhase, p, p->scene.tolerance, &p->steps, PRECISION, bracket));
  c->stable_at   = bracket[0];
  c->unstable_at = PetscMin(bracket[1], c->unstable_at);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Under drift what is found near by may lead on. */
static PetscErrorCode Refine(Probe *p, MpmCritical *c)
{
  PetscReal before = INFINITY;

  PetscFunctionBegin;
  for (PetscInt n = 0; n < MOST_REFINED && c->unstable_at < before * (1 - LEADS_ON); n++) {
    before = c->unstable_at;
    PetscCall(RefineOnce(p, c));
    if (!MpmSceneDrifts(&p->scene)) break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Search(Probe *p, MpmCritical *c)
{
  const PetscBool drifts = MpmSceneDrifts(&p->scene);

  PetscFunctionBegin;
  p->steps =
      (MpmCriticalSteps){.from  = MPM_CRITICAL_FROM,
                         .to    = MPM_CRITICAL_TO,
                         .ratio = drifts ? DRIFT_RATIO : RATIO,
                         .width = drifts ? PetscMin(MPM_CRITICAL_STEP, TURN / p->bloch.period) : MPM_CRITICAL_TO};
  PetscCall(SearchPhases(p, c));
  c->courant = c->stable_at = INFINITY;
  if (isinf(c->unstable_at)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Refine(p, c));
  PetscCall(MpmCriticalThreshold(GrowthOfPhase, p, p->scene.tolerance, c));
  c->courant = c->threshold || drifts ? c->stable_at : 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Growth at the Courant number that the scene itself has; a limit above one that grows has missed a window. */
static PetscErrorCode Asked(Probe *p, PetscReal courant, MpmCritical *c)
{
  MpmFinding *finding = &c->asked;
  MpmSymbol  *symbol;

  PetscFunctionBegin;
  p->scene.courant = courant;
  PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, &p->scene, 2 * MPM_CRITICAL_PHASES, PETSC_FALSE, &symbol));
  finding->growth      = symbol->growth;
  finding->uncertainty = symbol->uncertainty;
  finding->blur        = symbol->blur;
  finding->verdict     = MpmVerdictOf(finding);
  PetscCall(
      PetscSNPrintf(finding->evidence, sizeof finding->evidence, "the symbol at %d phases", 2 * MPM_CRITICAL_PHASES));
  if (finding->verdict == MPM_UNSTABLE && courant < c->stable_at) {
    c->unstable_at = courant;
    c->beta        = symbol->beta_at_max;
    PetscCall(Refine(p, c));
    PetscCall(MpmCriticalThreshold(GrowthOfPhase, p, p->scene.tolerance, c));
    c->courant = c->stable_at;
  }
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalBySymbol(const MpmScene *scene, PetscBool alone, MpmCritical *c)
{
  Probe probe = {.scene = *scene, .comm = PETSC_COMM_WORLD};

  PetscFunctionBegin;
  PetscCall(MpmLayoutPeriod(scene, &c->order));
  PetscCall(MpmBlochCreate(&probe.scene, c->order, &probe.bloch));
  c->order = probe.bloch.size;
  PetscCall(MpmSmallEigenCreate(probe.bloch.size, &probe.eigen));
  PetscCall(MpmProgressBegin(scene, "phase", &probe.progress));
  PetscCall(MpmSceneDrifts(scene) ? MpmCriticalUnderDrift(scene, c) : Search(&probe, c));
  PetscCall(MpmProgressEnd(&probe.progress));
  if (!alone) PetscCall(Asked(&probe, scene->courant, c));
  c->evaluations = probe.evaluations;
  PetscCall(MpmSmallEigenDestroy(&probe.eigen));
  PetscCall(MpmBlochDestroy(&probe.bloch));
  PetscFunctionReturn(PETSC_SUCCESS);
}
