/* Which cases grow by real eigenvalues below -1 alone. */
#include "analysis/leftmost.h"
#include "scene/layout.h"

/* Whether a particle of a file is exactly on a node, where hats have a slope at a node that they give no mass. */
static PetscBool IsOnNode(const MpmLayout *layout)
{
  PetscInt  cell[MPM_MAX_DIM];
  PetscReal xi[MPM_MAX_DIM];

  for (PetscInt64 id = 0; layout->given && id < layout->particles; id++) {
    MpmLayoutPlace(layout, id, cell, xi);
    for (PetscInt a = 0; a < layout->dim; a++)
      if (xi[a] == 0) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Whether the particles are those of the proofs: at rest, with DIV the adjoint of GRAD. */
static PetscBool Holds(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step)
{
  const MpmSpace *space = &scheme->space;

  if (MpmSpaceIsPrestressed(space) || space->displaced || space->finite || MpmSpaceIsDamped(space)) return PETSC_FALSE;
  if (layout->colliders || MpmStepDrifts(step) || (!MpmLayoutIsFull(layout) && !MpmLayoutIsScattered(layout)))
    return PETSC_FALSE;
  if (scheme->basis->hat && IsOnNode(layout)) return PETSC_FALSE;
  for (PetscInt a = 0; a < layout->dim; a++)
    for (int end = 0; end < 2; end++)
      if (layout->grid[a].ends[end] == MPM_FIXED_REACTION) return PETSC_FALSE;
  return PETSC_TRUE;
}

PetscBool MpmLeftmostDecides(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step)
{
  return scheme->formulation->leftmost && scheme->transfer->leftmost && Holds(layout, scheme, step) ? PETSC_TRUE
                                                                                                    : PETSC_FALSE;
}

/* implicit has a bound without a limit, and solves on the grid */
PetscBool MpmGrowthStays(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step)
{
  const MpmFormulation *f = scheme->formulation;

  if (MpmLeftmostDecides(layout, scheme, step)) return PETSC_TRUE;
  return f->step_bound && !f->leftmost && !scheme->transfer->filter &&
                 f->step_bound(&scheme->numbers, scheme->transfer) > 0 && !MpmTableSolves(scheme->table) &&
                 Holds(layout, scheme, step)
             ? PETSC_TRUE
             : PETSC_FALSE;
}
