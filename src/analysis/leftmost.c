/* Which cases grow by real eigenvalues below -1 alone. */
#include "analysis/leftmost.h"
#include "scene/layout.h"

PetscBool MpmLeftmostDecides(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step)
{
  const MpmSpace *space = &scheme->space;

  if (!scheme->formulation->leftmost || !scheme->transfer->leftmost) return PETSC_FALSE;
  if (MpmSpaceIsPrestressed(space) || space->displaced || space->finite) return PETSC_FALSE;
  if (MpmStepDrifts(step) || (!MpmLayoutIsFull(layout) && layout->jitter == 0)) return PETSC_FALSE;
  for (PetscInt a = 0; a < layout->dim; a++)
    for (int end = 0; end < 2; end++)
      if (layout->grid[a].ends[end] == MPM_FIXED_REACTION) return PETSC_FALSE;
  return PETSC_TRUE;
}
