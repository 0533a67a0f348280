/* The part of a pass that concerns nodes alone: images beyond walls, operations between node fields. */
#include "march/march_nodes.h"

void MpmMarchFold(const MpmMarch *march, const MpmParity parity[][MPM_MAX_DIM], const MpmPass *pass,
                  PetscReal *const field[], PetscReal mass[])
{
  const PetscReal even[2] = {1, 1};
  PetscReal       sign[2];

  for (PetscInt s = 0; s < pass->nsums; s++) {
    MpmDirectionMirror(&march->layout->grid[0], parity[pass->sum[s]][0], sign);
    MpmGridFold(march->grid, 0, sign, field[pass->sum[s]]);
  }
  if (pass->sums_mass) MpmGridFold(march->grid, 0, even, mass);
}

void MpmMarchReflect(const MpmMarch *march, const MpmParity parity[][MPM_MAX_DIM], const MpmPass *pass,
                     PetscReal *const field[])
{
  PetscReal sign[2];

  for (PetscInt s = 0; s < pass->nsums; s++) {
    MpmDirectionMirror(&march->layout->grid[0], parity[pass->sum[s]][0], sign);
    MpmGridReflect(march->grid, 0, sign, field[pass->sum[s]]);
  }
}

/* Sets the wall node of one end, if it is among this rank's nodes and ghosts. */
static void SetWall(const MpmGrid *grid, const MpmNodeOp *op, const PetscReal *src, PetscReal *dst)
{
  const PetscInt wall = (op->side ? grid->axis[0].all - 1 : 0) - grid->axis[0].first;

  if (wall >= -grid->ghost && wall < grid->axis[0].nodes + grid->ghost) dst[wall] = op->a == 0 ? 0 : op->a * src[wall];
}

/* Does a local node operation (MpmNodeOpIsLocal) on nodes [lo, hi). */
static void RunLocal(const MpmNodeOp *op, PetscReal *const field[], PetscInt lo, PetscInt hi)
{
  if (op->dst == op->src)
    MpmScale(hi - lo, op->a, field[op->dst] + lo);
  else if (op->kind == MPM_LAP && op->accumulates)
    MpmNodeAddLaplacian(lo, hi, op->a, field[op->src], field[op->dst]);
  else if (op->kind == MPM_LAP)
    MpmNodeLaplacian(lo, hi, op->a, field[op->src], field[op->dst]);
  else if (op->accumulates)
    MpmNodeAdd(lo, hi, op->a, field[op->src], field[op->dst]);
  else
    MpmNodeCopy(lo, hi, op->a, field[op->src], field[op->dst]);
}

void MpmMarchFollowNodes(const MpmPass *pass, PetscReal *const field[], PetscInt lo, PetscInt hi, MpmNodesDone done[])
{
  PetscInt reach  = 0,
           margin = 0; /* reach of the operations so far; distance of the present one from the ends of [lo, hi) */

  for (PetscInt o = 0; o < pass->nnode_ops && MpmNodeOpIsLocal(pass->node_op[o].kind); o++) {
    reach = PetscMax(reach, MpmOpTraitsOf(pass->node_op[o].kind).halo);
    margin += reach;
    if (hi - margin <= PetscMax(done[o].hi, lo + margin)) return;
    if (done[o].lo == done[o].hi) done[o].lo = done[o].hi = lo + margin;
    RunLocal(&pass->node_op[o], field, done[o].hi, hi - margin);
    done[o].hi = hi - margin;
  }
}

PetscErrorCode MpmMarchNodeOps(const MpmMarch *march, PetscInt64 step, const MpmPass *pass, PetscReal *const field[],
                               const PetscReal inverse_mass[], const MpmPlaces *places, const MpmNodesDone done[],
                               PetscInt *next)
{
  const MpmGrid *grid = march->grid;

  PetscFunctionBegin;
  for (; *next < pass->nnode_ops && pass->node_op[*next].kind != MPM_IMPLICIT; ++*next) {
    const PetscInt   o      = *next;
    const MpmNodeOp *op     = &pass->node_op[o];
    const PetscInt   beyond = grid->ghost - op->depth;

    if (MpmNodeOpIsLocal(op->kind)) {
      RunLocal(op, field, -beyond, done[o].lo);
      RunLocal(op, field, done[o].hi, grid->axis[0].nodes + beyond);
    } else if (op->kind == MPM_WALL)
      SetWall(grid, op, field[op->src], field[op->dst]);
    else
      PetscCall(MpmNodalSolveApply(march->nodal_solve, march->particles, step, places,
                                   march->scheme->table->parity[op->dst], inverse_mass, field[op->src],
                                   field[op->dst]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
