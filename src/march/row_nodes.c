/* Node operations in more than one dimension, row by row of nodes. */
#include "march/rows.h"

static void RunRow(const MpmNodeOp *op, PetscInt stride, PetscInt n, const PetscReal *restrict f,
                   PetscReal *restrict out)
{
  const PetscReal a = op->a;

  if (op->kind == MPM_LAP && op->accumulates)
    for (PetscInt i = 0; i < n; i++) out[i] += a * ((f[i + stride] - f[i]) - (f[i] - f[i - stride]));
  else if (op->kind == MPM_LAP)
    for (PetscInt i = 0; i < n; i++) out[i] = a * ((f[i + stride] - f[i]) - (f[i] - f[i - stride]));
  else if (op->accumulates)
    MpmNodeAdd(0, n, a, f, out);
  else
    MpmNodeCopy(0, n, a, f, out);
}

/* Sets the nodes on one wall, if they are among this rank's nodes and ghosts. */
static void SetWall(const MpmGrid *grid, const MpmNodeOp *op, const PetscReal *src, PetscReal *dst)
{
  const MpmGridAxis *axis = &grid->axis[op->axis];
  const PetscInt     wall = (op->side ? axis->all - 1 : 0) - axis->first;
  MpmGridBox         box  = MpmGridBoxOf(grid, grid->ghost);

  if (wall < -grid->ghost || wall >= axis->nodes + grid->ghost) return;
  box.lo[op->axis] = wall;
  box.hi[op->axis] = wall + 1;
  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    const PetscInt row = MpmGridRow(grid, &box, r);

    for (PetscInt i = row + box.lo[0]; i < row + box.hi[0]; i++) dst[i] = op->a == 0 ? 0 : op->a * src[i];
  }
}

/* Solves the nodal system with the particles at the places of a step. */
static PetscErrorCode Solve(const MpmMarch *march, const MpmNodeOp *op, PetscInt64 step, const MpmRowArrays *arrays,
                            PetscReal *const field[])
{
  MpmPlaces places = {.mass = arrays->weight[MPM_MASS]};

  PetscFunctionBegin;
  for (PetscInt a = 0; a < march->layout->dim; a++) {
    places.cell[a] = arrays->cell[a];
    places.xi[a]   = arrays->xi[a];
  }
  PetscCall(MpmNodalSolveApply(march->nodal_solve, march->particles, step, &places,
                               march->scheme->table->parity[op->dst], arrays->sum[MPM_MASSES], field[op->src],
                               field[op->dst]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRowsNodeOps(const MpmMarch *march, const MpmPass *pass, PetscInt64 step, const MpmRowArrays *arrays,
                              PetscReal *const field[], PetscInt *next)
{
  const MpmGrid *grid = march->grid;

  PetscFunctionBegin;
  for (; *next < pass->nnode_ops && pass->node_op[*next].kind != MPM_IMPLICIT; ++*next) {
    const MpmNodeOp *op = &pass->node_op[*next];

    if (op->kind == MPM_WALL)
      SetWall(grid, op, field[op->src], field[op->dst]);
    else if (!MpmNodeOpIsLocal(op->kind))
      PetscCall(Solve(march, op, step, arrays, field));
    else {
      const MpmGridBox box = MpmGridBoxOf(grid, grid->ghost - op->depth);

      for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
        const PetscInt at = MpmGridRow(grid, &box, r) + box.lo[0];

        if (op->dst == op->src) {
          MpmScale(box.hi[0] - box.lo[0], op->a, field[op->dst] + at);
          continue;
        }
        RunRow(op, grid->axis[op->axis].stride, box.hi[0] - box.lo[0], field[op->src] + at, field[op->dst] + at);
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
