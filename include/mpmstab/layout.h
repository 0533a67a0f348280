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
   its own cell id / ppc) and its place xi in [0,1) there.

   Not collective.
*/
void MpmLayoutPlace(const MpmScene *scene, PetscInt64 id, PetscInt *cell, PetscReal *xi);
