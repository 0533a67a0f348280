/*
   Observed orders of accuracy in two and three dimensions, against plane waves and standing waves in boxes. They are those
   of one dimension: with a staggered start second on splines, and on hats and gimp for one particle in the middle of its
   cell. For others there the stress is of first order, since the gradient is constant over parts of a cell. gas1 is of
   first order in time. The affine part is left out; it is a gradient, and of first order.
*/
#include "gather.h"
#include "march/diagnostics.h"

/* The largest l2 error of all registers but those of the affine part. */
static PetscErrorCode ErrorOf(const char options[], PetscInt cells, PetscReal *worst)
{
  char      all[512];
  MpmScene *scene;
  MpmMarch *march;
  MpmError  error[MPM_MAX_FIELDS];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(all, sizeof all, "%s -cells %" PetscInt_FMT, options, cells));
  PetscCall(CheckScene(all, &scene));
  CHECK(MpmSceneHasExact(scene), "%s: no exact solution", all);
  PetscCall(MarchScene(PETSC_COMM_WORLD, scene, &march));
  PetscCall(MpmDiagnosticsErrors(march, error));
  *worst = 0;
  for (PetscInt r = 0; r < scene->scheme.table->nstate; r++) {
    CHECK(error[r].l1 <= error[r].l2 * (1 + 1e-12) && error[r].l2 <= error[r].linf * (1 + 1e-12),
          "%s: l1 %g l2 %g linf %g", all, error[r].l1, error[r].l2, error[r].linf);
    if (scene->scheme.table->field[r] != MPM_NONE) *worst = PetscMax(*worst, error[r].l2);
  }
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Compares the errors of a grid and of one of twice as many cells. */
static PetscErrorCode Order(const char options[], PetscInt cells, PetscReal order, PetscReal tolerance)
{
  PetscReal coarse, fine, observed;

  PetscFunctionBegin;
  PetscCall(ErrorOf(options, cells, &coarse));
  PetscCall(ErrorOf(options, 2 * cells, &fine));
  observed = log2(coarse / fine);
  CHECK(fabs(observed - order) <= tolerance, "%s: order %.3f, stated %.1f (errors %g, %g)", options, observed, order,
        coarse, fine);
  CHECK(fine < 0.1, "%s: error %g", options, fine);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckPlaneWaves(void)
{
  PetscFunctionBegin;
  PetscCall(Order("-dim 2 -formulation usl -basis quadratic -stagger -time 0.3 -mode 1,1", 32, 2, 0.2));
  PetscCall(
      Order("-dim 2 -formulation usl -basis quadratic -stagger -time 0.3 -mode 1,-1 -polarisation s", 32, 2, 0.2));
  PetscCall(Order("-dim 2 -formulation usl -basis gimp -stagger -time 0.3 -mode 0,1 -poisson 0", 32, 1, 0.1));
  PetscCall(Order("-dim 2 -formulation usl -basis gimp -ppc 1 -stagger -time 0.3 -mode 1,1 -poisson 0", 32, 2, 0.2));
  PetscCall(Order("-dim 2 -formulation usl -transfer apic -gradient mls -basis quadratic -stagger -time 0.3 -mode 1,-1 "
                  "-poisson 0.45",
                  32, 2, 0.2));
  PetscCall(
      Order("-dim 2 -formulation musl -basis gimp -ppc 1 -stagger -time 0.3 -mode 1,2 -polarisation s", 32, 2, 0.2));
  PetscCall(Order("-dim 2 -formulation musl -basis cubic -stagger -time 0.3 -mode 1,1 -poisson 0.5", 32, 2, 0.2));
  PetscCall(
      Order("-dim 2 -formulation musl -basis quadratic -stagger -time 0.3 -mode 1,1 -drift 1/8,-1/4", 32, 2, 0.2));
  PetscCall(Order("-dim 2 -formulation gas2 -basis quadratic -stagger -time 0.3 -mode 1,-1", 32, 2, 0.2));
  PetscCall(Order("-dim 2 -formulation gas1 -basis gimp -courant 0.2 -time 0.3 -mode 1,1", 32, 1, 0.3));
  PetscCall(Order("-dim 2 -formulation elastic -basis gimp -stagger -time 0.3 -mode 1,1", 32, 2, 0.2));
  PetscCall(Order("-dim 3 -formulation usl -basis quadratic -stagger -time 0.2 -ppc 1 -mode 1,1,1", 12, 2, 0.3));
  PetscCall(Order("-dim 3 -formulation usl -basis quadratic -stagger -time 0.2 -ppc 1 -mode 1,1,0 -polarisation s", 12,
                  2, 0.3));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckBoxes(void)
{
  PetscFunctionBegin;
  PetscCall(
      Order("-dim 2 -formulation usl -basis quadratic -stagger -time 0.3 -boundary symmetry -mode 2,1", 32, 2, 0.2));
  PetscCall(Order("-dim 2 -formulation usl -basis quadratic -stagger -time 0.3 -boundary symmetry,periodic -mode 1,1 "
                  "-polarisation s",
                  32, 2, 0.2));
  PetscCall(
      Order("-dim 2 -formulation usl -basis gimp -ppc 1 -stagger -time 0.3 -boundary fixed-free,periodic -mode 2,0", 32,
            2, 0.3));
  PetscCall(
      Order("-dim 2 -formulation usl -ppc 1 -stagger -time 0.3 -boundary periodic,fixed -mode 0,2 -polarisation s", 32,
            2, 0.3));
  PetscCall(
      Order("-dim 2 -formulation gas2 -basis quadratic -stagger -time 0.3 -boundary symmetry -mode 1,2", 32, 2, 0.2));
  PetscCall(
      Order("-dim 2 -formulation elastic -basis quadratic -stagger -time 0.3 -boundary fixed -mode 1,2", 32, 2, 0.2));
  PetscCall(
      Order("-dim 2 -formulation elastic -stagger -time 0.3 -boundary fixed-free,symmetry -mode 2,1", 32, 2, 0.2));
  PetscCall(Order("-dim 3 -formulation usl -basis quadratic -stagger -time 0.2 -ppc 1 -boundary symmetry -mode 1,2,1",
                  12, 2, 0.3));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(CheckPlaneWaves());
  PetscCall(CheckBoxes());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
