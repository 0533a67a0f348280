/* Layout: where particles start and what random numbers they get, from their global id alone. */
#pragma once
#include <mpmstab/scene.h>

/*
   MpmHash - the random number in [0,1) of a particle: splitmix64 of seed and global id.

   Not collective. The same on any number of ranks. Source: Steele, Lea and Flood 2014, as fixed in theory
   section 1.
*/
PetscReal MpmHash(PetscInt64 seed, PetscInt64 id);

/*
   MpmLayoutPlace - resting place of particle id: its cell (unwrapped: jitter may take it into a neighbour of
   its own cell (first + id) / ppc) and its place xi in [0,1) there.

   Not collective.
*/
void MpmLayoutPlace(const MpmScene *scene, PetscInt64 id, PetscInt *cell, PetscReal *xi);

/*
   MpmLayoutPlaceAt - place of particle id after a number of steps, but for the whole cells of drift: they move all
   particles alike and leave the map from particles to particles as it is.

   Not collective.
*/
void MpmLayoutPlaceAt(const MpmScene *scene, PetscInt64 id, PetscInt64 step, PetscInt *cell, PetscReal *xi);

/*
   MpmLayoutPeriod - steps after which the particles are where they were, but for whole cells: the denominator of the
   drift, 1 at rest.

   Collective. Refuses drifts that are no fraction, or one with a period too long to follow.
*/
PetscErrorCode MpmLayoutPeriod(const MpmScene *scene, PetscInt *period);

/* Not collective. Whether all cells are alike and there is no end, so that Fourier modes do not mix. */
static inline PetscBool MpmLayoutIsUniform(const MpmScene *scene)
{
  return scene->jitter == 0 && MpmSceneIsPeriodic(scene) && MpmSceneIsFull(scene) ? PETSC_TRUE : PETSC_FALSE;
}
