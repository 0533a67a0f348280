/* Whole matrices on every rank, for LAPACK. */
#pragma once
#include <mpmstab/compat.h>
#include <petscmat.h>

/* Collective. A parallel matrix by columns on every rank; room for rows x columns numbers. */
PetscErrorCode MpmDenseCopy(Mat matrix, PetscReal values[]);

/* Collective. The largest abs of all eigenvalues (LAPACK, without vectors); infinite when the matrix is not finite. */
PetscErrorCode MpmDenseRadius(Mat matrix, PetscReal *radius);
