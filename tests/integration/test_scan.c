/*
   Windows of growth at rest, of irregular layouts: critical finds the ranges of Courant numbers that all eigenvalues of the
   particles' operator show. With transfers for which a theorem holds it looks for no windows.
*/
#include "check.h"
#include "linalg/dense.h"
#include <mpmstab/operator.h>
#include <mpmstab/critical.h>
#include <slepcsys.h>
#include <math.h>

#define LAYOUTS 8
#define POINTS 40
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
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
