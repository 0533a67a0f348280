/* Material: in what particles differ. A scene whose particles are all alike has none of it. */
#pragma once
#include <mpmstab/layout.h>

/* The swarm fields that hold the properties that vary; the first, MPM_NO_PROPERTY's, is no name. */
extern const char *const MpmPropertyNames[MPM_PROPERTIES];

/* The distributions of option material: uniform, two, graded. */
extern const char *const MpmMaterialNames[];

/*
   MpmMaterialProperty - mass, volume or stiffness of particle id, in units of a particle of the first material that
   fills 1 / ppc of a cell.

   Not collective. A particle has its cell's width over its cell's number of particles, and the material of its resting
   place x in the domain: with material two the second one's inside the inclusion, graded the first one's times ratio^s, s = x / L, in
   a periodic domain 1 - abs(2 x / L - 1).
*/
PetscReal MpmMaterialProperty(const MpmLayout *layout, MpmProperty property, PetscInt64 id);

/* Not collective. Bounds of the properties over a scene: the least mass, and the largest volume and stiffness. */
void MpmMaterialBounds(const MpmLayout *layout, PetscReal bound[MPM_PROPERTIES]);
