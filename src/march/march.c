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
   Through a view of the march whose table has the one node field that is summed to. inverse_mass: at the next step's
   places, with masses of their own; NULL: at the present ones.
*/
static PetscErrorCode Project(const MpmMarch *march, PetscInt field, Vec inverse_mass, Vec node)
{
  const MpmBasis *basis   = march->scene->basis;
  MpmPass         project = {.nops  = 1,
                             .nsums = 1,
                             .op    = {{.kind        = MPM_PASS_MAP,
                                        .kernel      = basis->kernel[MPM_P2G],
                                        .mass_kernel = basis->p2g_mass,
                                        .a           = 1,
                                        .particle    = field,
                                        .to_nodes    = PETSC_TRUE,
                                        .weight      = MpmTableWeight(march->scene->table, MPM_P2G)}}};
  MpmMarch        view    = *march;
  MpmScene        scene   = *march->scene;
  MpmTable        table   = *scene.table;
  MpmParticles    next    = *march->particles;

  PetscFunctionBegin;
  table.antisymmetric[0] = MpmTableIsAntisymmetric(scene.table, field);
  scene.table            = &table;
  view.scene             = &scene;
  view.nnodes            = 1;
  view.node[0]           = node;
  view.spare[0]          = NULL;
  if (inverse_mass) {
    next.step++;
    view.particles     = &next;
    view.inverse_mass  = inverse_mass;
    project.op[0].kind = MPM_PASS_MASS;
    project.sums_mass  = PETSC_TRUE;
  }
  PetscCall(MpmMarchRunPasses(&view, 1, &project, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchProject(MpmMarch *march, PetscInt field, Vec node)
{
  PetscFunctionBegin;
  PetscCall(Project(march, field, NULL, node));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchProjectNext(MpmMarch *march, PetscInt field, Vec inverse_mass, Vec node)
{
  PetscFunctionBegin;
  PetscCall(Project(march, field, inverse_mass, node));
  PetscFunctionReturn(PETSC_SUCCESS);
}
