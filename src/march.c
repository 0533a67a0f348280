/* The march: pass after pass, and migration before particles would run out of the ghost layer. */
#include <mpmstab/march.h>

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

/* Nodes beyond a wall have the sign that the table's own P2G of the field has, or are images of the same sign. */
static PetscBool IsOdd(const MpmTable *table, PetscInt field)
{
  const MpmOp *seen = MpmTableSeenBy(table, field);

  return seen && seen->kind == MPM_P2G ? table->odd[seen->dst] : PETSC_FALSE;
}

PetscErrorCode MpmMarchProject(MpmMarch *march, PetscInt field, Vec node)
{
  MpmPass  project = {.nops  = 1,
                      .nsums = 1,
                      .op    = {{.kind     = MPM_PASS_MAP,
                                 .kernel   = march->scene->basis->kernel[MPM_P2G],
                                 .a        = 1,
                                 .particle = field,
                                 .to_nodes = PETSC_TRUE,
                                 .weight   = MpmTableWeight(march->scene->table, MPM_P2G)}}};
  MpmMarch view    = *march;
  MpmScene scene   = *march->scene;
  MpmTable table   = *scene.table;

  PetscFunctionBegin;
  table.odd[0]  = IsOdd(scene.table, field);
  scene.table   = &table;
  view.scene    = &scene;
  view.nnodes   = 1;
  view.node[0]  = node;
  view.spare[0] = NULL;
  PetscCall(MpmMarchRunPasses(&view, 1, &project, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}
