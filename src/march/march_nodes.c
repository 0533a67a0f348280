/* What a march does on nodes alone, row by row of nodes. */
#include "march/nodal_solve.h"
#include <math.h>

PetscErrorCode MpmNodesSum(const MpmMarch *march, PetscInt n, PetscReal *const sums[], const MpmParity *const parity[],
                           PetscBool with_mass, PetscReal mass[])
{
  static const MpmParity even[MPM_MAX_DIM] = {MPM_EVEN, MPM_EVEN, MPM_EVEN};
  const MpmGrid         *grid              = march->grid;
  const MpmGridBox       box               = MpmGridBoxOf(grid, grid->ghost);
  const PetscInt         nodes             = box.hi[0] - box.lo[0];
  PetscReal             *all[MPM_MAX_FIELDS + 1];

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(march->sum_event, 0, 0, 0, 0));
  for (PetscInt f = 0; f < n; f++) MpmGridImages(grid, march->layout->grid, parity[f], PETSC_TRUE, all[f] = sums[f]);
  if (with_mass) MpmGridImages(grid, march->layout->grid, even, PETSC_TRUE, all[n] = mass);
  PetscCall(MpmGridSum(grid, n + (with_mass ? 1 : 0), all));
  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    const PetscInt row = MpmGridRow(grid, &box, r) + box.lo[0];
    PetscReal     *m   = mass + row;

    if (with_mass)
      for (PetscInt i = 0; i < nodes; i++) m[i] = m[i] > 0 ? 1 / m[i] : 0;
    for (PetscInt f = 0; f < n; f++) {
      PetscReal *restrict q = sums[f] + row;

      for (PetscInt i = 0; i < nodes; i++) q[i] *= m[i];
    }
  }
  for (PetscInt f = 0; f < n; f++) MpmGridImages(grid, march->layout->grid, parity[f], PETSC_FALSE, sums[f]);
  PetscCall(PetscLogEventEnd(march->sum_event, 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodesRefresh(const MpmMarch *march, const MpmParity parity[], PetscReal field[])
{
  const MpmGrid   *grid = march->grid;
  const MpmGridBox own = MpmGridBoxOf(grid, 0), box = MpmGridBoxOf(grid, grid->ghost);
  PetscInt         at[MPM_MAX_DIM];

  PetscFunctionBegin;
  for (at[2] = box.lo[2]; at[2] < box.hi[2]; at[2]++)
    for (at[1] = box.lo[1]; at[1] < box.hi[1]; at[1]++)
      for (at[0] = box.lo[0]; at[0] < box.hi[0]; at[0]++) {
        PetscInt ghost = 0, node = at[0];

        for (PetscInt a = 0; a < grid->dim; a++) ghost |= at[a] < own.lo[a] || at[a] >= own.hi[a];
        for (PetscInt a = 1; a < grid->dim; a++) node += grid->axis[a].stride * at[a];
        if (ghost) field[node] = 0; /* so that the sum of all copies is the owner's value */
      }
  PetscCall(MpmGridSum(grid, 1, &field));
  MpmGridImages(grid, march->layout->grid, parity, PETSC_FALSE, field);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void RunRow(const MpmOp *op, PetscInt stride, PetscInt n, const PetscReal *restrict f, PetscReal *restrict out)
{
  const PetscReal a = op->factor;

  if (op->kind == MPM_LAP && op->accumulates)
    for (PetscInt i = 0; i < n; i++) out[i] += a * ((f[i + stride] - f[i]) - (f[i] - f[i - stride]));
  else if (op->kind == MPM_LAP)
    for (PetscInt i = 0; i < n; i++) out[i] = a * ((f[i + stride] - f[i]) - (f[i] - f[i - stride]));
  else if (op->kind == MPM_LOCAL)
    for (PetscInt i = 0; i < n; i++) out[i] -= f[i] == 0 ? 0 : a * fabs(out[i]) * (f[i] > 0 ? 1 : -1);
  else if (op->accumulates)
    MpmNodeAdd(0, n, a, f, out);
  else
    MpmNodeCopy(0, n, a, f, out);
}

/* Sets the nodes on one wall, if they are among this rank's nodes and ghosts. */
static void SetWall(const MpmGrid *grid, const MpmOp *op, const PetscReal *src, PetscReal *dst)
{
  const MpmGridAxis *axis = &grid->axis[op->axis];
  const PetscInt     wall = (op->side ? axis->all - 1 : 0) - axis->first;
  MpmGridBox         box  = MpmGridBoxOf(grid, grid->ghost);

  if (wall < -grid->ghost || wall >= axis->nodes + grid->ghost) return;
  box.lo[op->axis] = wall;
  box.hi[op->axis] = wall + 1;
  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    const PetscInt row = MpmGridRow(grid, &box, r);

    for (PetscInt i = row + box.lo[0]; i < row + box.hi[0]; i++) dst[i] = op->factor == 0 ? 0 : op->factor * src[i];
  }
}

/*
   Adds what colliders make of a velocity, op->src and the components next to it, along op->axis. The images beyond
   walls follow from the nodes inside. No particle feels a node without mass.
*/
static void Collide(const MpmMarch *march, const MpmOp *op, PetscInt depth, PetscReal time,
                    const PetscReal inverse_mass[], PetscReal *const field[])
{
  const MpmGrid   *grid = march->grid;
  const MpmGridBox box  = MpmGridBoxOf(grid, grid->ghost - depth);
  PetscInt         at[MPM_MAX_DIM];

  for (at[2] = box.lo[2]; at[2] < box.hi[2]; at[2]++)
    for (at[1] = box.lo[1]; at[1] < box.hi[1]; at[1]++)
      for (at[0] = box.lo[0]; at[0] < box.hi[0]; at[0]++) {
        PetscReal x[MPM_MAX_DIM], u[MPM_MAX_DIM], slope[MPM_MAX_DIM * MPM_MAX_DIM], before, sign;
        PetscInt  node = at[0];

        for (PetscInt a = 1; a < grid->dim; a++) node += grid->axis[a].stride * at[a];
        if (inverse_mass[node] == 0) continue;
        for (PetscInt a = 0; a < grid->dim; a++) {
          x[a] = MpmDirectionImage(&march->layout->grid[a], grid->axis[a].first + at[a], MPM_EVEN, &sign);
          u[a] = field[op->src - op->axis + a][node];
        }
        before = u[op->axis];
        if (MpmCollidersProject(march->layout->colliders, grid->dim, x, time, u, slope))
          field[op->dst][node] += u[op->axis] - before;
      }
  MpmGridImages(grid, march->layout->grid, march->scheme->table->parity[op->dst], PETSC_FALSE, field[op->dst]);
}

PetscErrorCode MpmNodesRun(const MpmMarchArrays *arrays, const MpmOp *op, PetscInt depth, PetscInt64 step,
                           PetscReal *const field[])
{
  const MpmMarch  *march = arrays->march;
  const MpmGrid   *grid  = march->grid;
  const MpmGridBox box   = MpmGridBoxOf(grid, grid->ghost - depth);

  PetscFunctionBegin;
  if (op->kind == MPM_WALL)
    SetWall(grid, op, field[op->src], field[op->dst]);
  else if (op->kind == MPM_COLLIDE)
    Collide(march, op, depth, march->scene ? MpmMarchTime(march, step) : 0, arrays->sum[MPM_MASSES], field);
  else if (op->kind == MPM_SOLVE)
    PetscCall(MpmNodalSolveApply(march->nodal_solve, arrays, step, march->scheme->table->parity[op->dst],
                                 field[op->src], field[op->dst], NULL));
  else
    for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
      const PetscInt at = MpmGridRow(grid, &box, r) + box.lo[0];

      if (op->dst == op->src)
        MpmScale(box.hi[0] - box.lo[0], op->factor, field[op->dst] + at);
      else
        RunRow(op, grid->axis[op->axis].stride, box.hi[0] - box.lo[0], field[op->src] + at, field[op->dst] + at);
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}
