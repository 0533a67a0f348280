/*
   A basis that is not in the list, with NODES nodes a direction: B-splines of degree NODES - 1, by the recursion for
   uniform knots. Its weights have closed forms; symbol, spectrum and march agree; A q = march(q) in one, two and three
   dimensions; and the limits of a lone particle, of an edge and of random layouts are those of assembled operators.
*/
#include "scheme/basis/nodes.h"
#include "analysis/lone.h"
#include "analysis/neighbourhood.h"
#include "analysis/spectrum.h"
#include "linalg/dense.h"
#include "operators.h"
#include "scheme/maps.h"

#define DEGREE (NODES - 1)
#define MOMENT (NODES / 12.0) /* the variance of a sum of NODES boxes */

/* ---- the basis ---- */

/* Nodes are knots if the degree is odd. If it is even, knots are the middles of cells. */
static inline PetscReal AfterKnot(PetscReal xi)
{
  return DEGREE % 2 ? xi : xi < 0.5 ? xi + 0.5 : xi - 0.5;
}

static inline PetscInt First(PetscReal xi)
{
  return DEGREE % 2 || xi < 0.5 ? -(DEGREE / 2) : 1 - DEGREE / 2;
}

/* w[m] = M(u + m), with M the B-spline of a degree on [0, degree + 1]. */
static inline void Cardinal(int degree, PetscReal u, PetscReal w[NODES])
{
  for (int m = 0; m < NODES; m++) w[m] = m == 0;
  for (int q = 1; q <= degree; q++)
    for (int m = q; m >= 0; m--) w[m] = ((u + m) * w[m] + (m ? (q + 1 - u - m) * w[m - 1] : 0)) / q;
}

/* Differences of splines of a lower degree are the derivatives. The leftmost node's spline is the one that ends. */
static inline void Differences(int order, PetscReal xi, PetscReal weight[NODES])
{
  PetscReal w[NODES];

  Cardinal(DEGREE - order, AfterKnot(xi), w);
  for (int o = 0; o < order; o++)
    for (int m = DEGREE; m > 0; m--) w[m] -= w[m - 1];
  for (int d = 0; d < NODES; d++) weight[d] = w[DEGREE - d];
}

static inline void Values(PetscReal xi, PetscReal phi[NODES])
{
  Differences(0, xi, phi);
}

static inline void Slopes(PetscReal xi, PetscReal slope[NODES])
{
  Differences(1, xi, slope);
}

static inline void Curves(PetscReal xi, PetscReal curve[NODES])
{
  Differences(2, xi, curve);
}

static const MpmBasis wide = {.name        = "wide",
                              .summary     = "B-splines of a degree that the list does not have",
                              .reference   = "Schoenberg 1946",
                              .reach_left  = DEGREE / 2,
                              .reach_right = NODES / 2 + NODES % 2,
                              .slope_sum   = 2,
                              .curve_sum   = 8,
                              .moment      = MOMENT,
                              .smooth      = PETSC_TRUE,
                              KERNELS};

/* ---- its weights ---- */

/* Sets a row of weights of a particle, and returns the sum of their sizes. */
static PetscReal Row(MpmOpKind kind, PetscReal xi, PetscReal row[])
{
  PetscReal sum = 0;

  MpmMapRow(&wide, kind, xi, 0.5, MpmNoWalls, row);
  for (PetscInt d = 0; d < MpmMapReach(&wide); d++) sum += fabs(row[d]);
  return sum;
}

/* A row is the derivative of another: row[d] = (next - before) / (2 step). */
static void CheckDerivative(MpmOpKind kind, MpmOpKind of, PetscReal xi)
{
  const PetscReal step = 1e-5;
  PetscReal       row[MPM_MAX_REACH], next[MPM_MAX_REACH], before[MPM_MAX_REACH];

  (void)Row(kind, xi, row);
  (void)Row(of, xi + step, next);
  (void)Row(of, xi - step, before);
  for (PetscInt d = 0; d < MpmMapReach(&wide); d++) CHECK_NEAR(row[d], (next[d] - before[d]) / (2 * step), 1e-8);
}

static void CheckSums(PetscReal xi)
{
  PetscReal phi[MPM_MAX_REACH], row[MPM_MAX_REACH], sum[5] = {0};

  CHECK_NEAR(Row(MPM_P2G, xi, phi), 1, 1e-14);
  CHECK(Row(MPM_DIV, xi, row) <= wide.slope_sum && Row(MPM_CURVE_MLS, xi, row) <= wide.curve_sum &&
            Row(MPM_CURVE, xi, row) <= wide.curve_sum,
        "bounds at %g", xi);
  (void)Row(MPM_G2P_AFFINE, xi, row);
  for (PetscInt d = 0; d < MpmMapReach(&wide); d++) {
    const PetscReal r = (PetscReal)(d - wide.reach_left) - xi;

    sum[0] += phi[d];
    sum[1] += phi[d] * r;
    sum[2] += phi[d] * r * r;
    sum[3] += row[d];
    sum[4] += row[d] * r;
  }
  CHECK_NEAR(sum[0], 1, 1e-14);
  CHECK_NEAR(sum[1], 0, 1e-14);
  CHECK_NEAR(sum[2], MOMENT, 1e-14);
  CHECK_NEAR(sum[3], 0, 1e-14);
  CHECK_NEAR(sum[4], 1, 1e-14);
}

/* On a node, by hand; and on either side of the middle of a cell, where the quartic's first node changes. */
static void CheckWeights(void)
{
  static const PetscReal on_node[2][4] = {{115.0 / 192, 19.0 / 96, 1.0 / 384, 0},
                                          {66.0 / 120, 26.0 / 120, 1.0 / 120, 0}};
  PetscReal              phi[MPM_MAX_REACH];

  (void)Row(MPM_P2G, 0, phi);
  for (PetscInt d = 0; d < MpmMapReach(&wide); d++)
    CHECK_NEAR(phi[d], on_node[DEGREE % 2][PetscAbsInt(d - wide.reach_left)], 1e-15);
  for (PetscInt i = 0; i < 40; i++) {
    const PetscReal xi = (i + 0.3) / 40;

    CheckSums(xi);
    CheckDerivative(MPM_DIV, MPM_P2G, xi);
    CheckDerivative(MPM_CURVE, MPM_DIV, xi);
    CheckDerivative(MPM_CURVE_MLS, MPM_DIV_MLS, xi);
  }
  CheckSums(0);
  CheckSums(0.5);
  CheckDerivative(MPM_DIV, MPM_P2G, 0.5);
  CheckDerivative(MPM_CURVE, MPM_DIV, 0.5);
}

/* What does not fit into arrays, and weights that nothing would read. */
static PetscErrorCode CheckRefusals(void)
{
  MpmBasis basis[3] = {wide, wide, wide};

  PetscFunctionBegin;
  PetscCall(MpmBasisCheck(&wide));
  basis[0].nodes = MPM_MOST_NODES + 1;
  basis[1].reach_left += MPM_MOST_NODES;
  basis[2].reach_right--;
  PetscCall(PetscPushErrorHandler(PetscIgnoreErrorHandler, NULL));
  for (size_t i = 0; i < 3; i++)
    CHECK(MpmBasisCheck(&basis[i]) == PETSC_ERR_ARG_OUTOFRANGE, "wrong basis %d is accepted", (int)i);
  PetscCall(PetscPopErrorHandler());
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- its scenes ---- */

static PetscErrorCode SceneOf(const char task[], const char options[], MpmScene **scene)
{
  PetscFunctionBegin;
  PetscCall(CheckSceneOf(task, options, scene));
  (*scene)->scheme.basis = &wide;
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define SPLINE "-basis cubic " /* has as many nodes between walls */

static PetscErrorCode CheckMarches(void)
{
  static const char *const scenes[] = {
      SPLINE "-formulation usl -cells 16",
      SPLINE "-formulation musl -transfer apic -cells 16 -jitter 0.7",
      SPLINE "-formulation usl -transfer apic -cells 16 -ppc 1 -drift 2/3",
      SPLINE "-formulation usl -cells 9 -boundary fixed,free",
      SPLINE "-formulation usl -transfer apic -dim 2 -cells 9,10",
      SPLINE "-formulation musl -transfer flip -dim 2 -cells 9,10 -ppc 3,2 -offset 0",
      SPLINE "-formulation musl -transfer apic -gradient mls -dim 2 -cells 10,9 -jitter 0.8 -ppc 1,2",
      SPLINE "-formulation usl -dim 2 -cells 9,10 -ppc 1 -drift 1/2,-1/3 -courant 0.1",
      SPLINE "-formulation musl -dim 2 -cells 9,10 -boundary fixed,symmetry-free -jitter 0.5",
      SPLINE "-formulation usl -transfer xpic -dim 2 -cells 9 -boundary symmetry,free-fixed",
      SPLINE "-formulation usl -transfer apic -dim 3 -cells 8,4,5 -ppc 1",
      SPLINE "-formulation musl -dim 3 -cells 8,5,4 -ppc 1 -jitter 0.7",
      SPLINE "-formulation usl -transfer apic -gradient mls -dim 3 -cells 4,8,4 -ppc 1 -jitter 0.7 -boundary "
             "fixed,periodic,free",
      SPLINE "-formulation usl -dim 3 -cells 8,4,4 -ppc 1 -drift 1/2,0,1/2 -courant 0.1"};

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(scenes); i++) {
    MpmScene *scene;

    PetscCall(SceneOf("run", scenes[i], &scene));
    PetscCall(CheckOperatorOf(scene, scenes[i], 1e-13));
    PetscCall(MpmSceneDestroy(&scene));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Measured growth, the spectrum and, of a uniform layout, the symbol agree. */
static PetscErrorCode CheckGrowth(const char options[])
{
  MpmScene    *scene;
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(SceneOf("spectrum", options, &scene));
  PetscCall(MpmSpectrumCreate(scene, &check_request, 0, &s));
  CHECK(s->step_mismatch <= 1e-13 * s->op->period, "%s: A q and march(q) differ by %.3g", options, s->step_mismatch);
  CHECK(s->growth > 1.01, "%s: growth %.9g", options, s->growth);
  CHECK((s->symbol != NULL) == (scene->layout.jitter == 0), "%s: symbol", options);
  CHECK(!s->symbol || (fabs(s->symbol->growth - s->growth) <= 1e-9 && s->symbol_mismatch <= 1e-6),
        "%s: symbol %.12g, spectrum %.12g, off the symbol's set by %.3g", options, s->symbol ? s->symbol->growth : 0,
        s->growth, s->symbol_mismatch);
  CHECK(s->run && s->run->growth.measured && fabs(log(s->run->growth.per_step) / log(s->growth) - 1) <= 0.02,
        "%s: measured %.9g, spectrum %.9g", options, s->run ? s->run->growth.per_step : NAN, s->growth);
  PetscCall(MpmSpectrumDestroy(&s));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define MEASURED SPLINE "-steps 600 "

static PetscErrorCode CheckGrowths(void)
{
  static const char *const scenes[] = {MEASURED "-formulation usl -cells 16 -courant 2",
                                       MEASURED "-formulation musl -transfer apic -cells 16 -courant 3",
                                       MEASURED
                                       "-formulation usl -transfer apic -cells 16 -ppc 1 -drift 1/2 -courant 2.4",
                                       MEASURED "-formulation usl -cells 16 -jitter 0.6 -courant 2.2",
                                       MEASURED "-formulation usl -transfer apic -dim 2 -cells 8,9 -ppc 1 -courant 2.4",
                                       MEASURED "-formulation musl -dim 2 -cells 8 -ppc 1 -jitter 0.6 -courant 4",
                                       MEASURED "-formulation usl -dim 3 -cells 4 -ppc 1 -courant 2 -steps 300"};
  PetscMPIInt              size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(scenes); i++)
    if (size == 1 || !strstr(scenes[i], "-cells 4")) PetscCall(CheckGrowth(scenes[i])); /* too few cells for two */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- its limits ---- */

static PetscErrorCode AssembledGrowth(const MpmScene *scene, PetscReal courant, PetscReal *growth)
{
  MpmStep      step = scene->step;
  MpmOperator *op;
  PetscReal    value[2];

  PetscFunctionBegin;
  step.courant = courant;
  PetscCall(MpmOperatorCreate(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &step, &op));
  PetscCall(MpmDenseLargest(op->balanced, value));
  *growth = MpmGrowthPerStep(hypot(value[0], value[1]), op->exponent, 1);
  PetscCall(MpmOperatorDestroy(&op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The assembled operator grows above a limit, and not below. Its grid may not have the wave that grows first. */
static PetscErrorCode CheckLimit(const char options[], PetscReal limit, PetscReal within)
{
  MpmScene *scene;
  PetscReal below, above;

  PetscFunctionBegin;
  PetscCall(SceneOf("run", options, &scene));
  PetscCall(AssembledGrowth(scene, limit * (1 - 1e-6), &below));
  PetscCall(AssembledGrowth(scene, limit * (1 + within), &above));
  CHECK(below <= 1 + 1e-6 && above > 1 + 1e-4, "%s: limit %.9g, growth %.9g below, %.9g above", options, limit, below,
        above);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* 2 sqrt(D / chi) and sqrt(2 D / chi), with chi = 1 + (dim - 1) nu / (1 - nu). */
static PetscErrorCode CheckLone(const char options[], PetscReal limit)
{
  char             all[256];
  MpmScene        *scene;
  MpmNeighbourhood lone;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(all, sizeof all, SPLINE "-ppc 1 -gradient mls -cells 9 -fill 4,5 %s", options));
  PetscCall(SceneOf("run", all, &scene));
  PetscCall(MpmLoneFind(&scene->layout, &scene->scheme, 1, &lone));
  CHECK(lone.closed && fabs(lone.courant / limit - 1) <= 1e-9, "%s: %.12g, not %.12g", options, lone.courant, limit);
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(CheckLimit(all, limit, 1e-4));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The bulk's closed form is what the search finds, and no grid grows below it. */
static PetscErrorCode CheckBulk(const char options[], PetscReal within)
{
  MpmScene       *scene;
  MpmCriticalCase of;
  MpmCritical     c;

  PetscFunctionBegin;
  PetscCall(SceneOf("run", options, &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &c));
  CHECK(!c.disputed && fabs(c.courant / c.closed - 1) <= 1e-6, "%s: limit %.9g, closed form %.9g", options, c.courant,
        c.closed);
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(CheckLimit(options, c.courant, within));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An edge: the bar whose surface is at the worst place has its limit. */
static PetscErrorCode CheckEdge(const char options[])
{
  char             all[256];
  MpmScene        *scene;
  MpmCriticalCase  of;
  MpmNeighbourhood edge;

  PetscFunctionBegin;
  PetscCall(SceneOf("run", options, &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmPatchFind(&of, MPM_AT_EDGE, &edge));
  PetscCall(MpmSceneDestroy(&scene));
  CHECK(edge.courant > 0 && edge.courant < 4, "%s: edge %g", options, edge.courant);
  PetscCall(PetscSNPrintf(all, sizeof all, "%s -cells 40 -fill 5,35 -offset %.17g", options, edge.place[0]));
  PetscCall(CheckLimit(all, edge.courant, 1e-3));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Random layouts without voids are those of a jittered scene. */
static PetscErrorCode CheckRandom(const char options[])
{
  char             all[256];
  MpmScene        *scene;
  MpmRandomLayouts asked   = {.n = 1, .seed = 5};
  MpmNeighbourhood layouts = {.kind = MPM_AT_RANDOM};
  MpmCriticalCase  of;
  PetscReal        growth;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(all, sizeof all, SPLINE "%s -ppc 1 -jitter 0.8 -seed 5 -courant 2.2", options));
  PetscCall(SceneOf("run", all, &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmRandomLayoutsFind(&of, &asked, &layouts));
  PetscCall(AssembledGrowth(scene, 2.2, &growth));
  CHECK(growth > 1.01 && fabs(layouts.growth / growth - 1) <= 1e-6, "%s: %.9g, not %.9g", options, layouts.growth,
        growth);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckLimits(void)
{
  PetscFunctionBegin;
  PetscCall(CheckLone("-formulation usl -transfer apic", 2 * sqrt(MOMENT)));
  PetscCall(CheckLone("-formulation musl -transfer apic -dim 2 -poisson 0.5", 2 * sqrt(MOMENT / 2)));
  PetscCall(CheckLone("-formulation usl -transfer flip -dim 2 -poisson 0.3", sqrt(2 * MOMENT * 0.7)));
  PetscCall(CheckLone("-formulation usl -transfer apic -dim 3 -poisson 0.5", 2 * sqrt(MOMENT / 3)));
  PetscCall(CheckBulk(SPLINE "-formulation usl -cells 32", 0.02));
  PetscCall(CheckBulk(SPLINE "-formulation musl -transfer apic -cells 32", 0.02));
  PetscCall(CheckBulk(SPLINE "-formulation usl -transfer apic -dim 2 -cells 8 -ppc 1", 0.05));
  PetscCall(CheckEdge(SPLINE "-formulation usl -ppc 2"));
  PetscCall(CheckRandom("-formulation usl -cells 24"));
  PetscCall(CheckRandom("-formulation usl -transfer apic -dim 2 -cells 6"));
  PetscCall(CheckRandom("-formulation usl -dim 3 -cells 3"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  const PetscMPIInt size = MpmRanksOf(PETSC_COMM_WORLD);

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(SlepcInitializeNoArguments());
  CheckWeights();
  PetscCall(CheckRefusals());
  PetscCall(CheckMarches());
  PetscCall(CheckGrowths());
  if (size == 1) PetscCall(CheckLimits());
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
