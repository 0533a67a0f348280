/* The march: pass after pass, and migration before particles would run out of the ghost layer. */
#include "march/march_private.h"

static PetscErrorCode Migrate(MpmMarch *march)
{
  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(march->migrate_event, 0, 0, 0, 0));
  PetscCall(MpmParticlesRebase(march->particles, march->grid));
  PetscCall(PetscLogEventEnd(march->migrate_event, 0, 0, 0, 0));
  march->migrations++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Particles may run into the ghost layer; before the next step would take them beyond it they go to their owners. */
static PetscErrorCode MigrateInTime(MpmMarch *march)
{
  PetscInt  whole;
  PetscReal part;

  PetscFunctionBegin;
  if (!march->slack) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmParticlesWhere(march->particles, march->step + 1, &whole, &part));
  if (PetscAbsInt(whole) + 1 > march->slack) PetscCall(Migrate(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchStep(MpmMarch *march, PetscBool sample)
{
  PetscFunctionBegin;
  MpmFloatBegin();
  if (sample) PetscCall(PetscArrayzero(march->squares, MPM_MAX_FIELDS));
  for (PetscInt p = 0, n; p < march->schedule.npasses; p += n) {
    const MpmPass *pass = &march->schedule.pass[p];

    for (n = 1; p + n < march->schedule.npasses && pass[n].joined; n++) continue;
    PetscCall(MpmMarchRunPasses(march, n, pass, sample));
    if (pass[n - 1].rebase) PetscCall(Migrate(march));
  }
  march->step++;
  PetscCall(MigrateInTime(march));
  PetscCall(MpmFloatEnd(PetscObjectComm((PetscObject)march->grid->da), &march->float_check, "march", march->step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   P2G of one particle field with the particles at the places of a step; with_mass: the nodal masses too, of which the
   inverses go to inverse_mass.
*/
static PetscErrorCode Project(MpmMarch *march, PetscInt field, PetscInt64 step, PetscBool with_mass, Vec inverse_mass,
                              Vec node)
{
  const MpmBasis      *basis         = march->scheme->basis;
  const PetscBool      antisymmetric = MpmTableIsAntisymmetric(march->scheme->table, field);
  const MpmPass        project       = {.nops      = 1,
                                        .nsums     = 1,
                                        .sums_mass = with_mass,
                                        .op        = {{.kind        = with_mass ? MPM_PASS_MASS : MPM_PASS_MAP,
                                                       .kernel      = basis->kernel[MPM_P2G],
                                                       .mass_kernel = basis->p2g_mass,
                                                       .a           = 1,
                                                       .particle    = field,
                                                       .to_nodes    = PETSC_TRUE,
                                                       .weight      = MpmLayoutWeight(march->layout, MPM_P2G)}}};
  Vec                  spare         = NULL;
  const MpmNodeVectors nodes         = {
              .n = 1, .node = &node, .spare = &spare, .inverse_mass = inverse_mass, .antisymmetric = &antisymmetric};

  PetscFunctionBegin;
  PetscCall(MpmMarchRunPassesOn(march, &nodes, &step, 1, &project, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchProject(MpmMarch *march, PetscInt field, Vec node)
{
  PetscFunctionBegin;
  PetscCall(Project(march, field, march->particles->step, PETSC_FALSE, march->inverse_mass, node));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchProjectNext(MpmMarch *march, PetscInt field, Vec inverse_mass, Vec node)
{
  PetscFunctionBegin;
  PetscCall(Project(march, field, march->particles->step + 1, PETSC_TRUE, inverse_mass, node));
  PetscFunctionReturn(PETSC_SUCCESS);
}
