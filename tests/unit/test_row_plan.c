/* Plans of passes in more dimensions: maps share lines and results, and nothing overtakes what it depends on. */
#include "check.h"
#include "march/rows.h"

static PetscErrorCode Test(int argc, char **argv)
{
  const MpmBasis *basis     = MpmBasisFind("quadratic");
  const MpmLayout layout    = {.dim = 2};
  const MpmPass   pass      = {.nops = 5,
                               .mass = MPM_NONE,
                               .op   = {{.kind = MPM_GRAD, .axis = 1, .factor = 2},
                                        {.kind = MPM_GRAD, .axis = 1, .dst = 1, .factor = 3},
                                        {.kind = MPM_SCALE, .dst = 2, .factor = 0},
                                        {.kind = MPM_SCALE, .dst = 1, .factor = 4},
                                        {.kind = MPM_G2P, .dst = 1, .factor = 1}}};
  const PetscBool of_maps[] = {PETSC_FALSE, PETSC_TRUE, PETSC_FALSE, PETSC_TRUE};
  MpmRowPlan     *plan;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(PetscNew(&plan));
  MpmRowPlanCompile(&pass, basis, &layout, plan);
  CHECK(plan->nsteps == 4, "%d steps", (int)plan->nsteps);
  for (PetscInt s = 0; s < plan->nsteps; s++)
    CHECK((plan->step[s].begin < plan->step[s].end) == of_maps[s], "step %d", (int)s);
  CHECK(plan->step[0].op.dst == 2, "a register that no map of the group changes is scaled before it");
  CHECK(plan->step[2].op.dst == 1 && plan->step[2].op.factor == 4,
        "a register that a map has changed is scaled after it");
  CHECK(plan->nlines == 2 && plan->nmaps == 3, "%d lines, %d maps", (int)plan->nlines, (int)plan->nmaps);
  CHECK(plan->kind[plan->across[plan->line[0].across].y] == MPM_DIV && plan->across[plan->line[0].across].z == 0,
        "the slopes are across x");
  CHECK(plan->map[0].weights == 0 && plan->map[0].shared == 1 && plan->map[1].shared == 0,
        "two maps share a line and its result along x");
  CHECK(plan->nkinds == 2 && plan->kind[0] == MPM_P2G && plan->kind[1] == MPM_DIV, "weights that are not needed");
  PetscCall(PetscFree(plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
