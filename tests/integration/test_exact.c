/*
   Marches at finite strain against exact solutions: their orders, and the errors that an independent program found for the
   same bars and waves. The bars are of period 1 with particles at regular places, and velocities start half a step early.
*/
#include "gather.h"
#include "march/diagnostics.h"
#include <string.h>

#define FINITE "-kinematics finite -formulation usl -stagger "
#define BAR FINITE "-basis cubic -ppc 4 -material neo -initial manufactured -courant 0.4 -time 0.5 "
#define WAVE FINITE "-basis cubic -ppc 8 -material gas -initial simple_wave -amplitude 0.2 -courant 0.3 -time 0.3 "
#define PLANE FINITE "-dim 2 -ppc 2 -basis cubic -material neo "
#define VORTEX                                                                                                         \
  PLANE "-initial vortex -amplitude 0.1 -length 2.7 -young 1000 -poisson 0.3 -density 1000 -transfer apic "            \
        "-courant 0.2 -time 0.5"
#define TUBE                                                                                                           \
  "-kinematics finite -formulation usl -basis quadratic -ppc 4 -material gas -initial shock_tube -boundary fixed "     \
  "-courant 0.2 -time 0.15 -transfer apic "

/*
   What must come out for a field: the error on this grid, NAN: not asked, and the order from the grid of half as many
   cells. The errors are those of an independent program.
*/
typedef struct {
  const char *options;
  PetscInt    cells;
  const char *field;
  PetscBool   l1;
  PetscReal   error, order;
} Case;

static PetscErrorCode ErrorOf(const Case *c, PetscInt cells, PetscReal *found)
{
  char        all[512];
  MpmScene   *scene;
  MpmMarch   *march;
  MpmError    error[MPM_MOST_ERRORS];
  const char *name[MPM_MOST_ERRORS];
  PetscInt    n;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(all, sizeof all, "%s -cells %" PetscInt_FMT, c->options, cells));
  PetscCall(CheckScene(all, &scene));
  CHECK(MpmSceneHasExact(scene), "%s: no exact solution", all);
  PetscCall(MarchScene(PETSC_COMM_WORLD, scene, &march));
  CHECK(!march->failure[0], "%s: %s", all, march->failure);
  PetscCall(MpmDiagnosticsErrors(march, error));
  *found = NAN;
  n      = MpmSceneErrorFields(scene, name);
  for (PetscInt i = 0; i < n; i++) {
    CHECK(error[i].l1 <= error[i].l2 * (1 + 1e-12) && error[i].l2 <= error[i].linf * (1 + 1e-12),
          "%s: %s: l1 %g l2 %g linf %g", all, name[i], error[i].l1, error[i].l2, error[i].linf);
    if (!strcmp(name[i], c->field)) *found = c->l1 ? error[i].l1 : error[i].l2;
  }
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const Case cases[] = {
    {BAR "-amplitude 0.005", 64, "x", PETSC_FALSE, NAN, 2.0},
    {BAR "-amplitude 0.005", 64, "f", PETSC_FALSE, NAN, 2.0},
    {BAR "-amplitude 0.05", 32, "x", PETSC_FALSE, 3.00e-2, 2.0},
    {BAR "-amplitude 0.05", 64, "x", PETSC_FALSE, 7.49e-3, 2.0},
    {WAVE, 64, "v", PETSC_FALSE, 6.3e-3, 2.0},
    {WAVE, 128, "rho", PETSC_FALSE, NAN, 1.85},
    {PLANE "-initial manufactured -amplitude 0.005 -courant 0.3 -time 0.3", 32, "v_y", PETSC_FALSE, NAN, 2.0},
    {PLANE "-initial manufactured -amplitude 0.005 -courant 0.3 -time 0.5 -boundary symmetry", 32, "x", PETSC_FALSE,
     NAN, 1.96},
    {VORTEX, 40, "f_xy", PETSC_FALSE, NAN, 2.08}, /* of grids on which orders have not settled yet */
    {TUBE "-gradient mls", 256, "rho", PETSC_TRUE, NAN, 0.78},
    {TUBE "-gradient mls", 256, "v", PETSC_TRUE, NAN, 0.97},
};

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(cases); i++) {
    const Case *c    = &cases[i];
    PetscBool   turn = PETSC_FALSE;
    PetscReal   coarse, fine, order;

    PetscCall(CheckHasTurn((PetscInt)i, &turn));
    if (!turn) continue;
    PetscCall(ErrorOf(c, c->cells / 2, &coarse));
    PetscCall(ErrorOf(c, c->cells, &fine));
    order = log2(coarse / fine);
    CHECK(fabs(order - c->order) <= 0.03, "%s: %s has order %.3f, stated %.2f", c->options, c->field, order, c->order);
    CHECK(isnan(c->error) || fabs(fine / c->error - 1) <= 0.003, "%s: %s has error %g, stated %g", c->options, c->field,
          fine, c->error);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
