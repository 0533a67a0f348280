/* Modes: what eigenvectors look like on particles and grid. */
#pragma once
#include "linalg/eigen.h"
#include <mpmstab/operator.h>

/*S
   MpmModes - for each listed eigenvalue: beta, the phase per cell of the largest Fourier component of its nodal trace
   (P2G of its fields; NaN when the grid does not see it), and null_share, norm of the part of it that P2G sends to 0,
   relative. beta is on rank 0 only.
*/
typedef struct {
  PetscInt   n;
  PetscReal *beta, *null_share;
} MpmModes;

/* Collective. */
PetscErrorCode MpmModesCreate(const MpmOperator *op, const MpmEigen *eigen, MpmModes *modes);
PetscErrorCode MpmModesDestroy(MpmModes *modes);

/*
   MpmModesNullity - states that the grid does not see and no filter takes away, at the first step: for each field
   particles minus the rank of the map by which nodes see it (P2G, or DIV).

   Collective. By singular values; for orders that are solved whole.
*/
PetscErrorCode MpmModesNullity(const MpmOperator *op, PetscInt *nullity);
