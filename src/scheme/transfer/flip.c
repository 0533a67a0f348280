/* FLIP: particles gain the grid's increments. Source: Brackbill and Ruppel 1986. */
#include <mpmstab/transfer.h>

static PetscReal Retains(const MpmTransferNumbers *numbers, PetscReal alpha)
{
  (void)numbers;
  (void)alpha;
  return 1;
}

static PetscReal Unseen(const MpmTransferNumbers *numbers)
{
  (void)numbers;
  return 1;
}

const MpmTransfer MpmFlip = {.name      = "flip",
                             .summary   = "particles gain increments from the grid",
                             .reference = "Brackbill and Ruppel 1986",
                             .retains   = Retains,
                             .unseen    = Unseen};
