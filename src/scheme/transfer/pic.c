/* PIC: particles take the grid's values, F = W P. Source: Harlow 1964. */
#include <mpmstab/table.h>

PetscErrorCode MpmTransferFromGrid(MpmTable *table, const MpmTransferNumbers *numbers, PetscInt particle, PetscInt node)
{
  PetscFunctionBegin;
  (void)numbers;
  PetscCall(MpmTableAppend(table, MPM_SCALE, particle, particle, 0));
  PetscCall(MpmTableAppend(table, MPM_G2P, particle, node, 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal MpmTransferForgets(const MpmTransferNumbers *numbers)
{
  (void)numbers;
  return 0;
}

static PetscReal Retains(const MpmTransferNumbers *numbers, PetscReal alpha)
{
  (void)numbers;
  return alpha;
}

const MpmTransfer MpmPic = {.name      = "pic",
                            .summary   = "particles take values from the grid",
                            .reference = "Harlow 1964",
                            .filter    = MpmTransferFromGrid,
                            .retains   = Retains,
                            .unseen    = MpmTransferForgets};
