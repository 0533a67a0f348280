/* Band LU: LU factors of a matrix whose nonzeros are near its diagonal, or near that of a ring, for PETSc's PCLU. */
#pragma once
#include <mpmstab/compat.h>
#include <petscmat.h>

#define MPM_SOLVER_BAND "band" /* a MatSolverType for MATSEQAIJ and MATMPIAIJ */

/*
   MpmBandLURegister - makes the solver type known to PETSc, for use as -st_pc_factor_mat_solver_type band.

   Not collective. Calling it again does nothing.
*/
PetscErrorCode MpmBandLURegister(void);

/*
   MpmBandLUBytes - counts the bytes that the factors would take on the first rank, which factors and solves alone.

   Collective.
*/
PetscErrorCode MpmBandLUBytes(Mat matrix, PetscReal *bytes);

/* Not collective. Returns the place of i in the folded order 0, n-1, 1, n-2, ... of a ring. */
static inline PetscInt MpmFoldedPlace(PetscInt n, PetscInt i)
{
  return i < (n + 1) / 2 ? 2 * i : 2 * (n - 1 - i) + 1;
}
