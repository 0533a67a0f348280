/*
   Patches: the limit of a lone particle is that of its closed form. The limit of an edge or a corner is that of an
   assembled block of particles with the same surfaces, and on any number of ranks that of the place that is reported.
*/
#include "check.h"
#include "analysis/critical_parts.h"
#include "analysis/neighbourhood.h"
#include "analysis/patch_search.h"
#include "linalg/dense.h"
#include <mpmstab/operator.h>

#define TOLERANCE 1e-6

static PetscErrorCode FindPatch(const char options[], MpmNeighbourhoodKind kind, MpmNeighbourhood *limit)
{
  MpmScene       *scene;
  MpmCriticalCase of;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  of = MpmCriticalCaseOf(scene, TOLERANCE);
  PetscCall(MpmPatchFind(&of, kind, limit));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- lone particles ---- */

static PetscErrorCode CheckLone(const char options[], PetscReal expected, PetscBool approached)
{
  MpmNeighbourhood limit;

  PetscFunctionBegin;
  PetscCall(FindPatch(options, MPM_ALONE, &limit));
  if (isinf(expected))
    CHECK(isinf(limit.courant), "%s: %g", options, limit.courant);
  else
    CHECK_NEAR(limit.courant, expected, 1e-9);
  CHECK(limit.approached == approached && !limit.inside, "%s: approached %d", options, limit.approached);
  CHECK(limit.evaluations > 0, "%s", options);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* chi = 1 + (dim - 1) nu / (1 - nu); D = 1/4 for quadratics and 1/3 for cubics */
static PetscErrorCode CheckLones(void)
{
  const PetscReal chi = 1 + 0.3 / 0.7;

  PetscFunctionBegin;
#define MLS "-cells 8 -formulation usl -gradient mls -poisson 0.3 "
  PetscCall(CheckLone(MLS "-dim 2 -transfer apic -basis quadratic", 2 * sqrt(0.25 / chi), PETSC_FALSE));
  PetscCall(CheckLone(MLS "-dim 2 -transfer apic -basis cubic", 2 * sqrt(1 / (3 * chi)), PETSC_FALSE));
  PetscCall(
      CheckLone(MLS "-dim 3 -transfer apic -basis quadratic -ppc 1", 2 * sqrt(0.25 / (2 * chi - 1)), PETSC_FALSE));
  PetscCall(CheckLone(MLS "-dim 2 -transfer flip -basis quadratic", sqrt(0.5 / chi), PETSC_FALSE));
  PetscCall(CheckLone(MLS "-dim 2 -transfer pic -basis quadratic", sqrt(0.5 / chi), PETSC_FALSE));
  PetscCall(CheckLone("-cells 8 -formulation usl", 0, PETSC_TRUE));
  /* it never feels its own stress */
  PetscCall(CheckLone("-cells 8 -formulation usf -basis quadratic", INFINITY, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   A place exactly on a face of a cell counts. On a node hats lose the share of the next node. Half-way between nodes a
   quadratic spline is two hats of a particle in the middle. The limits are those of the assembled operator.
*/
static PetscErrorCode CheckFaces(void)
{
  PetscFunctionBegin;
  PetscCall(CheckLone("-cells 8 -formulation gas1", 0, PETSC_FALSE));
  PetscCall(CheckLone("-cells 8 -formulation gas2", 0, PETSC_FALSE));
  PetscCall(CheckLone("-dim 2 -cells 8 -formulation gas2 -transfer pic -basis quadratic -gradient mls", INFINITY,
                      PETSC_FALSE));
  PetscCall(CheckLone("-cells 8 -formulation elastic", M_SQRT2, PETSC_FALSE));
  PetscCall(CheckLone("-cells 8 -formulation elastic -basis quadratic", 2, PETSC_FALSE));
  PetscCall(CheckLone("-cells 8 -formulation musl", 2, PETSC_FALSE));
  PetscCall(CheckLone("-dim 2 -cells 8 -formulation musl -poisson 0.3", M_SQRT2, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A lone hat particle at xi is stable up to k = sqrt(2 xi (1 - xi)). */
static PetscErrorCode CheckHats(void)
{
  MpmScene       *scene;
  MpmNodalPlan   *plan;
  MpmCriticalCase of;
  MpmPatchLattice lattice = {.end = {MPM_PATCH_SINGLE}};

  PetscFunctionBegin;
  PetscCall(CheckScene("-cells 8 -ppc 1 -formulation usl", &scene));
  PetscCall(MpmNodalPlanCreate(scene->scheme.table, NULL, &plan));
  CHECK(plan->nimages == 2 && plan->stride == 2 && plan->degree == 1, "usl has %d images", (int)plan->nimages);
  of           = MpmCriticalCaseOf(scene, TOLERANCE);
  lattice.of   = &of;
  lattice.plan = plan;
  for (PetscReal xi = 0.1; xi < 1; xi += 0.1) {
    const MpmPatchSpot spot = {.t = {xi}};
    PetscReal          k;

    PetscCall(MpmPatchCrossing(&lattice, &spot, &k));
    CHECK_NEAR(k, sqrt(2 * xi * (1 - xi)), 1e-12);
  }
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of 64 nodes a lone particle knows four fields, its weights and their gradients. All others keep their stress. */
static PetscErrorCode CheckFields(void)
{
  const MpmPatchSpot spot    = {.t = {0.2, 0.3, 0.4}};
  MpmPatchLattice    lattice = {.end = {MPM_PATCH_SINGLE, MPM_PATCH_SINGLE, MPM_PATCH_SINGLE}};
  MpmCluster         cluster;
  MpmScene          *scene;
  MpmNodalPlan      *plan;
  MpmCriticalCase    of;
  double complex    *coefficient[64];
  PetscReal          unseen;
  PetscInt           n;

  PetscFunctionBegin;
  PetscCall(CheckScene("-dim 3 -cells 8 -ppc 1 -formulation usl -transfer pic -basis cubic", &scene));
  PetscCall(MpmNodalPlanCreate(scene->scheme.table, NULL, &plan));
  of           = MpmCriticalCaseOf(scene, TOLERANCE);
  lattice.of   = &of;
  lattice.plan = plan;
  PetscCall(MpmPatchCluster(&lattice, &spot, &cluster));
  PetscCall(MpmClusterOperator(&cluster, &n, coefficient, &unseen));
  PetscCall(MpmClusterDestroy(&cluster));
  CHECK(n == 4 * plan->nimages, "%d unknowns of %d images", (int)n, (int)plan->nimages);
  CHECK(unseen == 1, "other fields are multiplied by %g", unseen);
  for (PetscInt j = 0; j <= plan->degree; j++) PetscCall(PetscFree(coefficient[j]));
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- surfaces ---- */

/* The limit of the surface of a scene's lattice whose first particle is at (j + t) / ppc in its cell, in each direction. */
static PetscErrorCode LimitAt(const MpmScene *scene, PetscInt surfaces, PetscInt j, PetscReal t, PetscReal *limit)
{
  const MpmCriticalCase of      = MpmCriticalCaseOf(scene, TOLERANCE);
  const MpmPatchSpot    spot    = {.j = {j, j}, .t = {t, t}};
  MpmPatchLattice       lattice = {.of = &of, .depth = scene->layout.dim == 1 ? 60 : 5};
  MpmScheme             open    = scene->scheme;
  MpmNodalPlan         *plan;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) open.space.ends[a][0] = open.space.ends[a][1] = MPM_PERIODIC;
  for (PetscInt a = 0; a < surfaces; a++) lattice.end[a] = MPM_PATCH_SURFACE;
  PetscCall(MpmTableCreate(open.formulation, open.transfer, &open.numbers, &open.space, &open.table));
  PetscCall(MpmNodalPlanCreate(open.table, NULL, &plan));
  lattice.plan = plan;
  PetscCall(MpmPatchCrossing(&lattice, &spot, limit));
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscCall(MpmTableDestroy(&open.table));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AssembledGrowth(const MpmScene *scene, PetscReal courant, PetscReal *growth)
{
  MpmStep      step = scene->step;
  MpmOperator *op;
  PetscReal    value[2];

  PetscFunctionBegin;
  step.courant = courant;
  PetscCall(MpmOperatorCreate(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &step, &op));
  PetscCall(MpmDenseLargest(op->A, value));
  *growth = hypot(value[0], value[1]);
  PetscCall(MpmOperatorDestroy(&op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   A block of particles in the middle of a grid, without its first ones so that its surfaces stand anywhere in their
   cells. Its limit is the lesser one of its left surface, which begins at site first, and of the image of its right
   one. It is met to within: waves inside of a block have slightly other lengths.
*/
static PetscErrorCode CheckBlock(const char options[], PetscInt first, PetscReal within)
{
  MpmScene *scene;
  PetscReal left, right, limit, below, above;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCheck(scene->layout.dim == 2 || scene->layout.first[0] > 0, PETSC_COMM_SELF, PETSC_ERR_PLIB, "no surface");
  if (scene->layout.dim == 1) {
    scene->layout.first[0] += first;
    scene->layout.row[0] -= first;
    scene->layout.particles -= first;
  }
  PetscCall(LimitAt(scene, scene->layout.dim, first, scene->layout.offset[0].value, &left));
  PetscCall(LimitAt(scene, scene->layout.dim, 0, 1 - scene->layout.offset[0].value, &right));
  limit = PetscMin(left, right);
  PetscCall(AssembledGrowth(scene, limit * (1 - within), &below));
  PetscCall(AssembledGrowth(scene, limit * (1 + within), &above));
  CHECK(below <= 1 + TOLERANCE && above > 1 + TOLERANCE, "%s, from site %d: limit %.9g, growth %.9g below, %.9g above",
        options, (int)first, limit, below, above);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An edge mode that fades in 20 cells, next to the limit of the bulk: 1.43204, 1.55003 and 1.46099. */
static const struct {
  const char *options;
  PetscReal   courant;
} slow[] = {{"-formulation musl -basis gimp -ppc 3 -transfer pic", 1.427700},
            {"-formulation usf -basis gimp -ppc 3 -transfer xpic -xpic_order 2", 1.544590},
            {"-formulation usavg -basis gimp -ppc 3 -transfer blend -blend_ratio 0.1", 1.456720}};

static PetscErrorCode CheckBlocks(void)
{
  static const char *const schemes[] = {
      "-formulation usl -basis quadratic", "-formulation usl -transfer apic",
      "-formulation musl -basis gimp",     "-formulation usf -transfer pic -basis quadratic -gradient mls",
      "-formulation usavg -basis cubic",   "-formulation usl -transfer xpic -basis gimp"};

  PetscFunctionBegin;
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(schemes); s++)
    for (PetscInt first = 0; first < 2; first++) {
      char options[256];

      PetscCall(PetscSNPrintf(options, sizeof options, "%s -cells 26 -ppc 2 -fill 3,23 -boundary fixed -offset %s",
                              schemes[s], s % 2 ? "0.4" : "0.1"));
      PetscCall(CheckBlock(options, first, 1e-3));
    }
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(slow); s++) {
    char options[256];

    PetscCall(PetscSNPrintf(options, sizeof options, "%s -cells 58 -fill 3,55 -boundary fixed", slow[s].options));
    PetscCall(CheckBlock(options, 2, 1e-4));
  }
  PetscCall(CheckBlock("-dim 2 -cells 8 -ppc 2 -fill 1,6 -formulation usl -transfer apic -gradient mls "
                       "-basis quadratic -poisson 0.5", /* a block of Taichi's mpm88 */
                       0, 1e-3));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the search ---- */

/* What the search reports is the limit of its place, and no place nearby or elsewhere on a row is worse. */
static PetscErrorCode CheckEdge(const char options[])
{
  MpmScene        *scene;
  MpmNeighbourhood limit;
  PetscReal        there;

  PetscFunctionBegin;
  PetscCall(FindPatch(options, MPM_AT_EDGE, &limit));
  PetscCall(CheckScene(options, &scene));
  CHECK(isnan(limit.beta[0]) && limit.growth <= 1 + TOLERANCE, "%s: growth %g", options, limit.growth);
  for (PetscInt i = 0; i < 64; i++) {
    const PetscReal place = (PetscReal)scene->layout.ppc[0] * (i + 0.5) / 64;

    PetscCall(LimitAt(scene, 1, (PetscInt)place, place - floor(place), &there));
    CHECK(limit.courant <= there * (1 + 1e-9), "%s: %.9g, but %.9g at %g", options, limit.courant, there, place);
  }
  if (!limit.approached && !limit.inside) {
    const PetscReal place = (PetscReal)scene->layout.ppc[0] * limit.place[0];

    PetscCall(LimitAt(scene, 1, (PetscInt)place, place - floor(place), &there));
    CHECK_NEAR(limit.courant, there, 1e-7);
  }
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckSlow(void)
{
  PetscFunctionBegin;
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(slow); s++) {
    MpmNeighbourhood edge;

    PetscCall(FindPatch(slow[s].options, MPM_AT_EDGE, &edge));
    CHECK_NEAR(edge.courant, slow[s].courant, 1e-6);
    CHECK_NEAR(edge.place[0], 5.0 / 6, 1e-5);
    CHECK(!edge.inside, "%s", slow[s].options);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a lattice has of its other end is no limit: of elastic a mode there, of gas2 waves that come back from there. */
static PetscErrorCode CheckOtherEnd(void)
{
  MpmNeighbourhood edge;

  PetscFunctionBegin;
  PetscCall(FindPatch("-formulation elastic -transfer pic -basis gimp -ppc 1", MPM_AT_EDGE, &edge));
  CHECK(isnan(edge.courant) && isnan(edge.growth), "elastic: %g, growth %g", edge.courant, edge.growth);
  PetscCall(FindPatch("-formulation gas2 -transfer pic -basis gimp -ppc 1", MPM_AT_EDGE, &edge));
  CHECK_NEAR(edge.courant, 2.099800, 1e-5); /* that of the bulk */
  CHECK(edge.inside && edge.places > 0 && edge.depth >= 40, "gas2: %d places", (int)edge.places);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckSearch(void)
{
  static const char *const edges[] = {
      "-formulation musl -basis cubic -transfer pic -ppc 2",
      "-formulation usavg -basis cubic -ppc 4",
      "-formulation musl -basis quadratic -gradient mls -ppc 3",
      "-formulation usf -basis gimp -gradient mls -transfer xpic -ppc 3",
      "-formulation musl -basis cubic -gradient mls -transfer blend -blend_ratio 0.1 -ppc 2",
      "-formulation musl -basis gimp -gradient mls -transfer blend -blend_ratio 0.1 -ppc 4"};
  MpmNeighbourhood edge, corner, lone;

  PetscFunctionBegin;
  for (size_t e = 0; e < PETSC_STATIC_ARRAY_LENGTH(edges); e++) PetscCall(CheckEdge(edges[e]));
  PetscCall(CheckEdge("-cells 8 -courant 0.3 -formulation usl -basis quadratic"));
  PetscCall(CheckEdge("-cells 8 -courant 0.3 -formulation usl -basis cubic -transfer apic"));
  PetscCall(CheckEdge("-cells 8 -courant 0.3 -formulation usf -basis gimp -ppc 3"));
  PetscCall(FindPatch("-cells 8 -formulation usl", MPM_AT_EDGE, &edge));
  CHECK(edge.courant == 0 && edge.approached && isinf(edge.growth), "hats: %g, growth %g", edge.courant, edge.growth);
  PetscCall(FindPatch("-cells 8 -formulation gas1", MPM_AT_EDGE, &edge));
  CHECK(edge.courant == 0 && edge.growth > 1.1, "gas1: %g, growth %g", edge.courant, edge.growth);
#define FLUID "-dim 2 -cells 8 -ppc 1 -formulation usl -transfer apic -gradient mls -basis quadratic -poisson 0.5"
  PetscCall(FindPatch(FLUID, MPM_AT_EDGE, &edge));
  PetscCall(FindPatch(FLUID, MPM_AT_CORNER, &corner));
  PetscCall(FindPatch(FLUID, MPM_ALONE, &lone));
  CHECK_NEAR(lone.courant, M_SQRT1_2, 1e-9);
  CHECK(corner.courant > lone.courant && edge.courant > corner.courant, "corner %g, edge %g", corner.courant,
        edge.courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  const PetscMPIInt size = MpmRanksOf(PETSC_COMM_WORLD);

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(CheckLones());
  PetscCall(CheckSearch());
  PetscCall(CheckSlow());
  if (size > 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckFaces());
  PetscCall(CheckHats());
  PetscCall(CheckFields());
  PetscCall(CheckBlocks());
  PetscCall(CheckOtherEnd());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
