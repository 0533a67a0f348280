/* Diagnostics: sums that a run must conserve, and its errors relative to the exact solution. Norms: mpmstab/march.h. */
#pragma once
#include "march/march_private.h"

#define MPM_MASS_ROUNDING 1e-10 /* of the nodes' mass, relative */

/*S
   MpmConserved - sums over the grid and over all particles.

   particles    - the number of particles
   mass         - the sum of the nodal masses, in particles of the first material
   momentum     - the sum of m v over the particles, for each component of the field that the formulation conserves,
                  in units of 2^exponent; 0 for components that a wall stops
   size         - the sum of m abs(v) over these components and of that of the affine part, in units of 2^exponent
   has_momentum - scheme and ends conserve a component of the momentum
S*/
typedef struct {
  PetscInt64 particles;
  PetscReal  mass, momentum[MPM_MAX_DIM], size;
  PetscInt   exponent;
  PetscBool  has_momentum;
} MpmConserved;

/* Collective. The sums at the march's step. */
PetscErrorCode MpmConservedSum(const MpmMarch *march, MpmConserved *sums);

/*
   MpmConservedCheck - compares the sums at the march's step with those at an earlier step.

   Collective. A change of particles or mass is an error of the program. Momentum may be lost at nodes without mass.

   Output Parameter: changes - the change of mass relative to mass, and the largest of those of the momentum's
   components relative to size; NaN where there is none to conserve
*/
PetscErrorCode MpmConservedCheck(const MpmMarch *march, const MpmConserved *before, PetscReal changes[2]);

/* Errors of one field over the particles, weighted by volume, relative to the exact amplitude. */
typedef struct {
  PetscReal l1, l2, linf;
} MpmError;

/*
   MpmDiagnosticsErrors - the errors of the fields of MpmSceneErrorFields at the march's step. At finite strain
   particles have equal weights.

   Collective. The scene must have an exact solution (MpmSceneHasExact). Errors that are out of the range of doubles are
   infinite.
*/
PetscErrorCode MpmDiagnosticsErrors(const MpmMarch *march, MpmError error[]);
