/* The registers of a Bloch mode and the operations on them, one by one: for the files that make matrices of them. */
#pragma once
#include "symbol/bloch.h"

/* The numbers of a row with so many columns, which is filled up with zeros to a multiple of the lanes. */
static inline PetscInt MpmBlochFullWidth(PetscInt columns)
{
  return (columns + MPM_BLOCH_LANES - 1) / MPM_BLOCH_LANES * MPM_BLOCH_LANES;
}

/* The rows of a register of particles. */
static inline PetscReal *MpmBlochRows(const MpmBloch *b, PetscInt field)
{
  return b->particle + field * b->ppc * 2 * b->width;
}

/* The row of a register of nodes. */
static inline PetscReal *MpmBlochRow(const MpmBloch *b, PetscInt field)
{
  return b->nodes + field * 2 * b->width;
}

/*
   MpmBlochBegin - makes ready for the first steps of a period, of so many columns for each of n Courant numbers. All
   particle registers are 0. Lanes without a Courant number have the last one's.

   MpmBlochSetStep - sets what the maps of a step are, and the nodal mass.

   MpmBlochApply - applies operation o of the table in that step.

   MpmBlochNote - adds to the rows of what nodes give in a step, 2 x width numbers each, what operation o is the first to
   read. MpmBlochApply comes after it.

   MpmBlochTieAlong - as MpmBlochTie, of the directions for which along is true

   MpmBlochPhaseBeyond - the phase factor of what goes from particle j to the one whose place it has taken, for the cells in
   between.

   Not collective.
*/
PetscErrorCode MpmBlochBegin(MpmBloch *b, PetscInt n, const PetscReal courant[], const PetscReal beta[], PetscInt steps,
                             PetscInt columns);
void           MpmBlochSetStep(MpmBloch *b, PetscInt step);
void           MpmBlochApply(MpmBloch *b, PetscInt o, const PetscReal beta[]);
void           MpmBlochNote(const MpmBloch *b, const MpmTaken *taken, PetscInt o, PetscReal numbers[]);
double complex MpmBlochTieAlong(const MpmBloch *b, MpmOpKind kind, PetscInt axis, PetscInt j, const PetscBool along[]);
double complex MpmBlochPhaseBeyond(const MpmBloch *b, const PetscReal beta[], PetscInt j);
