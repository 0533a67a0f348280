/* PIC: particles take the grid's values. The filter is F = W P. Source: Harlow 1964. */
#include <mpmstab/table.h>

PetscErrorCode MpmTransferFromGrid(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt particle, PetscInt node)
{
  PetscFunctionBegin;
  (void)numbers;
  PetscCall(MpmTableAppend(table, (MpmOp)SCALE(particle, 0)));
  PetscCall(MpmTableAppend(table, (MpmOp)G2P(particle, node, ONE)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal MpmTransferForgets(const MpmSchemeNumbers *numbers)
{
  (void)numbers;
  return 0;
}

PetscReal MpmTransferFromGridSymbol(const MpmSchemeNumbers *numbers, PetscReal alpha)
{
  (void)numbers;
  return alpha;
}

const MpmTransfer MpmPic = {.name          = "pic",
                            .summary       = "particles take values from the grid",
                            .quiet         = PETSC_TRUE,
                            .reference     = "Harlow 1964",
                            .filter        = MpmTransferFromGrid,
                            .filter_symbol = MpmTransferFromGridSymbol,
                            .leftmost      = PETSC_TRUE,
                            .step_bound    = PETSC_TRUE,
                            .null_factor   = MpmTransferForgets};
