/* Scheme and step: what is done to particles and nodes in one time step, and how far waves and particles go in it. */
#pragma once
#include <mpmstab/basis.h>
#include <mpmstab/fraction.h>
#include <mpmstab/table.h>

/*S
   MpmScheme - a formulation with its basis and its transfer.

   numbers are what the transfer was given. table is the formulation with transfer and boundary worked into it, and is
   what the interpreters read; whoever has called MpmTableCreate destroys it.
S*/
typedef struct {
  const MpmFormulation *formulation;
  const MpmBasis       *basis;
  const MpmTransfer    *transfer;
  MpmTransferNumbers    numbers;
  MpmTable             *table;
} MpmScheme;

/*S
   MpmStep - one time step in units of the grid: courant is k = c dt / h, how many cells a wave travels in it, and drift
   is delta = U0 dt / h, how many cells every particle moves.
S*/
typedef struct {
  PetscReal   courant;
  MpmFraction drift;
} MpmStep;

/* Not collective. Whether particles move against the grid. */
static inline PetscBool MpmStepDrifts(const MpmStep *step)
{
  return step->drift.value != 0 ? PETSC_TRUE : PETSC_FALSE;
}

#define MPM_LONGEST_PERIOD 10000 /* steps, each an operator to multiply with */

/*
   MpmStepPeriod - the number of steps after which particles are back in their places in cells: the denominator of the
   drift, and 1 at rest.

   Collective. Refuses a drift that is no fraction, and one whose period is longer than MPM_LONGEST_PERIOD.
*/
PetscErrorCode MpmStepPeriod(const MpmStep *step, PetscInt *period);
