/*
   One pass of the march: blocks of particles go through the pass's operations while they are in the
   first-level cache.

   Particles are in the order of their places, so nodes come into reach and leave it in order too: they are
   zeroed just ahead of the blocks and divided by their mass just behind, while they are in cache. Nodes that
   other ranks share wait for the halo sum.
*/
#include <mpmstab/march.h>

#define BLOCK 512 /* particles: cell, xi and two fields of them fit 16 KiB */

/* Arrays of a pass, resolved once so that the block loop follows pointers only. */
typedef struct {
  const MpmPass *pass;
  PetscBool      moving, sample;
  PetscInt       whole[2]; /* drift before and after DRIFT */
  PetscReal      part[2];
  PetscInt      *cell;
  PetscReal     *xi, *particle[MPM_MAX_FIELDS], *node[MPM_MAX_FIELDS], *sum[MPM_MAX_FIELDS], *mass, *squares;
  PetscInt       zeroed, completed; /* nodes before these are ready to be summed to, or are complete */
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
  }
  PetscCall(MpmGridGetArray(march->grid, march->inverse_mass, &r->mass));
  r->zeroed    = -march->grid->ghost;
  r->completed = PetscMin(march->grid->ghost, march->grid->count);
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

static PetscErrorCode ZeroTo(Resolved *r, PetscInt end)
{
  const PetscInt n = end - r->zeroed;

  PetscFunctionBegin;
  if (n <= 0) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt s = 0; s < r->pass->nsums; s++)
    PetscCall(PetscArrayzero(r->sum[r->pass->sum[s]] + r->zeroed, n));
  if (r->pass->sums_mass) PetscCall(PetscArrayzero(r->mass + r->zeroed, n));
  r->zeroed = end;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* g_i = sum / mass, 0 where there is no mass. */
static void Complete(const Resolved *r, PetscInt lo, PetscInt hi)
{
  if (r->pass->sums_mass)
    for (PetscInt i = lo; i < hi; i++) r->mass[i] = r->mass[i] > 0 ? 1 / r->mass[i] : 0;
  for (PetscInt s = 0; s < r->pass->nsums; s++) {
    PetscReal *sum = r->sum[r->pass->sum[s]];

    for (PetscInt i = lo; i < hi; i++) sum[i] *= r->mass[i];
  }
}

static PetscErrorCode RunBlocks(const MpmMarch *march, Resolved *r)
{
  const MpmBasis *basis = march->scene->basis;
  const MpmGrid  *grid  = march->grid;
  const PetscInt  count = march->particles->count;

  PetscFunctionBegin;
  for (PetscInt begin = 0; begin < count; begin += BLOCK) {
    const PetscInt n    = PetscMin(BLOCK, count - begin);
    const PetscInt last = r->cell[begin + n - 1];
    const PetscInt sees =
        last + PetscMax(r->whole[0], r->whole[1]) + 1 + basis->reach_right; /* 1: a part of a cell on */
    const PetscInt left =
        PetscMin(last + PetscMin(r->whole[0], r->whole[1]) - basis->reach_left, grid->count - grid->ghost);

    PetscCall(ZeroTo(r, PetscMin(sees + 1, grid->count + grid->ghost)));
    RunBlock(r, begin, n);
    Complete(r, r->completed, left);
    r->completed = PetscMax(r->completed, left);
  }
  PetscCall(ZeroTo(r, grid->count + grid->ghost));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Shared nodes: sum over ranks, complete, and give ghosts their owners' values. */
static PetscErrorCode CompleteShared(const MpmMarch *march, const Resolved *r)
{
  const MpmPass *pass = r->pass;
  PetscReal     *sums[MPM_MAX_FIELDS + 1];

  PetscFunctionBegin;
  for (PetscInt s = 0; s < pass->nsums; s++) sums[s] = r->sum[pass->sum[s]];
  sums[pass->nsums] = r->mass;
  PetscCall(MpmGridSum(march->grid, pass->nsums + (pass->sums_mass ? 1 : 0), sums));
  Complete(r, 0, PetscMin(march->grid->ghost, march->grid->count));
  Complete(r, r->completed, march->grid->count);
  PetscCall(MpmGridSpread(march->grid, pass->nsums, sums));
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

PetscErrorCode MpmMarchRunPass(MpmMarch *march, const MpmPass *pass, PetscBool sample)
{
  const MpmParticles *particles = march->particles;
  Resolved            r         = {
                         .pass = pass, .moving = MpmSceneDrifts(march->scene), .sample = sample, .squares = march->squares};

  PetscFunctionBegin;
  if (r.moving) {
    PetscCall(MpmParticlesWhere(particles, particles->step, &r.whole[0], &r.part[0]));
    PetscCall(MpmParticlesWhere(particles, particles->step + 1, &r.whole[1], &r.part[1]));
  }
  PetscCall(GetArrays(march, &r));
  PetscCall(PetscLogEventBegin(march->pass_event, 0, 0, 0, 0));
  PetscCall(RunBlocks(march, &r));
  PetscCall(PetscLogEventEnd(march->pass_event, 0, 0, 0, 0));
  PetscCall(PetscLogEventBegin(march->sum_event, 0, 0, 0, 0));
  PetscCall(CompleteShared(march, &r));
  PetscCall(PetscLogEventEnd(march->sum_event, 0, 0, 0, 0));
  RunNodeOps(march, &r);
  PetscCall(RestoreArrays(march, &r));
  PetscFunctionReturn(PETSC_SUCCESS);
}
