/* Layouts of many seeds: each is solved by one rank alone, and their verdicts are counted. */
#include "base/farm.h"
#include "linalg/dense.h"
#include "linalg/eigen.h"
#include "operator/nodal.h"
#include "analysis/ensemble.h"
#include "analysis/spectrum.h"
#include "march/march_private.h"
#include "scene/layout.h"
#include <math.h>

#define Z 1.959963984540054 /* 95% of the normal distribution are within +-Z */
#define BESIDE 1e-7         /* relative distance of the shift from the eigenvalue */
#define FOUND_WITHIN 1e-6   /* largest distance, over norm(A), from the eigenvalue to the one found near the shift */
#define LAST_SEED 9007199254740992

void MpmWilson(PetscInt hits, PetscInt trials, PetscReal interval[2])
{
  const PetscReal n = trials, p = hits / n, middle = p + Z * Z / (2 * n);
  const PetscReal half = Z * sqrt(p * (1 - p) / n + Z * Z / (4 * n * n));

  interval[0] = hits == 0 ? 0 : (middle - half) / (1 + Z * Z / n);
  interval[1] = hits == trials ? 1 : (middle + half) / (1 + Z * Z / n);
}

/*
   Refuses what could be refused for any layout. It depends on the scene and not on the seed, so all ranks refuse
   together.
*/
static PetscErrorCode Check(const MpmScene *scene, const MpmRequest *request, PetscInt *nodal)
{
  const PetscInt layouts  = request->layouts;
  PetscInt64     unknowns = 0;
  MpmOperator   *op;
  MpmMarch      *march;
  char           size[MPM_SIZE_TEXT];

  PetscFunctionBegin;
  PetscCall(MpmNodalChoiceCheck(scene, request));
  if (request->nodal) PetscCall(MpmNodalMatrixUnknowns(&scene->layout, &scene->scheme, &scene->step, &unknowns));
  *nodal = (PetscInt)PetscMin(unknowns, PETSC_MAX_INT);
  if (!unknowns) unknowns = scene->scheme.table->nstate * scene->layout.particles;
  MpmLayoutSizeText(&scene->layout, sizeof size, size);
  MpmCheckInput(scene->layout.jitter > 0,
                "jitter 0: all layouts are the same without it; allowed: -jitter above 0, up to 1");
  MpmCheckInput(scene->layout.seed <= LAST_SEED - layouts + 1,
                "seed %" PetscInt64_FMT " with layouts %" PetscInt_FMT
                ": the last seed is out of range; allowed: seed + layouts - 1 up to %" PetscInt64_FMT,
                scene->layout.seed, layouts, (PetscInt64)LAST_SEED);
  MpmCheckInput(unknowns <= MPM_DENSE_MANY,
                "%s: all eigenvalues of %" PetscInt64_FMT
                " unknowns are sought for each layout; allowed: at most %d, so fewer cells",
                size, unknowns, MPM_DENSE_MANY);
  PetscCall(MpmOperatorCreate(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmMarchCreate(PETSC_COMM_SELF, scene, &march));
  PetscCall(MpmMarchDestroy(&march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Compares operator and march. A march that cannot finish (transfer nullspace, where particles almost coincide) leaves
   the verdict on its layout open, since one rank alone must not end the task.
*/
static PetscErrorCode Mismatch(const MpmOperator *op, PetscReal *mismatch)
{
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  error = MpmOperatorMismatch(op, mismatch);
  PetscCall(PetscPopErrorHandler());
  if (error) *mismatch = INFINITY;
  PetscCheck(!error || error == PETSC_ERR_USER_INPUT, PETSC_COMM_SELF, error, "the march of a layout failed");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Computes the uncertainty from the vectors of one eigenvalue, found with a shift next to it. That takes a fraction of
   the work of all vectors.
*/
static PetscErrorCode Uncertainty(const MpmOperator *op, const MpmReduced *nodal, const PetscReal value[2],
                                  PetscReal mismatch, MpmFinding *f)
{
  const PetscReal target[2] = {value[0] * (1 + BESIDE), value[1] * (1 + BESIDE)};
  PetscReal       nearest   = INFINITY, condition, error;
  PetscInt        match     = 0;
  MpmEigen       *eigen;

  PetscFunctionBegin;
  f->uncertainty = INFINITY;
  if (nodal)
    PetscCall(MpmEigenSolveReduced(op->balanced, nodal, "layout_", MPM_EIGEN_TARGET, target, &eigen));
  else
    PetscCall(MpmEigenSolve(op->balanced, "layout_", MPM_EIGEN_TARGET, target, &eigen));
  for (PetscInt j = 0; j < eigen->n; j++) {
    const PetscReal distance = hypot(eigen->re[j] - value[0], fabs(eigen->im[j]) - fabs(value[1]));

    if (distance < nearest) match = j;
    nearest = PetscMin(nearest, distance);
  }
  if (nearest <= FOUND_WITHIN * eigen->norm) {
    PetscCall(MpmEigenCondition(eigen, match, &condition));
    error          = condition * MpmOperatorErrorOf(eigen->norm, mismatch, eigen->residual[match]);
    f->uncertainty = MpmUncertaintyOf(f->growth, error / hypot(value[0], value[1]), op->period);
  }
  PetscCall(MpmEigenDestroy(&eigen));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Judge(const MpmEnsemble *e, const MpmLayout *layout, MpmFinding *f)
{
  const MpmScene *scene = e->scene;
  MpmOperator    *op;
  MpmReduced     *nodal = NULL;
  PetscReal       value[2], norm, mismatch;

  PetscFunctionBegin;
  *f = (MpmFinding){.tolerance = e->request->tolerance};
  PetscCall(MpmOperatorCreate(PETSC_COMM_SELF, layout, &scene->scheme, &scene->step, &op));
  PetscCall(Mismatch(op, &mismatch));
  if (e->nodal) PetscCall(MpmNodalMatrixOf(op, &nodal));
  if (nodal)
    PetscCall(MpmReducedLargest(nodal, value));
  else
    PetscCall(MpmDenseLargest(op->balanced, value));
  f->growth = MpmGrowthPerStep(hypot(value[0], value[1]), op->exponent, op->period);
  PetscCall(MatNorm(op->balanced, NORM_INFINITY, &norm));
  f->defective_error = MpmDefectiveErrorOf(MpmOperatorErrorOf(norm, mismatch, 0), op->exponent, op->period);
  if (!(mismatch <= MPM_MISMATCH)) f->defective_error = INFINITY;
  if (f->growth > 1 + f->tolerance && isfinite(f->growth)) PetscCall(Uncertainty(op, nodal, value, mismatch, f));
  f->verdict = MpmVerdictOf(f);
  PetscCall(MpmReducedDestroy(&nodal));
  PetscCall(MpmOperatorDestroy(&op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode JudgeSeed(void *context, PetscInt i)
{
  MpmEnsemble *e      = context;
  MpmLayout    layout = e->scene->layout;
  MpmFinding   f;

  PetscFunctionBegin;
  layout.seed += i;
  PetscCall(Judge(e, &layout, &f));
  e->growth[i]      = f.growth;
  e->uncertainty[i] = f.uncertainty;
  e->verdict[i]     = f.verdict;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Solve(MpmEnsemble *e)
{
  PetscFunctionBegin;
  PetscCall(MpmFarm("layout", e->n, JudgeSeed, e));
  PetscCall(MpmFarmSumReals(e->n, e->growth));
  PetscCall(MpmFarmSumReals(e->n, e->uncertainty));
  PetscCall(MpmFarmSumInts(e->n, e->verdict));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the smallest, middle and largest growth. */
static PetscErrorCode Spread(MpmEnsemble *e)
{
  PetscReal *sorted;
  PetscInt   n = 0, worst = -1;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(e->n, &sorted));
  for (PetscInt i = 0; i < e->n; i++) {
    if (isnan(e->growth[i])) continue;
    if (worst < 0 || e->growth[i] > e->growth[worst]) worst = i;
    sorted[n++] = e->growth[i];
  }
  PetscCall(PetscSortReal(n, sorted));
  e->growth_min = e->growth_median = e->growth_max = NAN;
  if (n) {
    e->growth_min          = sorted[0];
    e->growth_median       = n % 2 ? sorted[n / 2] : (sorted[n / 2 - 1] + sorted[n / 2]) / 2;
    e->growth_max          = sorted[n - 1];
    e->worst_seed          = e->scene->layout.seed + worst;
    e->finding.uncertainty = e->uncertainty[worst];
  }
  PetscCall(PetscFree(sorted));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Sum(MpmEnsemble *e)
{
  MpmFinding *f = &e->finding;
  PetscReal   if_unstable[2];

  PetscFunctionBegin;
  for (PetscInt i = 0; i < e->n; i++) {
    e->unstable += e->verdict[i] == MPM_UNSTABLE;
    e->undecided += e->verdict[i] == MPM_UNDECIDED;
  }
  e->share = (PetscReal)e->unstable / e->n;
  MpmWilson(e->unstable, e->n, e->interval);
  MpmWilson(e->unstable + e->undecided, e->n, if_unstable);
  e->interval[1] = if_unstable[1];
  PetscCall(Spread(e));
  f->tolerance = e->request->tolerance;
  f->growth    = e->growth_max;
  f->verdict   = e->unstable ? MPM_UNSTABLE : e->undecided ? MPM_UNDECIDED : MPM_STABLE;
  PetscCall(PetscSNPrintf(f->evidence, sizeof f->evidence,
                          "all eigenvalues of %" PetscInt_FMT " random layouts, order %" PetscInt_FMT "%s", e->n,
                          e->nodal ? e->nodal : e->order, e->nodal ? ", of the nodes' own operators" : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEnsembleCreate(const MpmScene *scene, const MpmRequest *request, MpmEnsemble **ensemble)
{
  const PetscReal begin = MPI_Wtime();
  PetscInt        nodal = 0;
  MpmEnsemble    *e;

  PetscFunctionBegin;
  PetscCall(Check(scene, request, &nodal));
  PetscCall(PetscNew(ensemble));
  e          = *ensemble;
  e->scene   = scene;
  e->request = request;
  e->nodal   = nodal;
  e->n       = request->layouts;
  e->order   = (PetscInt)(scene->scheme.table->nstate * scene->layout.particles);
  PetscCall(PetscCalloc3(e->n, &e->growth, e->n, &e->uncertainty, e->n, &e->verdict));
  PetscCall(Solve(e));
  PetscCall(Sum(e));
  e->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEnsembleDestroy(MpmEnsemble **ensemble)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3((*ensemble)->growth, (*ensemble)->uncertainty, (*ensemble)->verdict));
  PetscCall(PetscFree(*ensemble));
  PetscFunctionReturn(PETSC_SUCCESS);
}
