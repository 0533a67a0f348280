/*
   Windows of growth at rest: critical finds the ranges of Courant numbers that all eigenvalues show, of the particles'
   operator on irregular layouts, and of the symbol at other phases than those of the search on lattices under a prestress.
   With transfers for which a theorem holds it looks for no windows.
*/
#include "base/hash.h"
#include "check.h"
#include "linalg/dense.h"
#include "linalg/small_eigen.h"
#include "symbol/bloch.h"
#include <mpmstab/operator.h>
#include <mpmstab/critical.h>
#include <slepcsys.h>
#include <math.h>

#define LAYOUTS 8
#define POINTS 40
#define LATTICES 6
#define PHASES 211
#define BESIDE 0.01 /* relative distance from the end of a range within which either answer is right */

static PetscErrorCode GrowthAt(const MpmScene *scene, PetscReal courant, PetscReal *growth)
{
  MpmStep      step = scene->step;
  MpmOperator *op;
  PetscReal    value[2];

  PetscFunctionBegin;
  step.courant = courant;
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &step, &op));
  PetscCall(MpmDenseLargest(op->balanced, value));
  *growth = hypot(value[0], value[1]);
  PetscCall(MpmOperatorDestroy(&op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsNear(PetscReal courant, PetscReal end)
{
  return fabs(courant - end) < BESIDE * end ? PETSC_TRUE : PETSC_FALSE;
}

/* Whether critical says that there is growth at a Courant number; near: it is beside the end of a range. */
static PetscBool Says(const MpmCritical *c, PetscReal courant, PetscBool *near)
{
  PetscBool grows = courant > c->stable_at ? PETSC_TRUE : PETSC_FALSE;

  *near = IsNear(courant, c->stable_at);
  for (PetscInt i = 0; i < c->windows.n; i++) {
    const MpmCriticalWindow *w = &c->windows.window[i];

    if (courant > w->from && courant < w->to) grows = PETSC_TRUE;
    if (IsNear(courant, w->from) || IsNear(courant, w->to)) *near = PETSC_TRUE;
  }
  return grows;
}

static PetscErrorCode CheckOne(const char transfer[], PetscInt seed, PetscInt *windows)
{
  MpmScene       *scene;
  MpmCritical     c;
  MpmCriticalCase of;
  char            text[256];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(
      text, sizeof text,
      "{formulation: usl, basis: quadratic, transfer: %s, cells: 12, ppc: 1, offset: 1/2, jitter: 1, seed: %d}",
      transfer, (int)seed));
  PetscCall(MpmSceneFromText(text, &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmCriticalFind(&of, PETSC_TRUE, &c));
  CHECK(c.windows.looked > 60, "%s: looked at %d", text, (int)c.windows.looked);
  *windows += c.windows.n;
  for (PetscInt i = 0; i < POINTS; i++) {
    const PetscReal courant = 2e-3 * pow(1000, (PetscReal)i / POINTS);
    PetscReal       growth;
    PetscBool       near, says = Says(&c, courant, &near);

    PetscCall(GrowthAt(scene, courant, &growth));
    if (!near && fabs(growth - 1 - 1e-6) > 2e-7)
      CHECK((growth > 1 + 1e-6) == says, "%s: growth - 1 = %.3g at %.6g", text, growth - 1, courant);
  }
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest growth of the symbol over phases in (0, pi). */
static PetscErrorCode LatticeGrowth(MpmBloch *bloch, MpmSmallEigen *eigen, PetscReal courant, PetscReal *growth)
{
  PetscFunctionBegin;
  *growth = 0;
  for (int m = 0; m < PHASES; m++) {
    const PetscReal beta = PETSC_PI * (m + 0.4) / PHASES;
    PetscInt        exponent;

    PetscCall(MpmBlochMatrices(bloch, 1, &courant, &beta, PETSC_FALSE, eigen->matrix, &exponent));
    PetscCall(MpmSmallEigenSolve(eigen, PETSC_FALSE));
    for (PetscInt i = 0; i < eigen->n; i++) *growth = fmax(*growth, cabs(eigen->value[i]) * scalbn(1, (int)exponent));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Says of a lattice what its symbol shows, and of its own Courant number the same as of the windows. The symbol's growth may
   be a little less than that of the worst phase.
*/
static PetscErrorCode CheckLattice(const char options[], PetscInt *windows)
{
  MpmScene       *scene;
  MpmCritical     c;
  MpmCriticalCase of;
  MpmBloch        bloch;
  MpmSmallEigen   eigen;
  PetscBool       near, says;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &c));
  *windows += c.windows.n;
  says = Says(&c, scene->step.courant, &near);
  CHECK(near || says == (c.asked.verdict == MPM_UNSTABLE), "%s: growth %.9g", options, c.asked.growth);
  PetscCall(MpmBlochCreate(&scene->layout, &scene->scheme, scene->step.drift, &bloch));
  PetscCall(MpmSmallEigenCreate(bloch.size, &eigen));
  for (PetscInt i = 0; i < POINTS && c.courant > 0; i++) {
    const PetscReal courant = 2e-3 * pow(1000, (PetscReal)i / POINTS);
    PetscReal       growth;

    says = Says(&c, courant, &near);
    PetscCall(LatticeGrowth(&bloch, &eigen, courant, &growth));
    if (!near && fabs(growth - 1 - 1e-6) > 3e-7)
      CHECK((growth > 1 + 1e-6) == says, "%s: growth - 1 = %.3g at %.6g", options, growth - 1, courant);
  }
  PetscCall(MpmSmallEigenDestroy(&eigen));
  PetscCall(MpmBlochDestroy(&bloch));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cubic splines under a prestress have windows with flip, too, where particles are not their own mirror image. */
static PetscErrorCode CheckLattices(void)
{
  static const char *const formulations[] = {"usl", "usf", "musl", "usavg"}, *const transfers[] = {"flip", "apic",
                                                                                                   "aflip"};
  PetscInt windows = 0;

  PetscFunctionBegin;
  PetscCall(
      CheckLattice("-formulation usavg -basis cubic -ppc 1 -offset 0.25297 -prestress -0.442 -courant 0.01", &windows));
  PetscCall(
      CheckLattice("-formulation usavg -basis cubic -ppc 2 -offset 0.25297 -prestress -0.442 -courant 0.03", &windows));
  CHECK(windows == 2, "%d windows of known lattices", (int)windows);
  PetscCall(CheckLattice("-formulation usl -transfer tpic -basis quadratic -offset 0.2 -courant 0.7", &windows));
  PetscCall(CheckLattice("-formulation usf -transfer aflip -basis quadratic -courant 3", &windows));
  for (PetscInt i = 0; i < LATTICES; i++) {
    char options[256];

    PetscCall(
        PetscSNPrintf(options, sizeof options,
                      "-formulation %s -transfer %s -basis cubic -ppc %d -offset %.6f -prestress %.4f -courant %.5f",
                      formulations[i % 4], transfers[i % 3], 1 + (int)(2 * MpmHash(71, i)), MpmHash(72, i),
                      -0.5 * MpmHash(73, i), 1e-3 * pow(1000, MpmHash(74, i))));
    PetscCall(CheckLattice(options, &windows));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In a plane: the verdict at a scene's own Courant number, which comes of all phases there, is that of the windows. */
static PetscErrorCode CheckPlane(void)
{
  static const char *const at[] = {"0.3", "0.7", "1.2"};

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(at); i++) {
    MpmScene       *scene;
    MpmCritical     c;
    MpmCriticalCase of;
    PetscBool       near, says;
    char            options[256];

    PetscCall(PetscSNPrintf(
        options, sizeof options,
        "-dim 2 -formulation usl -basis cubic -ppc 1 -offset 0.7855,0.5001 -prestress -0.373,0 -courant %s", at[i]));
    PetscCall(CheckScene(options, &scene));
    of = MpmCriticalCaseOf(scene, 1e-6);
    PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &c));
    says = Says(&c, scene->step.courant, &near);
    CHECK(c.windows.n == 1 && !near && says == (c.asked.verdict == MPM_UNSTABLE),
          "%s: %d windows, limit %.9g, growth %.9g", options, (int)c.windows.n, c.courant, c.asked.growth);
    PetscCall(MpmSceneDestroy(&scene));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A second material that is stiffer and lighter moves the limit far below all Courant numbers of a row. */
static PetscErrorCode CheckStiff(void)
{
  MpmScene       *scene;
  MpmCritical     c;
  MpmCriticalCase of;
  PetscReal       growth[2];

  PetscFunctionBegin;
  PetscCall(CheckScene("-formulation usl -basis quadratic -transfer aflip -cells 8 -ppc 2 -jitter 0.5 -material graded "
                       "-stiffness_ratio 1e12 -density_ratio 1e-12",
                       &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmCriticalFind(&of, PETSC_TRUE, &c));
  PetscCall(GrowthAt(scene, c.courant, &growth[0]));
  PetscCall(GrowthAt(scene, 1.001 * c.courant, &growth[1]));
  CHECK(c.courant > 0 && growth[0] <= 1 + 2e-6 && growth[1] > 1 + 1e-6, "limit %g: growth %.9g and %.9g", c.courant,
        growth[0], growth[1]);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The limit of a scheme for which a theorem holds is where eigenvalues begin to grow. */
static PetscErrorCode CheckTheorem(const char transfer[])
{
  MpmScene       *scene;
  MpmCritical     c;
  MpmCriticalCase of;
  char            text[256];
  PetscReal       growth[2];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof text,
                          "{formulation: usl, basis: quadratic, transfer: %s, cells: 8, ppc: 1, jitter: 1, seed: 3}",
                          transfer));
  PetscCall(MpmSceneFromText(text, &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmCriticalFind(&of, PETSC_TRUE, &c));
  CHECK(c.windows.looked == 0 && c.windows.n == 0, "%s", text);
  PetscCall(GrowthAt(scene, c.courant, &growth[0]));
  PetscCall(GrowthAt(scene, 1.001 * c.courant, &growth[1]));
  CHECK(growth[0] <= 1 + 2e-6 && growth[1] > 1 + 1e-6, "%s: growth %.9g and %.9g", text, growth[0], growth[1]);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  static const char *const transfers[] = {"tpic", "aflip", "asflip"}, *const proved[] = {"flip", "pic", "blend", "xpic",
                                                                                         "apic"};
  PetscInt windows = 0;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(SlepcInitializeNoArguments());
  for (size_t t = 0; t < PETSC_STATIC_ARRAY_LENGTH(transfers); t++)
    for (PetscInt seed = 0; seed < LAYOUTS; seed++) PetscCall(CheckOne(transfers[t], 3210 + seed, &windows));
  CHECK(windows >= 3, "%d windows in all", (int)windows);
  for (size_t t = 0; t < PETSC_STATIC_ARRAY_LENGTH(proved); t++) PetscCall(CheckTheorem(proved[t]));
  PetscCall(CheckLattices());
  PetscCall(CheckPlane());
  PetscCall(CheckStiff());
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
