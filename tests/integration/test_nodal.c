/*
   The nodal operator that a plan makes is that of the assembled operator A: with Z the images that nodes have of the
   particles, Z A = M Z. The eigenvalues of M are those of A, but for the numbers that a step multiplies unseen particle
   data by. On a lattice they are the amplification factors of the symbol.
*/
#include "check.h"
#include "analysis/waves.h"
#include "analysis/patch_search.h"
#include "linalg/dense.h"
#include "program/maps.h"
#include "operator/nodal.h"
#include <mpmstab/operator.h>
#include <mpmstab/symbol.h>

#define CLOSE 1e-3 /* eigenvalues so close to a kept number are not compared: 1 is defective */
#define PAIR 1e-4  /* nor those that are so close to each other */

/* ---- the maps of a layout ---- */

static PetscErrorCode DenseOf(Mat matrix, double complex **out)
{
  PetscInt   rows, columns;
  PetscReal *values;

  PetscFunctionBegin;
  PetscCall(MatGetSize(matrix, &rows, &columns));
  PetscCall(PetscMalloc1(rows * columns, &values));
  PetscCall(PetscMalloc1(rows * columns, out));
  PetscCall(MpmDenseCopy(matrix, values));
  for (PetscInt i = 0; i < rows * columns; i++) (*out)[i] = values[i];
  PetscCall(PetscFree(values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MapOf(void *context, const MpmNodalMap *map, double complex out[])
{
  MpmMaps        *maps = context;
  double complex *dense;
  Mat             P, W, matrix;

  PetscFunctionBegin;
  PetscCall(MpmMapsGet(maps, &map->to_nodes, &P));
  if (map->product) {
    PetscCall(MpmMapsGet(maps, &map->to_particles, &W));
    PetscCall(MatMatMult(P, W, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &matrix));
  } else
    PetscCall(MatDuplicate(P, MAT_COPY_VALUES, &matrix));
  PetscCall(DenseOf(matrix, &dense));
  PetscCall(PetscArraycpy(out, dense, maps->slab->nodes * maps->slab->nodes));
  PetscCall(PetscFree(dense));
  PetscCall(MatDestroy(&matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Z: what the images of the plan are of the state, in the units of the polynomial, n x order by columns. */
static PetscErrorCode ImagesOf(const MpmScene *scene, const MpmNodalPlan *plan, MpmMaps *maps, double complex Z[])
{
  const MpmSlab *r = maps->slab;
  const PetscInt n = plan->nimages * r->nodes, particles = (PetscInt)scene->layout.particles;

  PetscFunctionBegin;
  for (PetscInt g = 0; g < plan->nimages; g++)
    for (PetscInt i = 0; i < plan->image[g].n; i++) {
      const MpmOp    *t    = &plan->image[g].term[i];
      const PetscReal unit = t->factor * pow(scene->step.courant, (double)plan->weight[g]);
      double complex *dense;
      Mat             P;

      PetscCall(MpmMapsGet(maps, t, &P));
      PetscCall(DenseOf(P, &dense));
      for (PetscInt p = 0; p < particles; p++)
        for (PetscInt node = 0; node < r->nodes; node++)
          Z[(plan->nstate * p + t->src) * n + g * r->nodes + node] += unit * dense[p * r->nodes + node];
      PetscCall(PetscFree(dense));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nodal operator of a scene at its Courant number. */
static PetscErrorCode Reduced(const MpmScene *scene, const MpmNodalPlan *plan, double complex **M, double complex **Z,
                              PetscInt *n)
{
  MpmSlab         r;
  MpmMaps         maps = {.slab = &r};
  double complex *c[64];
  const PetscReal x = pow(scene->step.courant, (double)plan->stride);

  PetscFunctionBegin;
  PetscCall(MpmSlabOf(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &scene->step, &r));
  *n = plan->nimages * r.nodes;
  for (PetscInt j = 0; j <= plan->degree; j++) PetscCall(PetscMalloc1(*n * *n, &c[j]));
  PetscCall(MpmNodalRun(plan, r.nodes, MapOf, &maps, c));
  PetscCall(PetscCalloc2(*n * *n, M, *n * scene->scheme.table->nstate * (PetscInt)scene->layout.particles, Z));
  for (PetscInt j = plan->degree; j >= 0; j--)
    for (PetscInt i = 0; i < *n * *n; i++) (*M)[i] = (*M)[i] * x + c[j][i];
  PetscCall(ImagesOf(scene, plan, &maps, *Z));
  for (PetscInt j = 0; j <= plan->degree; j++) PetscCall(PetscFree(c[j]));
  PetscCall(MpmMapsDestroy(&maps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- comparisons ---- */

/* The largest entry of Z A - M Z. */
static PetscReal Difference(PetscInt n, PetscInt order, const double complex Z[], const double complex A[],
                            const double complex M[])
{
  PetscReal largest = 0;

  for (PetscInt c = 0; c < order; c++)
    for (PetscInt i = 0; i < n; i++) {
      double complex sum = 0;

      for (PetscInt p = 0; p < order; p++) sum += Z[p * n + i] * A[c * order + p];
      for (PetscInt p = 0; p < n; p++) sum -= M[p * n + i] * Z[c * n + p];
      largest = PetscMax(largest, cabs(sum));
    }
  return largest;
}

static PetscErrorCode Eigenvalues(PetscInt n, const double complex matrix[], double complex value[])
{
  PetscReal *a, *re, *im;
  int        failed;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n * n, &a, n, &re, n, &im));
  for (PetscInt i = 0; i < n * n; i++) a[i] = creal(matrix[i]);
  PetscCall(MpmDenseEigen(n, a, re, im, NULL, &failed));
  CHECK(!failed, "dgeev");
  for (PetscInt i = 0; i < n; i++) value[i] = CMPLX(re[i], im[i]);
  PetscCall(PetscFree3(a, re, im));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsKept(const MpmNodalPlan *plan, double complex value)
{
  for (PetscInt r = 0; r < plan->nstate; r++)
    if (cabs(value - plan->kept[r]) < CLOSE) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscBool IsPair(PetscInt n, const double complex a[], PetscInt i)
{
  for (PetscInt j = 0; j < n; j++)
    if (j != i && cabs(a[j] - a[i]) < PAIR) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* The farthest that a value of one set, but for kept numbers and pairs, is from all of another; each is met once. */
static PetscReal Farthest(const MpmNodalPlan *plan, PetscInt n, const double complex a[], PetscInt m,
                          double complex b[])
{
  PetscReal farthest = 0;

  for (PetscInt i = 0; i < n; i++) {
    PetscInt best = 0;

    if (IsKept(plan, a[i]) || IsPair(n, a, i)) continue;
    for (PetscInt j = 1; j < m; j++)
      if (cabs(b[j] - a[i]) < cabs(b[best] - a[i])) best = j;
    farthest = PetscMax(farthest, cabs(b[best] - a[i]));
    b[best]  = INFINITY;
  }
  return farthest;
}

static PetscErrorCode CheckEigenvalues(const char options[], const MpmNodalPlan *plan, PetscInt n,
                                       const double complex M[], PetscInt order, const double complex A[])
{
  double complex *small, *all, *copy;
  PetscReal       farthest;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n, &small, order, &all, PetscMax(n, order), &copy));
  PetscCall(Eigenvalues(n, M, small));
  PetscCall(Eigenvalues(order, A, all));
  PetscCall(PetscArraycpy(copy, all, order));
  farthest = Farthest(plan, n, small, order, copy);
  CHECK(farthest <= 1e-10, "%s: an eigenvalue of the nodal operator is %.3g from those of all particles", options,
        farthest);
  PetscCall(PetscArraycpy(copy, small, n));
  farthest = Farthest(plan, order, all, n, copy);
  CHECK(farthest <= 1e-10, "%s: an eigenvalue is %.3g from those of the nodal operator", options, farthest);
  PetscCall(PetscFree3(small, all, copy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckScheme(const char scheme[], const char layout[], PetscBool eigenvalues)
{
  char            options[512];
  MpmScene       *scene;
  MpmOperator    *op;
  MpmNodalPlan   *plan;
  double complex *M, *Z, *A;
  PetscInt        n;
  PetscReal       difference;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "%s %s", scheme, layout));
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmNodalPlanCreate(scene->scheme.table, NULL, &plan));
  PetscCall(MpmOperatorCreate(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(Reduced(scene, plan, &M, &Z, &n));
  PetscCall(DenseOf(op->A, &A));
  difference = Difference(n, op->order, Z, A, M);
  CHECK(difference <= 1e-11, "%s: Z A and M Z differ by %.3g", options, difference);
  if (eigenvalues) PetscCall(CheckEigenvalues(options, plan, n, M, op->order, A));
  PetscCall(PetscFree(A));
  PetscCall(PetscFree2(M, Z));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckLayouts(const char scheme[], PetscBool reacts, PetscInt which)
{
  static const char *const line[]  = {"-cells 6 -ppc 3 -jitter 0.9 -courant 0.7",
                                      "-cells 6 -ppc 2 -jitter 0.4 -courant 0.7 -boundary fixed_reaction-fixed",
                                      "-cells 6 -ppc 2 -jitter 0.4 -courant 0.7 -boundary fixed"};
  static const char *const plane[] = {"-dim 2 -cells 4,4 -ppc 2,1 -jitter 0.8 -courant 0.6",
                                      "-dim 2 -cells 3,3 -ppc 1,2 -jitter 0.8 -courant 0.6 -boundary symmetry,fixed"};
  static const char        space[] = "-dim 3 -cells 2,2,2 -ppc 1,2,1 -jitter 0.8 -courant 0.5";

  PetscFunctionBegin;
  PetscCall(CheckScheme(scheme, line[which % 2 ? (reacts ? 1 : 2) : 0], PETSC_TRUE));
  PetscCall(CheckScheme(scheme, plane[which % 2], which % 7 == 0 ? PETSC_TRUE : PETSC_FALSE));
  if (which % 9 == 0) PetscCall(CheckScheme(scheme, space, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckAll(void)
{
  PetscInt which = 0;

  PetscFunctionBegin;
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (PetscInt t = 0; MpmTransfers[t]; t++)
      for (PetscInt b = 0; MpmBases[b]; b++)
        for (int mls = 0; mls < 2; mls++, which++) {
          const PetscBool grad = MpmFormulationHas(MpmFormulations[f], MPM_GRAD);
          char            scheme[256];

          if (MpmTransfers[t]->affine && MpmFormulations[f]->affine == MPM_NONE) continue;
          if (mls && !grad) continue;
          if (MpmFormulationHas(MpmFormulations[f], MPM_IMPLICIT)) continue; /* no sum of products of nodes */
          PetscCall(PetscSNPrintf(scheme, sizeof scheme, "-formulation %s -transfer %s -basis %s %s",
                                  MpmFormulations[f]->name, MpmTransfers[t]->name, MpmBases[b]->name,
                                  mls ? "-gradient mls" : ""));
          PetscCall(CheckLayouts(scheme, MpmFormulationHas(MpmFormulations[f], MPM_REACT), which));
        }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number of images, that is of unknowns a node. */
static PetscErrorCode CheckImages(const char options[], PetscInt expected)
{
  MpmScene     *scene;
  MpmNodalPlan *plan;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmNodalPlanCreate(scene->scheme.table, NULL, &plan));
  CHECK(plan->nimages == expected, "%s: %d images", options, (int)plan->nimages);
  CHECK(plan->stride == 2, "%s: odd powers of the Courant number", options);
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* On a lattice without ends the nodal operator of a phase has the growth of the symbol. */
static PetscErrorCode CheckSymbolOf(const char options[])
{
  static const PetscReal beta[2][MPM_MAX_DIM] = {{1.9, -1.1, 0.7}, {1.2, 2.2, -0.9}};
  MpmScene              *scene;
  MpmNodalPlan          *plan;
  MpmCriticalCase        of;
  MpmPatchLattice        lattice = {.depth = 0};
  PetscReal              growth, rounding, symbol;
  MpmWaves               waves;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmNodalPlanCreate(scene->scheme.table, NULL, &plan));
  of           = MpmCriticalCaseOf(scene, 1e-6);
  lattice.of   = &of;
  lattice.plan = plan;
  PetscCall(MpmWavesCreate(&scene->layout, &scene->scheme, scene->step.drift, &waves));
  for (int b = 0; b < 2; b++) {
    MpmPatchSpot spot = {.j = {0}};

    for (PetscInt a = 0; a < scene->layout.dim; a++) {
      spot.t[a]    = scene->layout.offset[a].value;
      spot.beta[a] = beta[b][a];
    }
    PetscCall(MpmPatchGrowth(&lattice, &spot, scene->step.courant, &growth, &rounding));
    PetscCall(MpmWavesGrowth(&waves, scene->step.courant, beta[b], &symbol));
    CHECK(symbol > 1.01, "%s: growth %.9g shows nothing", options, symbol);
    CHECK_NEAR(growth, symbol, 1e-11 * symbol);
  }
  PetscCall(MpmWavesDestroy(&waves));
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckLattices(void)
{
  PetscFunctionBegin;
  PetscCall(CheckImages("-cells 4 -formulation usl", 2));
  PetscCall(CheckImages("-cells 4 -formulation usl -transfer xpic", 2));
  PetscCall(CheckImages("-dim 2 -cells 4 -formulation musl -transfer apic", 4));
  PetscCall(CheckImages("-dim 3 -cells 4 -formulation usavg -transfer blend", 6));
  PetscCall(CheckImages("-dim 3 -cells 4 -formulation gas2", 4));
  PetscCall(CheckImages("-cells 4 -formulation elastic", 2));
  PetscCall(CheckSymbolOf("-cells 4 -formulation usl -courant 2.5 -offset 0.3"));
  PetscCall(CheckSymbolOf("-dim 2 -cells 4 -formulation usf -courant 6 -ppc 2,3 -transfer apic -basis quadratic"));
  PetscCall(CheckSymbolOf("-dim 2 -cells 4 -formulation elastic -courant 9 -transfer xpic -basis cubic"));
  PetscCall(CheckSymbolOf("-dim 3 -cells 4 -formulation musl -courant 12 -ppc 1,2,1 -offset 0.3,0.1,0.6 -basis gimp"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(CheckLattices());
  PetscCall(CheckAll());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
