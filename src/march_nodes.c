/* Nodes of the march: images beyond walls, operations between node fields. */
#include <mpmstab/march_nodes.h>

void MpmMarchFold(const MpmMarch *march, const MpmPass *pass, PetscReal *const field[], PetscReal mass[])
{
  const PetscReal even[2] = {1, 1};
  PetscReal       sign[2];

  for (PetscInt s = 0; s < pass->nsums; s++) {
    MpmSceneMirror(march->scene, march->scene->table->odd[pass->sum[s]], sign);
    MpmGridFold(march->grid, sign, field[pass->sum[s]]);
  }
  if (pass->sums_mass) MpmGridFold(march->grid, even, mass);
}

void MpmMarchReflect(const MpmMarch *march, const MpmPass *pass, PetscReal *const field[])
{
  PetscReal sign[2];

  for (PetscInt s = 0; s < pass->nsums; s++) {
    MpmSceneMirror(march->scene, march->scene->table->odd[pass->sum[s]], sign);
    MpmGridReflect(march->grid, sign, field[pass->sum[s]]);
  }
}

/* Sets the wall node of one end, wherever it is among this rank's nodes and ghosts. */
static void SetWall(const MpmGrid *grid, const MpmNodeOp *op, const PetscReal *src, PetscReal *dst)
{
  const PetscInt wall = (op->end ? grid->cells : 0) - grid->first;

  if (wall >= -grid->ghost && wall < grid->nodes + grid->ghost) dst[wall] = op->a == 0 ? 0 : op->a * src[wall];
}

PetscErrorCode MpmMarchNodeOps(const MpmMarch *march, const MpmPass *pass, PetscReal *const field[],
                               const PetscReal inverse_mass[], const MpmPlaces *places)
{
  const MpmGrid *grid = march->grid;

  PetscFunctionBegin;
  for (const MpmNodeOp *op = pass->node_op; op < pass->node_op + pass->nnode_ops; op++) {
    const PetscInt beyond = grid->ghost - op->depth, lo = -beyond, hi = grid->nodes + beyond;
    PetscReal     *src = field[op->src], *dst = field[op->dst];

    if (op->kind == MPM_LAP)
      MpmNodeLaplacian(lo, hi, op->a, src, dst);
    else if (op->kind == MPM_ADD)
      MpmNodeAdd(lo, hi, op->a, src, dst);
    else if (op->kind == MPM_COPY)
      MpmNodeCopy(lo, hi, op->a, src, dst);
    else if (op->kind == MPM_WALL)
      SetWall(grid, op, src, dst);
    else
      PetscCall(MpmNodalSolveApply(march->nodal_solve, march->particles, places, march->scene->table->odd[op->dst],
                                   inverse_mass, src, dst));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
