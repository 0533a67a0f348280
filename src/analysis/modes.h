/* Modes: where eigenvectors live, on particles and on the grid. */
#pragma once
#include "linalg/eigen.h"
#include <mpmstab/operator.h>

/*S
   MpmModes - where each of the first n listed eigenvectors lives.

   beta: the phase per cell of the largest Fourier component of the mode's nodal trace, which is P2G of its fields: dim
   numbers a mode, the first up to pi and the others below 2 pi. They are NaN when the trace is 0 to rounding, and on
   rank 0 only. p_share: of that component of the velocity (u of a gas), the part of the square that is along beta: 1 for
   a P wave, 0 for an S wave. It is on rank 0 only, and NaN in one dimension, between ends, and where there is no vector.
   null_share: norm of the part of the mode that P2G sends to 0, relative to that of the mode.
S*/
typedef struct {
  PetscInt   n, dim;
  PetscReal *beta, *p_share, *null_share;
} MpmModes;

/* Collective. MpmModesCreate examines all listed eigenvectors, MpmModesCreateLeading the first count of them. */
PetscErrorCode MpmModesCreate(const MpmOperator *op, const MpmEigen *eigen, MpmModes *modes);
PetscErrorCode MpmModesCreateLeading(const MpmOperator *op, const MpmEigen *eigen, PetscInt count, MpmModes *modes);
PetscErrorCode MpmModesDestroy(MpmModes *modes);

/*
   Collective. The velocities of the particles in the real part of the first listed eigenvector, on all ranks: for each
   direction a number for each id. fastest: the id of the largest velocity, which is 1, the least of several; MPM_NONE:
   the state has no vector.
*/
PetscErrorCode MpmModesVelocities(const MpmOperator *op, const MpmEigen *eigen, PetscReal v[], PetscInt64 *fastest);

/*
   MpmModesNullity - counts the states that no node feels and no filter removes, at the first step. For each field it is
   the number of particles minus the rank of the map by which nodes feel the field (P2G or DIV).

   Collective. Computed by singular values, for orders that are solved whole.
*/
PetscErrorCode MpmModesNullity(const MpmOperator *op, PetscInt *nullity);

/* Not collective. The first register of the first vector, or MPM_NONE. */
PetscInt MpmModesVectorOf(const MpmScheme *scheme);
