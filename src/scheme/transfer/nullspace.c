/*
   The null space of P2G taken out: F = W (P W)^{-1} P, what the grid sees of the particles.

   Source: after Gritton and Berzins 2017.
*/
#include <mpmstab/table.h>

static PetscErrorCode Filter(MpmTable *table, const MpmTransferNumbers *numbers, PetscInt particle, PetscInt node)
{
  PetscInt solution;

  PetscFunctionBegin;
  PetscCall(MpmTableNode(table, node, &solution));
  PetscCall(MpmTableAppend(table, (MpmOp)SOLVE(solution, node)));
  PetscCall(MpmTransferFromGrid(table, numbers, particle, solution));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Retains(const MpmTransferNumbers *numbers, PetscReal alpha)
{
  (void)numbers;
  return alpha > 0 ? 1 : 0;
}

const MpmTransfer MpmNullspace = {.name      = "nullspace",
                                  .summary   = "flip without what no node can see",
                                  .reference = "after Gritton and Berzins 2017",
                                  .filter    = Filter,
                                  .retains   = Retains,
                                  .unseen    = MpmTransferForgets};
