/* The operation SOLVE on the grid of the march. */
#pragma once
#include "march/particles.h"
#include <petscksp.h>

/*S
   MpmNodalSolve - solves P W y = g with P = M^{-1} W^T m, the particles' masses m and the nodal masses M. These are the
   normal equations

     W^T m W y = M g

   It uses conjugate gradients, which options -nodal_* change. W^T m W may be singular: for one centred particle a cell
   its null space is the checkerboard. g = P q is in its range, and iterations from 0 stay there. The matrix is
   assembled anew when particles have moved since the last solve.
S*/
typedef struct {
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
} MpmNodalSolve;

/* Collective. layout, basis and grid must outlive the solve. */
PetscErrorCode MpmNodalSolveCreate(const MpmLayout *layout, const MpmBasis *basis, const MpmGrid *grid,
                                   MpmNodalSolve **solve);
PetscErrorCode MpmNodalSolveDestroy(MpmNodalSolve **solve);

/*
   MpmNodalSolveApply - solves with the particles at the places of a step, which follow from their resting places.

   Collective. Refuses when it does not converge.

   Input Parameters:
+  places        - the resting places of this rank's particles
.  parity        - that of y, by direction: y is 0 at the walls that impose it (MpmEndImposes)
.  inverse_mass  - a local array, 0 where there is no mass
-  g             - a local array

   Output Parameter: y - a local array; its ghosts are set too

   MpmNodalSolveTry does the same and leaves convergence to the caller: reason is above 0 when it converged.
*/
PetscErrorCode MpmNodalSolveApply(MpmNodalSolve *solve, const MpmParticles *particles, PetscInt64 step,
                                  const MpmPlaces *places, const MpmParity parity[], const PetscReal inverse_mass[],
                                  const PetscReal g[], PetscReal y[]);
PetscErrorCode MpmNodalSolveTry(MpmNodalSolve *solve, const MpmParticles *particles, PetscInt64 step,
                                const MpmPlaces *places, const MpmParity parity[], const PetscReal inverse_mass[],
                                const PetscReal g[], PetscReal y[], KSPConvergedReason *reason);
