/* The nodal solve of the operation SOLVE on the march's grid. */
#pragma once
#include "march/particles.h"
#include <petscksp.h>

/*S
   MpmNodalSolve - y with P W y = g, P = M^{-1} W^T: the normal equations W^T W y = M g by conjugate gradients
   (-nodal_* to change that).

   Where W^T W is singular (the checkerboard of one centred particle a cell) g = P q is in its range and iterations
   from 0 stay there. The matrix is put together when particles have moved since the last solve.
S*/
typedef struct {
  const MpmLayout *layout;
  const MpmBasis  *basis;
  const MpmGrid   *grid;
  Mat              matrix;
  Vec              right, solution;
  KSP              ksp;
  PetscInt64       step;
  PetscBool        antisymmetric;
} MpmNodalSolve;

/* Collective. */
PetscErrorCode MpmNodalSolveCreate(const MpmLayout *layout, const MpmBasis *basis, const MpmGrid *grid,
                                   MpmNodalSolve **solve);
PetscErrorCode MpmNodalSolveDestroy(MpmNodalSolve **solve);

/*
   MpmNodalSolveApply - solves with the particles at the places of a step, which follow from their resting places; refuses when it
   does not converge. Local arrays, ghosts included in y; inverse_mass is 0 where there is no mass. antisymmetric: y is 0 at the
   walls that impose it (fixed without reaction). MpmNodalSolveTry leaves it to the caller: reason is above 0 when it
   converged.

   Collective.
*/
PetscErrorCode MpmNodalSolveApply(MpmNodalSolve *solve, const MpmParticles *particles, PetscInt64 step,
                                  const MpmPlaces *places, PetscBool antisymmetric, const PetscReal inverse_mass[],
                                  const PetscReal g[], PetscReal y[]);
PetscErrorCode MpmNodalSolveTry(MpmNodalSolve *solve, const MpmParticles *particles, PetscInt64 step,
                                const MpmPlaces *places, PetscBool antisymmetric, const PetscReal inverse_mass[],
                                const PetscReal g[], PetscReal y[], KSPConvergedReason *reason);
