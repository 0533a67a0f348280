/* The largest stable Courant number through the symbol and by closed form. */
#include <mpmstab/bloch.h>
#include <mpmstab/critical.h>
#include <mpmstab/eigen_small.h>
#include <mpmstab/layout.h>
#include <mpmstab/progress.h>
#include <math.h>

#define PHASES 128      /* looked at first in (0, pi] */
#define RATIO 1.25      /* steps in Courant number at rest, where a phase that is unstable stays so */
#define DRIFT_RATIO 1.1 /* and under drift */
#define PRECISION 1e-10 /* of a bracket, relative */
#define SAME 1e-5       /* closed form and search, relative */
#define FADES 0.03      /* growth at half a limit, in tolerances, that says there is no threshold */

/* The symbol as a function of Courant number and phase. */
typedef struct {
  MpmScene      scene; /* with a Courant number of its own */
  MpmBloch      bloch;
  MpmSmallEigen eigen;
  PetscReal     beta, limit[2]; /* for one phase: where its limit is looked for */
  PetscReal     worst_beta;     /* of all phases: where growth is largest */
  MpmProgress   progress;
  PetscInt64    evaluations;
  MPI_Comm      comm;
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

static PetscReal Phase(PetscInt m)
{
  return PETSC_PI * m / PHASES;
}

/* The largest over all phases, which are spread over the ranks. */
static PetscErrorCode GrowthOfAll(void *context, PetscReal courant, PetscReal *growth)
{
  Probe      *p       = (Probe *)context;
  PetscReal   mine[2] = {-1, 0}, *all, g;
  PetscMPIInt rank, size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(p->comm, &rank));
  PetscCallMPI(MPI_Comm_size(p->comm, &size));
  for (PetscInt m = rank; m <= PHASES; m += size) {
    PetscCall(GrowthAt(p, courant, Phase(m), &g));
    if (g > mine[0]) {
      mine[0] = g;
      mine[1] = Phase(m);
    }
  }
  PetscCall(PetscMalloc1(2 * size, &all));
  PetscCallMPI(MPI_Allgather(mine, 2, MPIU_REAL, all, 2, MPIU_REAL, p->comm));
  *growth = -1;
  for (PetscMPIInt r = 0; r < size; r++) {
    if (all[2 * r] <= *growth) continue;
    *growth       = all[2 * r];
    p->worst_beta = all[2 * r + 1];
  }
  PetscCall(PetscFree(all));
  PetscCall(MpmProgressNote(&p->progress, "searching Courant numbers"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The Courant number that a phase allows, within the limits given. */
static PetscErrorCode LimitOfPhase(void *context, PetscReal beta, PetscReal *limit)
{
  Probe    *p = (Probe *)context;
  PetscReal bracket[2];

  PetscFunctionBegin;
  p->beta = beta;
  PetscCall(
      MpmCriticalCross(GrowthOfPhase, p, p->scene.tolerance, p->limit[0], p->limit[1], RATIO, PRECISION, bracket));
  *limit = bracket[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At rest: the phase that allows least, from pi down; a phase that allows more than the least so far is passed over. */
static PetscErrorCode SearchPhases(Probe *p, MpmCritical *c)
{
  PetscReal g, limit = INFINITY;

  PetscFunctionBegin;
  p->limit[0] = MPM_CRITICAL_FROM;
  p->limit[1] = MPM_CRITICAL_TO;
  for (PetscInt m = PHASES; m > 0; m--) {
    if (isfinite(c->unstable_at)) {
      PetscCall(GrowthAt(p, c->unstable_at, Phase(m), &g));
      if (g <= 1 + p->scene.tolerance) continue;
      p->limit[1] = c->unstable_at;
    }
    PetscCall(LimitOfPhase(p, Phase(m), &limit));
    if (limit >= c->unstable_at) continue;
    c->unstable_at = limit;
    c->beta        = Phase(m);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Under drift: where growth over all phases first leaves tolerance. */
static PetscErrorCode SearchCourant(Probe *p, MpmCritical *c)
{
  PetscReal bracket[2], g;

  PetscFunctionBegin;
  PetscCall(MpmCriticalCross(GrowthOfAll, p, p->scene.tolerance, MPM_CRITICAL_FROM, MPM_CRITICAL_TO, DRIFT_RATIO,
                             PRECISION, bracket));
  c->unstable_at = bracket[1];
  if (isfinite(c->unstable_at)) PetscCall(GrowthOfAll(p, c->unstable_at, &g));
  c->beta = p->worst_beta;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least limit of the phases beside the one found, and its bracket. */
static PetscErrorCode Refine(Probe *p, MpmCritical *c)
{
  PetscReal limit = INFINITY, beta = 0, bracket[2];

  PetscFunctionBegin;
  p->limit[0] = c->unstable_at / 2;
  p->limit[1] = c->unstable_at * 2;
  PetscCall(MpmGoldenSection(LimitOfPhase, p, PetscMax(c->beta - Phase(1), 0), PetscMin(c->beta + Phase(1), PETSC_PI),
                             &beta, &limit));
  if (limit < c->unstable_at * (1 - PRECISION)) {
    c->unstable_at = limit;
    c->beta        = beta;
  }
  p->beta = c->beta;
  PetscCall(MpmCriticalCross(GrowthOfPhase, p, p->scene.tolerance, PetscMin(MPM_CRITICAL_FROM, c->unstable_at / 2),
                             2 * c->unstable_at, RATIO, PRECISION, bracket));
  c->stable_at   = bracket[0];
  c->unstable_at = bracket[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether growth at half the limit is none but for rounding, and if not, with which power of k it goes. */
static PetscErrorCode FindThreshold(Probe *p, MpmCritical *c)
{
  PetscReal at[2];

  PetscFunctionBegin;
  PetscCall(GrowthOfPhase(p, c->unstable_at, &at[0]));
  PetscCall(GrowthOfPhase(p, c->unstable_at / 2, &at[1]));
  c->threshold = at[1] - 1 <= FADES * p->scene.tolerance ? PETSC_TRUE : PETSC_FALSE;
  if (!c->threshold) c->fading = log2((at[0] - 1) / (at[1] - 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Search(Probe *p, MpmCritical *c)
{
  const PetscBool drifts = MpmSceneDrifts(&p->scene);

  PetscFunctionBegin;
  PetscCall(drifts ? SearchCourant(p, c) : SearchPhases(p, c));
  c->courant = c->stable_at = INFINITY;
  if (isinf(c->unstable_at)) PetscFunctionReturn(PETSC_SUCCESS);
  c->courant = c->stable_at = 0;
  if (c->unstable_at <= MPM_CRITICAL_FROM) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Refine(p, c));
  PetscCall(FindThreshold(p, c));
  if (c->threshold || drifts) c->courant = c->stable_at;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode BySymbol(const MpmScene *scene, MpmCritical *c)
{
  Probe probe = {.scene = *scene, .comm = PETSC_COMM_WORLD};

  PetscFunctionBegin;
  PetscCall(MpmLayoutPeriod(scene, &c->order));
  PetscCall(MpmBlochCreate(&probe.scene, c->order, &probe.bloch));
  c->order = probe.bloch.size;
  PetscCall(MpmSmallEigenCreate(probe.bloch.size, &probe.eigen));
  PetscCall(MpmProgressBegin(scene, "", &probe.progress));
  PetscCall(Search(&probe, c));
  PetscCall(MpmProgressEnd(&probe.progress));
  c->evaluations = probe.evaluations;
  PetscCall(MpmSmallEigenDestroy(&probe.eigen));
  PetscCall(MpmBlochDestroy(&probe.bloch));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ClosedLimit(void *context, PetscReal beta, PetscReal *limit)
{
  const MpmPredictor  *predictor = (const MpmPredictor *)context;
  const MpmCellSymbols cell      = MpmPredictorSymbols(predictor, beta);

  PetscFunctionBegin;
  *limit = predictor->scene->formulation->limit(&cell);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least of the closed form over all phases. */
static PetscErrorCode ByClosedForm(const MpmScene *scene, MpmCritical *c)
{
  MpmPredictor predictor;
  PetscReal    limit, beta;

  PetscFunctionBegin;
  PetscCall(MpmPredictorCreate(scene, &predictor));
  c->closed = NAN;
  for (PetscInt m = PHASES; m > 0 && !predictor.why_not; m--) {
    PetscCall(ClosedLimit(&predictor, Phase(m), &limit));
    if (limit >= c->closed) continue;
    c->closed      = limit;
    c->closed_beta = Phase(m);
  }
  if (c->closed > 0) {
    PetscCall(MpmGoldenSection(ClosedLimit, &predictor, c->closed_beta - Phase(1),
                               PetscMin(c->closed_beta + Phase(1), PETSC_PI), &beta, &limit));
    if (limit < c->closed * (1 - PRECISION)) {
      c->closed      = limit;
      c->closed_beta = beta;
    }
  }
  if (!isnan(c->closed)) c->cell = MpmPredictorSymbols(&predictor, c->closed_beta);
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Growth at the Courant number that the scene itself has. */
static PetscErrorCode Asked(const MpmScene *scene, MpmFinding *finding)
{
  MpmSymbol *symbol;

  PetscFunctionBegin;
  PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, scene, 2 * PHASES, PETSC_FALSE, &symbol));
  finding->growth      = symbol->growth;
  finding->uncertainty = symbol->uncertainty;
  finding->blur        = symbol->blur;
  finding->verdict     = MpmVerdictOf(finding);
  PetscCall(PetscSNPrintf(finding->evidence, sizeof finding->evidence, "the symbol at %d phases", 2 * PHASES));
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalFind(const MpmScene *scene, PetscBool alone, MpmCritical *c)
{
  const PetscReal begin = MPI_Wtime();

  PetscFunctionBegin;
  *c = (MpmCritical){.unstable_at = INFINITY,
                     .beta        = NAN,
                     .null_share  = NAN,
                     .fading      = NAN,
                     .closed      = NAN,
                     .closed_beta = NAN,
                     .threshold   = PETSC_TRUE,
                     .asked       = {.tolerance = scene->tolerance, .growth = NAN, .verdict = MPM_UNDECIDED}};
  if (MpmSymbolWhyNot(scene))
    PetscCall(MpmCriticalAssembled(scene, c));
  else {
    PetscCall(BySymbol(scene, c));
    if (!alone) PetscCall(Asked(scene, &c->asked));
  }
  PetscCall(ByClosedForm(scene, c));
  /* long waves may grow by less than tolerance per step: the closed form knows */
  if (c->closed < c->stable_at * (1 - SAME)) c->courant = c->closed;
  c->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}
