/* One pass in more than one dimension: particles, the sum over ranks, and the node operations that follow. */
#include "march/clouds.h"
#include "march/implicit_solve.h"

static PetscErrorCode GetArrays(MpmMarch *march, const MpmNodeVectors *nodes, PetscInt64 step, const MpmPass *pass,
                                MpmRowArrays *a)
{
  PetscFunctionBegin;
  a->step = step;
  if (march->particles->own) PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &a->id));
  for (PetscInt d = 0; d < march->grid->dim; d++) {
    PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[d], &a->cell[d]));
    PetscCall(MpmParticlesGet(march->particles, MpmFieldXi[d], &a->xi[d]));
    for (PetscInt after = 0; after < 2; after++)
      PetscCall(MpmParticlesWhere(march->particles, d, step + after, &a->whole[after][d], &a->part[after][d]));
  }
  for (PetscInt f = 0; march->scheme->table->fields[f]; f++)
    PetscCall(MpmParticlesGet(march->particles, march->scheme->table->fields[f], &a->particle[f]));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (march->layout->varies[w]) PetscCall(MpmParticlesGet(march->particles, MpmPropertyNames[w], &a->weight[w]));
  for (PetscInt f = 0; f < nodes->n; f++) PetscCall(MpmGridGetArray(march->grid, nodes->node[f], &a->node[f]));
  for (PetscInt i = 0; i < pass->nsums; i++) {
    const PetscInt f = pass->sum[i];

    a->sum[f] = a->node[f];
    if (nodes->spare[f]) PetscCall(MpmGridGetArray(march->grid, nodes->spare[f], &a->sum[f]));
  }
  PetscCall(MpmGridGetArray(march->grid, nodes->inverse_mass, &a->sum[MPM_MASSES]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Fields that were summed to their spare array change places with it. */
static PetscErrorCode RestoreArrays(const MpmMarch *march, const MpmNodeVectors *nodes, const MpmPass *pass,
                                    MpmRowArrays *a)
{
  PetscFunctionBegin;
  PetscCall(MpmGridRestoreArray(march->grid, nodes->inverse_mass, &a->sum[MPM_MASSES]));
  for (PetscInt i = 0; i < pass->nsums; i++) {
    const PetscInt f    = pass->sum[i];
    const Vec      kept = nodes->node[f];

    if (!nodes->spare[f]) continue;
    PetscCall(MpmGridRestoreArray(march->grid, nodes->spare[f], &a->sum[f]));
    PetscCall(MpmGridRestoreArray(march->grid, nodes->node[f], &a->node[f]));
    nodes->node[f]  = nodes->spare[f];
    nodes->spare[f] = kept;
    PetscCall(MpmGridGetArray(march->grid, nodes->node[f], &a->node[f]));
  }
  for (PetscInt f = 0; f < nodes->n; f++) PetscCall(MpmGridRestoreArray(march->grid, nodes->node[f], &a->node[f]));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (march->layout->varies[w]) PetscCall(MpmParticlesRestore(march->particles, MpmPropertyNames[w], &a->weight[w]));
  for (PetscInt f = 0; march->scheme->table->fields[f]; f++)
    PetscCall(MpmParticlesRestore(march->particles, march->scheme->table->fields[f], &a->particle[f]));
  for (PetscInt d = 0; d < march->grid->dim; d++) {
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[d], &a->xi[d]));
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[d], &a->cell[d]));
  }
  if (march->particles->own) PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &a->id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Folds the sums of a field at images beyond walls, or sets the images. One axis comes after the other. */
static void Images(const MpmMarch *march, const MpmParity parity[], PetscBool fold, PetscReal array[])
{
  for (PetscInt d = 0; d < march->grid->dim; d++) {
    PetscReal sign[2];

    MpmDirectionMirror(&march->layout->grid[d], parity[d], sign);
    if (fold)
      MpmGridFold(march->grid, d, sign, array);
    else
      MpmGridReflect(march->grid, d, sign, array);
  }
}

/* Divides the sums at this rank's nodes and ghosts by the masses; they become 0 where there is no mass. */
static void Complete(const MpmGrid *grid, const MpmPass *pass, PetscReal *const sum[])
{
  const MpmGridBox box = MpmGridBoxOf(grid, grid->ghost);
  const PetscInt   n   = box.hi[0] - box.lo[0];

  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    const PetscInt row = MpmGridRow(grid, &box, r) + box.lo[0];
    PetscReal     *m   = sum[MPM_MASSES] + row;

    if (pass->sums_mass)
      for (PetscInt i = 0; i < n; i++) m[i] = m[i] > 0 ? 1 / m[i] : 0;
    for (PetscInt s = 0; s < pass->nsums; s++) {
      PetscReal *restrict q = sum[pass->sum[s]] + row;

      for (PetscInt i = 0; i < n; i++) q[i] *= m[i];
    }
  }
}

/* Sums over ranks what particles gave to shared nodes, and completes all nodes and ghosts. */
static PetscErrorCode SumNodes(const MpmMarch *march, const MpmNodeVectors *nodes, const MpmPass *pass,
                               PetscReal *const sum[])
{
  static const MpmParity even[MPM_MAX_DIM] = {MPM_EVEN, MPM_EVEN, MPM_EVEN};
  PetscReal             *sums[MPM_MAX_FIELDS + 1];

  PetscFunctionBegin;
  for (PetscInt s = 0; s < pass->nsums; s++) {
    sums[s] = sum[pass->sum[s]];
    Images(march, nodes->parity[pass->sum[s]], PETSC_TRUE, sums[s]);
  }
  sums[pass->nsums] = sum[MPM_MASSES];
  if (pass->sums_mass) Images(march, even, PETSC_TRUE, sum[MPM_MASSES]);
  PetscCall(MpmGridSum(march->grid, pass->nsums + (pass->sums_mass ? 1 : 0), sums));
  Complete(march->grid, pass, sum);
  for (PetscInt s = 0; s < pass->nsums; s++) Images(march, nodes->parity[pass->sum[s]], PETSC_FALSE, sums[s]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number of the plan of a pass, or MPM_NONE. */
static PetscInt PlanOf(const MpmMarch *march, const MpmPass *pass)
{
  for (PetscInt p = 0; MpmMarchPass(march, p); p++)
    if (pass == MpmMarchPass(march, p)) return p;
  return MPM_NONE;
}

static PetscErrorCode RunParticles(MpmMarch *march, const MpmPass *pass, const MpmRowArrays *arrays, PetscInt number)
{
  MpmCloudPlan *clouds;
  PetscReal    *bundles;

  PetscFunctionBegin;
  if (march->clouds && number != MPM_NONE)
    PetscCall(MpmCloudsRun(arrays, &march->clouds[number], march->bundles));
  else if (march->clouds) {
    PetscCall(PetscNew(&clouds));
    MpmCloudPlanCompile(arrays->plan, march->scheme->basis, march->grid->dim, march->scheme->table->nstate, clouds);
    PetscCall(PetscMalloc1(MpmCloudsSize(march->grid, clouds), &bundles));
    PetscCall(MpmCloudsRun(arrays, clouds, bundles));
    PetscCall(PetscFree(bundles));
    PetscCall(PetscFree(clouds));
  } else {
    for (PetscInt s = 0; s < pass->nsums; s++) PetscCall(MpmGridZero(march->grid, arrays->sum[pass->sum[s]]));
    if (pass->sums_mass) PetscCall(MpmGridZero(march->grid, arrays->sum[MPM_MASSES]));
    MpmRowsRun(arrays);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchRunRows(MpmMarch *march, const MpmNodeVectors *nodes, PetscInt64 *step, const MpmPass *pass,
                               PetscBool sample)
{
  static const MpmPass nothing;

  const PetscInt number = PlanOf(march, pass);
  MpmRowArrays   arrays = {.march = march, .sample = sample, .squares = march->squares};
  MpmRowPlan    *own    = NULL; /* of a pass that is none of the schedule's */
  PetscReal     *after[MPM_MAX_FIELDS];
  PetscInt       o = 0;

  PetscFunctionBegin;
  if (number == MPM_NONE) {
    PetscCall(PetscNew(&own));
    MpmRowPlanCompile(pass, march->scheme->basis, march->grid->dim, own);
  }
  arrays.plan = own ? own : &march->plans[number];
  PetscCall(GetArrays(march, nodes, *step, pass, &arrays));
  PetscCall(PetscLogEventBegin(march->pass_event, 0, 0, 0, 0));
  PetscCall(RunParticles(march, pass, &arrays, number));
  PetscCall(PetscLogEventEnd(march->pass_event, 0, 0, 0, 0));
  if (pass->drifts) ++*step;
  PetscCall(PetscLogEventBegin(march->sum_event, 0, 0, 0, 0));
  PetscCall(SumNodes(march, nodes, pass, arrays.sum));
  PetscCall(PetscLogEventEnd(march->sum_event, 0, 0, 0, 0));
  for (PetscInt f = 0; f < nodes->n; f++) after[f] = arrays.sum[f] ? arrays.sum[f] : arrays.node[f];
  PetscCall(MpmRowsNodeOps(march, pass, *step, &arrays, after, &o));
  PetscCall(RestoreArrays(march, nodes, pass, &arrays));
  while (o < pass->nnode_ops) { /* a solve takes particles through passes of its own */
    PetscCall(MpmImplicitSolveApply(march, *step, &pass->node_op[o]));
    o += march->grid->dim;
    PetscCall(GetArrays(march, nodes, *step, &nothing, &arrays));
    PetscCall(MpmRowsNodeOps(march, pass, *step, &arrays, arrays.node, &o));
    PetscCall(RestoreArrays(march, nodes, &nothing, &arrays));
  }
  PetscCall(PetscFree(own));
  PetscFunctionReturn(PETSC_SUCCESS);
}
