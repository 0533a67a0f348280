/*
   nullspace: the filter F = W (P W)^{-1} P takes the null space of P2G out, which is particle data that no node feels.

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

static PetscReal FilterSymbol(const MpmTransferNumbers *numbers, PetscReal alpha)
{
  (void)numbers;
  return alpha > 0 ? 1 : 0;
}

const MpmTransfer MpmNullspace = {.name      = "nullspace",
                                  .summary   = "flip without the null space of P2G: particle data that no node feels",
                                  .reference = "after Gritton and Berzins 2017",
                                  .filter    = Filter,
                                  .filter_symbol = FilterSymbol,
                                  .null_factor   = MpmTransferForgets};
