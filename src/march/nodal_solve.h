/* The operation SOLVE on the grid of the march. */
#pragma once
#include "march/march_private.h"
#include <petscksp.h>

/*S
   MpmNodalSolve - solves P W y = g with P = M^{-1} W^T m, the particles' masses m and the nodal masses M. These are the
   normal equations

     W^T m W y = M g

   It uses conjugate gradients, which options -nodal_* change. W^T m W may be singular: for one centred particle a cell
   its null space is the checkerboard. g = P q is in its range, and iterations from 0 stay there. The matrix is
   assembled anew when particles have moved since the last solve.
S*/
struct MpmNodalSolve_ {
  const MpmLayout *layout;
  const MpmBasis  *basis;
  const MpmGrid   *grid;
  Mat              matrix;
  Vec              right, solution;
  KSP              ksp;
  PetscInt64       step;
  MpmParity        parity[MPM_MAX_DIM];
  PetscInt         seen, *node; /* the nodes of a particle, their number, and room for its part of the matrix */
  PetscReal       *weight, *square;
};

/* Collective. march must outlive the solve, and have its grid. */
PetscErrorCode MpmNodalSolveCreate(const MpmMarch *march, MpmNodalSolve **solve);
PetscErrorCode MpmNodalSolveDestroy(MpmNodalSolve **solve);

/*
   MpmNodalSolveApply - solves with the particles at the places of a step, that of the arrays or the next one.

   Collective. reason: NULL, or why it ended, above 0 when it converged.

   Input Parameters:
+  arrays - of the march, with its nodal masses
.  parity - that of y, by direction: y is 0 at the walls that impose it (MpmEndImposes)
-  g      - a local array

   Output Parameter: y - a local array; its ghosts are set too

   Errors: where reason is NULL, refuses (PETSC_ERR_USER_INPUT) a system that does not converge.
*/
PetscErrorCode MpmNodalSolveApply(MpmNodalSolve *solve, const MpmMarchArrays *arrays, PetscInt64 step,
                                  const MpmParity parity[], const PetscReal g[], PetscReal y[],
                                  KSPConvergedReason *reason);
