/* The largest singular value of a matrix that has products and transposed products. */
#pragma once
#include <mpmstab/compat.h>
#include <petscmat.h>

/*
   MpmSingularLargest - finds the largest singular value by SLEPc's thick-restart Lanczos bidiagonalization (Hernandez,
   Roman and Tomas 2008).

   Collective on PETSC_COMM_WORLD. start: a vector with components in every direction. basis: the most vectors of the
   Krylov space, which is begun again when it is full. tolerance: of the relative residual; the error is about its square
   over the gap. sigma: NaN when the solver does not converge.
*/
PetscErrorCode MpmSingularLargest(Mat matrix, Vec start, PetscInt basis, PetscReal tolerance, PetscReal *sigma);

/* Collective. Refuses options -svd_* that SLEPc refuses, before the work. */
PetscErrorCode MpmSingularTryOptions(void);

/* Collective. Fills a start vector with components in every direction, the same on any number of ranks. */
PetscErrorCode MpmSingularStart(PetscInt64 seed, Vec start);
