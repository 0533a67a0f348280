/*
   Observed orders of accuracy, against exact solutions and, in dt alone, against the same run with smaller steps.

   At a fixed Courant number the errors of gas are of first order for particles off the middle of their cells, since
   GRAD is constant over a cell, and of second order for one particle in the middle. Staggered, gas2 and elastic are of
   second order in dt. When both fields start at the same time, the field updated first stays half a step behind, which
   is an error of first order.

   Elastic keeps a small error of first order where P2G G2P is not the identity: it damps by an amount per time
   proportional to k, since

     det = 1 - 4 k^2 alpha (1 - alpha) s

   The error is 0 for particles on nodes, where alpha = 1.
*/
#include "gather.h"
#include "march/diagnostics.h"

static PetscErrorCode ErrorOf(const char options[], PetscInt cells, PetscReal *worst)
{
  char      all[512];
  MpmScene *scene;
  MpmMarch *march;
  MpmError  error[MPM_MAX_FIELDS];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(all, sizeof all, "%s -cells %" PetscInt_FMT, options, cells));
  PetscCall(CheckScene(all, &scene));
  PetscCall(MarchScene(PETSC_COMM_WORLD, scene, &march));
  PetscCall(MpmDiagnosticsErrors(march, error));
  *worst = PetscMax(error[0].l2, error[1].l2);
  for (PetscInt f = 0; f < 2; f++)
    CHECK(error[f].l1 <= error[f].l2 * (1 + 1e-12) && error[f].l2 <= error[f].linf * (1 + 1e-12),
          "%s: l1 %g l2 %g linf %g", all, error[f].l1, error[f].l2, error[f].linf);
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OrderInSpace(const char options[], PetscReal order, PetscReal tolerance)
{
  PetscReal coarse, fine, observed;

  PetscFunctionBegin;
  PetscCall(ErrorOf(options, 128, &coarse));
  PetscCall(ErrorOf(options, 256, &fine));
  observed = log2(coarse / fine);
  CHECK(fabs(observed - order) <= tolerance, "%s: order %.3f, stated %.1f (errors %g, %g)", options, observed, order,
        coarse, fine);
  CHECK(fine < 0.1, "%s: error %g", options, fine);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The field that does not lag, at the time 0.3, after n steps of 0.3/n. */
static PetscErrorCode AtTime(const char options[], const char field[], PetscInt steps, PetscReal **q, PetscInt64 *n)
{
  char      all[512];
  MpmScene *scene;
  MpmMarch *march;

  PetscFunctionBegin;
  PetscCall(
      PetscSNPrintf(all, sizeof all, "%s -cells 32 -dt %.17g -steps %" PetscInt_FMT, options, 0.3 / steps, steps));
  PetscCall(CheckScene(all, &scene));
  PetscCall(MarchScene(PETSC_COMM_WORLD, scene, &march));
  PetscCall(GatherField(march, field, q));
  *n = scene->layout.particles;
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OrderInTime(const char options[], const char field[], PetscReal order)
{
  PetscReal *q[3], observed;
  PetscInt64 n;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < 3; i++) PetscCall(AtTime(options, field, 64 << i, &q[i], &n));
  observed = log2(LargestDifference(n, q[0], q[1]) / LargestDifference(n, q[1], q[2]));
  CHECK(fabs(observed - order) <= 0.15, "%s: order %.3f in dt, stated %.1f", options, observed, order);
  for (PetscInt i = 0; i < 3; i++) PetscCall(PetscFree(q[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(OrderInTime("-formulation gas1", "r", 1));
  PetscCall(OrderInTime("-formulation gas2", "u", 1)); /* not staggered: u is half a step behind */
  PetscCall(OrderInTime("-formulation gas2 -stagger", "r", 2));
  PetscCall(OrderInTime("-formulation elastic", "w", 1));
  PetscCall(OrderInTime("-formulation elastic -stagger -ppc 1 -offset 0", "u", 2));
  PetscCall(OrderInTime("-formulation elastic -stagger", "u", 1));

  PetscCall(OrderInSpace("-formulation gas1 -courant 0.2 -time 0.3", 1, 0.15));
  PetscCall(OrderInSpace("-formulation gas2 -stagger -time 0.3", 1, 0.1));
  PetscCall(OrderInSpace("-formulation gas2 -stagger -ppc 1 -time 0.3", 2, 0.1));
  PetscCall(OrderInSpace("-formulation gas2 -stagger -ppc 1 -initial pulse -courant 0.25 -time 0.25", 2, 0.2));
  PetscCall(OrderInSpace("-formulation elastic -stagger -time 0.3", 2, 0.1));
  PetscCall(OrderInSpace("-formulation elastic -stagger -ppc 1 -offset 0 -time 0.3", 2, 0.1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
