/* FLIP: particles gain the grid's increments. The filter is the identity. Source: Brackbill and Ruppel 1986. */
#include <mpmstab/transfer.h>

static PetscReal FilterSymbol(const MpmSchemeNumbers *numbers, PetscReal alpha)
{
  (void)numbers;
  (void)alpha;
  return 1;
}

static PetscReal NullFactor(const MpmSchemeNumbers *numbers)
{
  (void)numbers;
  return 1;
}

const MpmTransfer MpmFlip = {.name          = "flip",
                             .summary       = "particles gain increments from the grid",
                             .quiet         = PETSC_TRUE,
                             .reference     = "Brackbill and Ruppel 1986",
                             .filter_symbol = FilterSymbol,
                             .leftmost      = PETSC_TRUE,
                             .step_bound    = PETSC_TRUE,
                             .null_factor   = NullFactor};
