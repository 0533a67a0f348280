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
   numbers - the numbers that the transfer is given
   table   - made of formulation, transfer and boundary by MpmTableCreate; the march, the operator and the symbol
             interpret it. The caller of MpmTableCreate destroys it.
S*/
typedef struct {
  const MpmFormulation *formulation;
  const MpmBasis       *basis;
  const MpmTransfer    *transfer;
  MpmTransferNumbers    numbers;
  MpmTable             *table;
} MpmScheme;

/*S
   MpmStep - one time step in units of the grid.

   courant - the Courant number k = c dt / h: the number of cells that a wave travels in a step
   drift   - the drift delta = U0 dt / h: the number of cells that every particle moves in a step
S*/
typedef struct {
  PetscReal   courant;
  MpmFraction drift;
} MpmStep;

/* Not collective. Whether particles move relative to the grid. */
static inline PetscBool MpmStepDrifts(const MpmStep *step)
{
  return step->drift.value != 0 ? PETSC_TRUE : PETSC_FALSE;
}

#define MPM_LONGEST_PERIOD 10000 /* in steps; each has a matrix to multiply with */

/*
   MpmStepPeriod - the number of steps after which all particles have the same places in cells again. It is the
   denominator of the drift, and 1 at rest.

   Collective.

   Errors: refuses (PETSC_ERR_USER_INPUT) a drift that is not a fraction, and one whose period is longer than
   MPM_LONGEST_PERIOD.
*/
PetscErrorCode MpmStepPeriod(const MpmStep *step, PetscInt *period);
