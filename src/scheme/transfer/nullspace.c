/*
   nullspace: the filter F = W (P W)^{-1} P takes the null space of P2G out, which is particle data that no node feels.

   It is the projection with all nodes and particles of the grid at once. Gritton and Berzins filter cell by cell: they
   take from the particles of each cell the part that the cell's own nodes do not feel.

   Source: after Gritton and Berzins 2017.
*/
#include <mpmstab/table.h>

static PetscErrorCode Filter(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt particle, PetscInt node)
{
  PetscInt solution;

  PetscFunctionBegin;
  PetscCall(MpmTableNode(table, node, &solution));
  PetscCall(MpmTableAppend(table, (MpmOp)SOLVE(solution, node)));
  PetscCall(MpmTransferFromGrid(table, numbers, particle, solution));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal FilterSymbol(const MpmSchemeNumbers *numbers, PetscReal alpha)
{
  (void)numbers;
  return alpha > 0 ? 1 : 0;
}

const MpmTransfer MpmNullspace = {
    .name          = "nullspace",
    .summary       = "flip without the null space of P2G (data that no node feels), of the whole grid at once",
    .reference     = "after Gritton and Berzins 2017",
    .filter        = Filter,
    .filter_symbol = FilterSymbol,
    .null_factor   = MpmTransferForgets};
