/* The state of a march at finite deformation: where it starts from, and its norms. */
#pragma once
#include "march/march_private.h"

/*
   MpmFiniteFill - sets the particles to the scene's initial data: the uniform stretch, the drift as a velocity, and the
   velocity of a mode. noise: random numbers in [-noise, noise), hashed from seed and id, are added to x / h, v / c, to F
   relative to F0, and to an affine part.

   Collective. Errors: refuses (PETSC_ERR_USER_INPUT) a noise that moves a particle by a cell or more, or out of the domain.
*/
PetscErrorCode MpmFiniteFill(MpmMarch *march, PetscReal noise);

/*
   MpmFiniteEnergy - the energy of all particles, kinetic and stored, with that of an affine part: sum m D |C|^2 / 2.

   Collective. psi: room for a number of each particle of this rank. energy: in units of that of a particle, rho0 c^2.
*/
PetscErrorCode MpmFiniteEnergy(const MpmMarch *march, PetscReal psi[], PetscReal *energy);

/*
   MpmFiniteNorms - norms of the state.

   Collective. state is the root of the mean square, over particles, of what is left of x / h, v / c and F / F0 when the
   uniform motion that the scene starts from is taken out, and then the mean of x and v. grid is that of the nodal
   velocity and its increment, without the mean. energy is kinetic energy, strain energy and that in the gravity, over
   the density at rest.
*/
PetscErrorCode MpmFiniteNorms(const MpmMarch *march, MpmNorms *norms);
