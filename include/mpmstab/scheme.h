/*
   Scheme: the operations on particles and nodes in one time step. Step: how far waves and particles go in one time
   step.
*/
#pragma once
#include <mpmstab/basis.h>
#include <mpmstab/fraction.h>
#include <mpmstab/table.h>

/*S
   MpmScheme - a formulation with its basis and its transfer.

   formulation, basis, transfer - the three, by themselves
   numbers - the numbers that formulation and transfer are given
   space   - the dimension, the gradient, the material and the ends
   table   - made of these by MpmTableCreate; the march, the operator and the symbol interpret it. The caller of
             MpmTableCreate destroys it.
S*/
typedef struct {
  const MpmFormulation *formulation;
  const MpmBasis       *basis;
  const MpmTransfer    *transfer;
  MpmSchemeNumbers      numbers;
  MpmSpace              space;
  MpmTable             *table;
} MpmScheme;

/*S
   MpmStep - one time step in units of the grid.

   courant - the Courant number k = c dt / h: the number of cells that a wave travels in a step
   drift   - the drift delta = U0 dt / h: the number of cells that every particle moves in a step, in each direction;
             0 in directions that a scene does not have
S*/
typedef struct {
  PetscReal   courant;
  MpmFraction drift[MPM_MAX_DIM];
} MpmStep;

/*
   Not collective. The number of terms of a scheme's energy. About a prestressed state of a solid, in more dimensions,
   there is none: the energy of a rotation in it is not in the stress that particles have.
*/
static inline PetscInt MpmSchemeEnergyTerms(const MpmScheme *scheme)
{
  const MpmSpace *space = &scheme->space;

  return space->dim > 1 && MpmSpaceIsPrestressed(space) && !MpmSpaceIsFluid(space) ? 0 : scheme->formulation->nenergy;
}

/* Not collective. Whether particles move relative to the grid. */
static inline PetscBool MpmStepDrifts(const MpmStep *step)
{
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++)
    if (step->drift[a].value != 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

#define MPM_LONGEST_PERIOD 10000 /* in steps; each has a matrix to multiply with */

/*
   MpmStepPeriod - the number of steps after which all particles have the same places in cells again. It is the
   least common multiple of the drift's denominators, and 1 at rest.

   Collective.

   Errors: refuses (PETSC_ERR_USER_INPUT) a drift that is not a fraction, and one whose period is longer than
   MPM_LONGEST_PERIOD.
*/
PetscErrorCode MpmStepPeriod(const MpmStep *step, PetscInt *period);

/*
   MpmSchemeCombines - whether a formulation goes with a transfer, of those that differ: what has the same linear
   operations as another transfer is left out.

   Not collective.
*/
static inline PetscBool MpmSchemeCombines(const MpmFormulation *formulation, const MpmTransfer *transfer)
{
  return !transfer->same_as && (!transfer->affine || formulation->affine != MPM_NONE) ? PETSC_TRUE : PETSC_FALSE;
}
