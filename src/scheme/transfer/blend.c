/*
   A blend of FLIP and PIC. The share of FLIP is ratio, the value of option blend_ratio:

     F = ratio + (1 - ratio) W P

   Source: Zhu and Bridson 2005; also Stomakhin et al. 2013, where 0.95 is used.
*/
#include <mpmstab/table.h>

static PetscErrorCode Filter(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt particle, PetscInt node)
{
  PetscFunctionBegin;
  PetscCall(MpmTableAppend(table, (MpmOp)SCALE(particle, numbers->ratio)));
  PetscCall(MpmTableAppend(table, (MpmOp)G2P_TIMES(particle, node, 1 - numbers->ratio, ONE)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal FilterSymbol(const MpmSchemeNumbers *numbers, PetscReal alpha)
{
  return numbers->ratio + (1 - numbers->ratio) * alpha;
}

static PetscReal NullFactor(const MpmSchemeNumbers *numbers)
{
  return numbers->ratio;
}

static PetscReal Number(const MpmSchemeNumbers *numbers)
{
  return numbers->ratio;
}

const MpmTransfer MpmBlend = {.name          = "blend",
                              .summary       = "blend_ratio of flip, the rest of pic",
                              .quiet         = PETSC_TRUE,
                              .reference     = "Zhu and Bridson 2005",
                              .option        = "blend_ratio",
                              .number        = Number,
                              .filter        = Filter,
                              .filter_symbol = FilterSymbol,
                              .leftmost      = PETSC_TRUE,
                              .step_bound    = PETSC_TRUE,
                              .null_factor   = NullFactor};
