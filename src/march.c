/*
   The march: for each pass, blocks of particles go through the pass's operations while they are in the
   first-level cache; then sums over shared nodes, division by nodal mass, node operations.
*/
#include <mpmstab/march.h>
#include <math.h>

#define BLOCK 512 /* particles: cell, xi and two fields of them fit 16 KiB */

static PetscLogEvent pass_event, sum_event, migrate_event;

static PetscErrorCode RegisterEvents(void)
{
  static PetscBool done = PETSC_FALSE;
  PetscClassId     id;

  PetscFunctionBegin;
  if (done) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscClassIdRegister("MpmMarch", &id));
  PetscCall(PetscLogEventRegister("MpmPass", id, &pass_event));
  PetscCall(PetscLogEventRegister("MpmGridSum", id, &sum_event));
  PetscCall(PetscLogEventRegister("MpmMigrate", id, &migrate_event));
  done = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Arrays of a pass, resolved once so that the block loop follows pointers only. */
typedef struct {
  const MpmPass *pass;
  PetscBool      moving, sample;
  PetscInt       whole[2]; /* drift before and after DRIFT */
  PetscReal      part[2];
  PetscInt      *cell;
  PetscReal     *xi, *particle[MPM_MAX_FIELDS], *node[MPM_MAX_FIELDS], *sum[MPM_MAX_FIELDS], *mass, *squares;
} Resolved;

static void RunBlock(const Resolved *r, PetscInt begin, PetscInt n)
{
  PetscInt         cell_now[BLOCK];
  PetscReal        xi_now[BLOCK];
  const PetscInt  *cell = r->cell + begin;
  const PetscReal *xi   = r->xi + begin;

  if (r->moving) {
    MpmPlaceBlock(n, r->cell + begin, r->xi + begin, r->whole[0], r->part[0], cell_now, xi_now);
    cell = cell_now;
    xi   = xi_now;
  }
  for (const MpmPassOp *op = r->pass->op; op < r->pass->op + r->pass->nops; op++) {
    PetscReal *q = r->particle[op->particle] + begin;

    if (op->kind == MPM_PASS_MAP)
      op->kernel(n, cell, xi, op->a, q, (op->to_nodes ? r->sum : r->node)[op->node]);
    else if (op->kind == MPM_PASS_MASS)
      op->mass_kernel(n, cell, xi, q, r->sum[op->node], r->mass);
    else if (op->kind == MPM_PASS_DRIFT)
      MpmPlaceBlock(n, r->cell + begin, r->xi + begin, r->whole[1], r->part[1], cell_now, xi_now);
    else if (r->sample)
      r->squares[op->particle] += MpmSumSquares(n, q);
  }
}

static PetscErrorCode GetArrays(MpmMarch *march, Resolved *r)
{
  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(march->particles, MpmFieldCell, &r->cell));
  PetscCall(MpmParticlesGet(march->particles, MpmFieldXi, &r->xi));
  for (PetscInt f = 0; march->scene->formulation->particle_fields[f]; f++)
    PetscCall(
        MpmParticlesGet(march->particles, march->scene->formulation->particle_fields[f], &r->particle[f]));
  for (PetscInt f = 0; f < march->nnodes; f++)
    PetscCall(MpmGridGetArray(march->grid, march->node[f], &r->node[f]));
  for (PetscInt s = 0; s < r->pass->nsums; s++) {
    const PetscInt f = r->pass->sum[s];

    if (march->spare[f])
      PetscCall(MpmGridGetArray(march->grid, march->spare[f], &r->sum[f]));
    else
      r->sum[f] = r->node[f];
    PetscCall(PetscArrayzero(r->sum[f] - march->grid->ghost, march->grid->count + 2 * march->grid->ghost));
  }
  PetscCall(MpmGridGetArray(march->grid, march->inverse_mass, &r->mass));
  if (r->pass->sums_mass)
    PetscCall(PetscArrayzero(r->mass - march->grid->ghost, march->grid->count + 2 * march->grid->ghost));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Fields summed into a spare array change places with it. */
static PetscErrorCode RestoreArrays(MpmMarch *march, Resolved *r)
{
  PetscFunctionBegin;
  PetscCall(MpmGridRestoreArray(march->grid, march->inverse_mass, &r->mass));
  for (PetscInt s = 0; s < r->pass->nsums; s++) {
    const PetscInt f = r->pass->sum[s];

    if (march->spare[f]) PetscCall(MpmGridRestoreArray(march->grid, march->spare[f], &r->sum[f]));
  }
  for (PetscInt f = 0; f < march->nnodes; f++)
    PetscCall(MpmGridRestoreArray(march->grid, march->node[f], &r->node[f]));
  for (PetscInt s = 0; s < r->pass->nsums; s++) {
    const PetscInt f     = r->pass->sum[s];
    Vec            other = march->spare[f];

    if (!other) continue;
    march->spare[f] = march->node[f];
    march->node[f]  = other;
  }
  for (PetscInt f = 0; march->scene->formulation->particle_fields[f]; f++)
    PetscCall(MpmParticlesRestore(march->particles, march->scene->formulation->particle_fields[f],
                                  &r->particle[f]));
  PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi, &r->xi));
  PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell, &r->cell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* g_i = sum / mass on owned nodes, 0 where there is no mass; then ghosts get their owners' values. */
static PetscErrorCode CompleteSums(MpmMarch *march, const Resolved *r)
{
  const MpmPass *pass = r->pass;
  PetscReal     *sums[MPM_MAX_FIELDS + 1];

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(sum_event, 0, 0, 0, 0));
  for (PetscInt s = 0; s < pass->nsums; s++) sums[s] = r->sum[pass->sum[s]];
  sums[pass->nsums] = r->mass;
  PetscCall(MpmGridSum(march->grid, pass->nsums + (pass->sums_mass ? 1 : 0), sums));
  if (pass->sums_mass)
    for (PetscInt i = 0; i < march->grid->count; i++) r->mass[i] = r->mass[i] > 0 ? 1 / r->mass[i] : 0;
  for (PetscInt s = 0; s < pass->nsums; s++)
    for (PetscInt i = 0; i < march->grid->count; i++) sums[s][i] *= r->mass[i];
  PetscCall(MpmGridSpread(march->grid, pass->nsums, sums));
  PetscCall(PetscLogEventEnd(sum_event, 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void RunNodeOps(const MpmMarch *march, const Resolved *r)
{
  for (const MpmNodeOp *op = r->pass->node_op; op < r->pass->node_op + r->pass->nnode_ops; op++) {
    const PetscInt beyond = march->grid->ghost - op->depth, lo = -beyond, hi = march->grid->count + beyond;
    PetscReal     *dst = r->sum[op->dst] ? r->sum[op->dst] : r->node[op->dst];
    PetscReal     *src = r->sum[op->src] ? r->sum[op->src] : r->node[op->src];

    if (op->kind == MPM_LAP)
      MpmNodeLaplacian(lo, hi, op->a, src, dst);
    else
      MpmNodeAdd(lo, hi, src, dst);
  }
}

static PetscErrorCode RunPass(MpmMarch *march, const MpmPass *pass, PetscBool sample)
{
  MpmParticles *particles = march->particles;
  Resolved      r         = {
                   .pass = pass, .moving = MpmSceneDrifts(march->scene), .sample = sample, .squares = march->squares};

  PetscFunctionBegin;
  if (r.moving) {
    PetscCall(MpmParticlesWhere(particles, particles->step, &r.whole[0], &r.part[0]));
    PetscCall(MpmParticlesWhere(particles, particles->step + 1, &r.whole[1], &r.part[1]));
  }
  PetscCall(GetArrays(march, &r));
  PetscCall(PetscLogEventBegin(pass_event, 0, 0, 0, 0));
  for (PetscInt begin = 0; begin < particles->count; begin += BLOCK)
    RunBlock(&r, begin, PetscMin(BLOCK, particles->count - begin));
  PetscCall(PetscLogEventEnd(pass_event, 0, 0, 0, 0));
  PetscCall(CompleteSums(march, &r));
  RunNodeOps(march, &r);
  PetscCall(RestoreArrays(march, &r));
  if (pass->drifts) particles->step++;
  if (pass->rebase) {
    PetscCall(PetscLogEventBegin(migrate_event, 0, 0, 0, 0));
    PetscCall(MpmParticlesRebase(particles, march->grid));
    PetscCall(PetscLogEventEnd(migrate_event, 0, 0, 0, 0));
    march->migrations++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Particles may run into the ghost layer; before they would run beyond it they go to their owners. */
static PetscErrorCode MigrateInTime(MpmMarch *march)
{
  PetscInt  whole;
  PetscReal part;

  PetscFunctionBegin;
  if (!march->slack) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmParticlesWhere(march->particles, march->step + 1, &whole, &part));
  if (PetscAbsInt(whole) + 1 <= march->slack) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscLogEventBegin(migrate_event, 0, 0, 0, 0));
  PetscCall(MpmParticlesRebase(march->particles, march->grid));
  PetscCall(PetscLogEventEnd(migrate_event, 0, 0, 0, 0));
  march->migrations++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchStep(MpmMarch *march, PetscBool sample)
{
  PetscFunctionBegin;
  if (sample) PetscCall(PetscArrayzero(march->squares, MPM_MAX_FIELDS));
  for (PetscInt p = 0; p < march->schedule.npasses; p++)
    PetscCall(RunPass(march, &march->schedule.pass[p], sample));
  march->step++;
  PetscCall(MigrateInTime(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchStart(MpmMarch *march)
{
  PetscFunctionBegin;
  PetscCall(RegisterEvents());
  PetscCall(RunPass(march, &march->schedule.start, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchProject(MpmMarch *march, PetscInt field, Vec node)
{
  MpmPass  project = {.nops  = 1,
                      .nsums = 1,
                      .op    = {{.kind     = MPM_PASS_MAP,
                                 .kernel   = march->scene->basis->p2g,
                                 .particle = field,
                                 .to_nodes = PETSC_TRUE}}};
  MpmMarch view    = *march;

  PetscFunctionBegin;
  view.nnodes   = 1;
  view.node[0]  = node;
  view.spare[0] = NULL;
  PetscCall(RunPass(&view, &project, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}
