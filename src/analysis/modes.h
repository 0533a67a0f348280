/* Modes: where eigenvectors live, on particles and on the grid. */
#pragma once
#include "linalg/eigen.h"
#include <mpmstab/operator.h>

/*S
   MpmModes - two numbers for each listed eigenvalue.

   beta: the phase per cell of the largest Fourier component of the mode's nodal trace, which is P2G of its fields. It
   is NaN when the trace is 0 to rounding, and it is on rank 0 only. null_share: norm of the part that P2G sends to 0,
   relative to that of the mode.
S*/
typedef struct {
  PetscInt   n;
  PetscReal *beta, *null_share;
} MpmModes;

/* Collective. Computes them for all listed eigenvalues. */
PetscErrorCode MpmModesCreate(const MpmOperator *op, const MpmEigen *eigen, MpmModes *modes);
PetscErrorCode MpmModesDestroy(MpmModes *modes);

/*
   MpmModesNullity - counts the states that no node feels and no filter removes, at the first step. For each field it is
   the number of particles minus the rank of the map by which nodes feel the field (P2G or DIV).

   Collective. Computed by singular values, for orders that are solved whole.
*/
PetscErrorCode MpmModesNullity(const MpmOperator *op, PetscInt *nullity);
