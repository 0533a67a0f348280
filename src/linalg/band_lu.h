/* LU factors of a matrix whose nonzeros are near its diagonal, or near a ring: for PETSc's PCLU. */
#pragma once
#include <mpmstab/compat.h>
#include <petscmat.h>

#define MPM_SOLVER_BAND "band" /* a MatSolverType, for MATSEQAIJ and MATMPIAIJ */

/*
   MpmBandLURegister - makes the type known to PETSc: -st_pc_factor_mat_solver_type band.

   Not collective. Calling it again does nothing.
*/
PetscErrorCode MpmBandLURegister(void);

/*
   MpmBandLUBytes - what the factors would take, on the first rank: it factors and solves alone.

   Collective.
*/
PetscErrorCode MpmBandLUBytes(Mat matrix, PetscReal *bytes);
