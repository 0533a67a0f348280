/*
   Bounds of the step of random layouts. At a bound the operator of a step has no eigenvalue outside of the unit circle, in any
   dimension, basis and gradient, with walls and materials. A certificate with a chance of 1e-2 fails in no more of the layouts:
   it is compared with all eigenvalues of DIV GRAD. Bounds on ranks are those on one rank.

   test_step_bounds [LAYOUTS [CERTIFICATES]]
*/
#include "check.h"
#include "base/hash.h"
#include "linalg/dense.h"
#include "linalg/eigen.h"
#include "march/march_private.h"
#include "operator/nodal.h"
#include "program/maps.h"
#include "scene/layout.h"
#include <mpmstab/step_bound.h>
#include <mpmstab/operator.h>

#define ROUNDING 1e-6 /* of the growth that a double eigenvalue at 1 has */
#define CHANCE 1e-2
#define STEPS_BELOW 1e-6 /* relative distance below the bound, where two eigenvalues meet at -1 */
#define ABOVE 1.2        /* times the largest bound some layout grows */

static PetscInt64 drawn;

static PetscReal Draw(void)
{
  return MpmHash(2024, drawn++);
}

static PetscInt DrawInt(PetscInt n)
{
  return (PetscInt)(n * Draw());
}

/* ---- layouts ---- */

/* Gives a scene random particles of its own: in some cells only, of two materials, some of them in pairs close together. */
static PetscErrorCode Scatter(MpmScene *scene, PetscReal voids, PetscBool two)
{
  MpmLayout       *l = &scene->layout;
  const PetscInt   n = 1 + DrawInt((PetscInt)MpmLayoutCells(l) * 3), property[] = {MPM_MASS, MPM_VOLUME, MPM_STIFFNESS};
  const PetscInt64 kept = drawn;
  MpmGiven        *given;

  PetscFunctionBegin;
  PetscCall(PetscNew(&given));
  for (PetscInt a = 0; a < l->dim; a++) {
    PetscCall(PetscMalloc1(n, &given->column[a]));
    PetscCall(PetscCalloc1(l->grid[a].cells + 1, &given->before[a]));
    l->row[a] = n;
  }
  for (int w = 0; w < 3; w++) {
    PetscCall(PetscMalloc1(n, &given->property[property[w]]));
    l->varies[property[w]] = PETSC_TRUE;
  }
  given->particles = n;
  for (PetscInt p = 0; p < n; p++) {
    const PetscReal volume = 0.3 + Draw();
    PetscBool       heavy  = two && Draw() < 0.5 ? PETSC_TRUE : PETSC_FALSE, empty;

    do {
      PetscInt64 number = 0;

      for (PetscInt a = 0; a < l->dim; a++) {
        given->column[a][p] = Draw() * l->grid[a].cells;
        if (p && Draw() < 0.2) given->column[a][p] = given->column[a][p - 1];
        number = number * l->grid[a].cells + (PetscInt)given->column[a][p];
      }
      empty = MpmHash(kept, number) < voids ? PETSC_TRUE : PETSC_FALSE;
    } while (empty && Draw() < 0.98); /* all cells may be empty */
    given->property[MPM_VOLUME][p]    = volume;
    given->property[MPM_MASS][p]      = volume * (heavy ? 7 : 1);
    given->property[MPM_STIFFNESS][p] = heavy ? 30 : 1;
  }
  for (PetscInt a = 0; a < l->dim; a++)
    for (PetscInt p = 0; p < n; p++)
      for (PetscInt c = (PetscInt)given->column[a][p]; c < l->grid[a].cells; c++) given->before[a][c + 1]++;
  l->given = given;
  l->sites = l->particles = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A scheme on a small grid; 3-D is rare, since it takes long. */
static PetscErrorCode DrawScene(char text[256], MpmScene **scene)
{
  static const char *const
             schemes[] = {"usl",        "usf",       "musl", "usavg", "usl", "usl", "verlet", "verlet -share 0.8",
                          "rk -rk rk4", "rk -rk kg5"},
      *const bases[] = {"linear", "quadratic", "cubic", "gimp"}, *const transfers[] = {"flip", "pic", "apic", "blend"},
      *const      ends[] = {"periodic", "fixed", "free", "symmetry", "fixed-free"};
  const PetscReal which  = Draw();
  const PetscInt  dim = which < 0.4 ? 1 : which < 0.95 ? 2 : 3, scheme = DrawInt(10), basis = DrawInt(4);
  const PetscInt  cells    = (dim == 1 ? 5 : dim == 2 ? 3 : 3) + DrawInt(dim == 1 ? 8 : 2);
  char            side[64] = "";

  PetscFunctionBegin;
  for (PetscInt a = 0; a < dim; a++) {
    const PetscInt kind = DrawInt(8) - 3;
    const char    *end  = ends[PetscMax(0, kind)];

    (void)snprintf(side + strlen(side), sizeof side - strlen(side), "%s%s", a ? "," : "",
                   dim == 1 && !strcmp(end, "fixed-free") ? "fixed,free" : end);
  }
  (void)snprintf(text, 256,
                 "-formulation %s -transfer %s -basis %s -gradient %s -dim %d -cells %d -poisson 0.%d -boundary %s",
                 schemes[scheme], transfers[scheme < 6 ? DrawInt(4) : 0], bases[basis], Draw() < 0.3 ? "mls" : "basis",
                 (int)dim, (int)cells, (int)DrawInt(5), side);
  if (dim == 1)
    *strstr(text, "-poisson") = '\0', (void)snprintf(text + strlen(text), 256 - strlen(text), "-boundary %s", side);
  PetscCall(CheckScene(text, scene));
  PetscCall(Scatter(*scene, Draw() < 0.5 ? 0 : 0.4, Draw() < 0.4 ? PETSC_TRUE : PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Bounds(MPI_Comm comm, const MpmScene *scene, PetscInt sweeps, PetscReal chance, PetscInt64 seed,
                             MpmStepBounds *bounds)
{
  MpmMarch *march;

  PetscFunctionBegin;
  *bounds = (MpmStepBounds){.kinds = MPM_BOUNDS, .sweeps = sweeps, .chance = chance, .seed = seed};
  PetscCall(MpmMarchCreateRandom(comm, &scene->layout, &scene->scheme, &scene->step, 1, &march));
  PetscCall(MpmStepBoundsFind(march, bounds));
  PetscCall(MpmMarchDestroy(&march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- no bound is above the limit ---- */

static PetscErrorCode GrowthAt(const MpmScene *scene, PetscReal courant, PetscReal *growth)
{
  MpmStep      step = scene->step;
  MpmOperator *op;
  PetscInt64   nodal;
  PetscReal    value[2];

  PetscFunctionBegin;
  step.courant = courant;
  PetscCall(MpmNodalMatrixUnknowns(&scene->layout, &scene->scheme, &step, &nodal));
  if (nodal) {
    MpmReduced *reduced;

    PetscCall(MpmNodalMatrixCreate(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &step, NULL, &reduced));
    PetscCall(MpmReducedLargest(reduced, value));
    PetscCall(MpmReducedDestroy(&reduced));
  } else {
    PetscCall(MpmOperatorCreate(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &step, &op));
    PetscCall(MpmDenseLargest(op->balanced, value));
    PetscCall(MpmOperatorDestroy(&op));
  }
  *growth = hypot(value[0], value[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckSound(PetscInt i, PetscInt *known, PetscReal *tightest)
{
  char          text[256];
  MpmScene     *scene;
  MpmStepBounds b;
  PetscReal     growth, best;

  PetscFunctionBegin;
  PetscCall(DrawScene(text, &scene));
  PetscCall(Bounds(PETSC_COMM_SELF, scene, 4, 1e-6, i, &b));
  if (!b.why_not) {
    best = PetscMax(PetscMax(b.lone, b.swept), b.lanczos);
    CHECK(b.particle <= b.swept, "%s, layout %d: %g %g", text, (int)i, b.particle, b.swept);
    PetscCall(GrowthAt(scene, best * (1 - STEPS_BELOW), &growth));
    CHECK(growth <= 1 + ROUNDING,
          "%s, layout %d of %d particles: growth %.9g at %.9g (lone %g, particle %g, swept %g, lanczos %g)", text,
          (int)i, (int)scene->layout.particles, growth, best, b.lone, b.particle, b.swept, b.lanczos);
    PetscCall(GrowthAt(scene, best * ABOVE, &growth));
    *tightest = PetscMax(*tightest, growth);
    ++*known;
  }
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- how often a certificate fails ---- */

/* The largest eigenvalue of DIV GRAD of a bar. */
static PetscErrorCode LargestOf(const MpmScene *scene, PetscReal *largest)
{
  const MpmTable *t = scene->scheme.table;
  MpmSlab         slab;
  MpmMaps         maps   = {.slab = &slab};
  Mat             map[2] = {NULL, NULL}, K;
  PetscReal      *values, *re, *im;
  PetscInt        n;
  int             failed;

  PetscFunctionBegin;
  PetscCall(MpmSlabOf(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &scene->step, &slab));
  for (PetscInt o = 0; o < t->nops; o++) {
    if (t->ops[o].kind == MPM_DIV) PetscCall(MpmMapsGet(&maps, &t->ops[o], &map[0]));
    if (t->ops[o].kind == MPM_GRAD) PetscCall(MpmMapsGet(&maps, &t->ops[o], &map[1]));
  }
  PetscCall(MatMatMult(map[0], map[1], MAT_INITIAL_MATRIX, PETSC_DETERMINE, &K));
  PetscCall(MatGetSize(K, &n, NULL));
  PetscCall(PetscMalloc3(n * n, &values, n, &re, n, &im));
  PetscCall(MpmDenseCopy(K, values));
  PetscCall(MpmDenseEigen(n, values, re, im, NULL, &failed));
  *largest = 0;
  for (PetscInt i = 0; i < n; i++) *largest = fmax(*largest, re[i]);
  PetscCall(PetscFree3(values, re, im));
  PetscCall(MatDestroy(&K));
  PetscCall(MpmMapsDestroy(&maps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* musl has the limit 2 / sqrt(lambda) but for P2G G2P, so that bounds are compared with that. */
static PetscErrorCode CheckCertificate(PetscInt i, PetscInt *failures)
{
  static const char *const bases[] = {"linear", "quadratic", "cubic"};
  char                     text[256];
  MpmScene                *scene;
  MpmStepBounds            b;
  PetscReal                lambda, chances[2] = {CHANCE, 1e-6};

  PetscFunctionBegin;
  (void)snprintf(text, sizeof text, "-formulation musl -basis %s -cells %d", bases[i % 3], 24 + (int)DrawInt(10));
  PetscCall(CheckScene(text, &scene));
  PetscCall(Scatter(scene, i % 2 ? 0.3 : 0, i % 5 == 0 ? PETSC_TRUE : PETSC_FALSE));
  PetscCall(LargestOf(scene, &lambda));
  for (int c = 0; c < 2; c++) {
    PetscCall(Bounds(PETSC_COMM_SELF, scene, 0, chances[c], i, &b));
    if (!b.why_not && b.lanczos > 2 / sqrt(lambda) * (1 + 1e-9)) failures[c]++;
    if (!b.why_not)
      CHECK(PetscMax(b.lone, b.particle) <= 2 / sqrt(lambda) * (1 + 1e-9), "layout %d: %g, %g, %g", (int)i, b.lone,
            b.particle, 2 / sqrt(lambda));
  }
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- ranks ---- */

static PetscErrorCode CheckRanks(void)
{
  static const char *const scenes[] = {
      "-formulation usl -cells 24 -basis quadratic", "-formulation musl -dim 2 -cells 12 -basis cubic -boundary fixed",
      "-formulation usl -dim 3 -cells 8 -basis quadratic -boundary periodic,free,symmetry",
      "-formulation usl -dim 2 -cells 14 -drift 1/3 -basis quadratic"};

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(scenes); i++) {
    MpmScene     *scene;
    MpmStepBounds one, many;

    PetscCall(CheckScene(scenes[i], &scene));
    PetscCall(Scatter(scene, 0.2, PETSC_TRUE));
    PetscCall(Bounds(PETSC_COMM_SELF, scene, 2, 1e-6, 5, &one));
    PetscCall(Bounds(PETSC_COMM_WORLD, scene, 2, 1e-6, 5, &many));
    CHECK_NEAR(one.lone, many.lone, 1e-12);
    CHECK_NEAR(one.particle, many.particle, 1e-12);
    CHECK_NEAR(one.swept, many.swept, 1e-12);
    CHECK_NEAR(one.lanczos, many.lanczos, 1e-6 * one.lanczos);
    CHECK(one.lone_at.id == many.lone_at.id && one.particle_at.id == many.particle_at.id && one.nodes == many.nodes,
          "%s: other particles decide", scenes[i]);
    for (PetscInt a = 0; a < scene->layout.dim; a++)
      CHECK_NEAR(one.particle_at.place[a], many.particle_at.place[a], 1e-12);
    PetscCall(MpmSceneDestroy(&scene));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  const PetscInt layouts = argc > 1 ? atoi(argv[1]) : 300, certificates = argc > 2 ? atoi(argv[2]) : 400;
  PetscInt       known = 0, failures[2] = {0, 0};
  PetscReal      tightest = 0;
  PetscMPIInt    size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(CheckRanks());
  if (size > 1) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < layouts; i++) PetscCall(CheckSound(i, &known, &tightest));
  CHECK(known > layouts / 2 && tightest > 1 + ROUNDING,
        "%d of %d layouts have bounds, and the largest growth above is %g", (int)known, (int)layouts, tightest);
  for (PetscInt i = 0; i < certificates; i++) PetscCall(CheckCertificate(i, failures));
  if (argc > 3)
    printf("%d of %d layouts; certificates failed %d and %d of %d times\n", (int)known, (int)layouts, (int)failures[0],
           (int)failures[1], (int)certificates);
  CHECK(failures[0] <= CHANCE * certificates && !failures[1], "%d and %d of %d certificates failed", (int)failures[0],
        (int)failures[1], (int)certificates);
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
