/* Material: the properties in which particles differ. A scene whose particles are all alike has none. */
#pragma once
#include <mpmstab/scene.h>

/* The names of the swarm fields that hold these properties. That of MPM_NO_PROPERTY is NULL. */
extern const char *const MpmPropertyNames[MPM_PROPERTIES];

/* The distributions that the option material names: uniform, two, graded. */
extern const char *const MpmMaterialNames[];

/*
   MpmMaterialProperty - returns mass, volume or stiffness of particle id, in units of a particle of the first material
   that fills 1 / ppc of a cell.

   Not collective. The volume of a particle is its cell's width over the number of particles in the cell. Density and
   stiffness depend on its resting place x in the domain. Material two has the second material inside the inclusion.
   Material graded multiplies those of the first material by ratio^s with

     s = x / L, in a periodic domain s = 1 - abs(2 x / L - 1)
*/
PetscReal MpmMaterialProperty(const MpmLayout *layout, MpmProperty property, PetscInt64 id);

/* Not collective. The density at place x in cells, relative to the first material's. */
PetscReal MpmMaterialDensity(const MpmLayout *layout, const PetscReal x[]);

/* Not collective. Finds bounds of the properties over a scene: the least mass, and the largest volume and stiffness. */
void MpmMaterialBounds(const MpmLayout *layout, PetscReal bound[MPM_PROPERTIES]);

/* Not collective. What property 1 is in a scene's units: a volume and a mass at rest, and Young's modulus. */
void MpmMaterialUnits(const MpmScene *scene, PetscReal unit[MPM_PROPERTIES]);

/*
   Not collective. The stiffness against a strain in one direction alone of a solid with Young's modulus 1 and Poisson's
   ratio nu; in one dimension it is a bar whose sides are free.
*/
PetscReal MpmMaterialStiffness(PetscInt dim, PetscReal nu);

/*
   MpmMaterialOne - the Kirchhoff stress tau of one particle with the deformation gradient F, and dtau, its differential
   along dF (NULL: without it), as MpmMaterialStress and MpmMaterialTangent have them.

   Not collective.
*/
void MpmMaterialOne(const MpmMaterialNumbers *material, PetscInt dim, const PetscReal F[], const PetscReal dF[],
                    PetscReal tau[], PetscReal dtau[]);
/*
   Not collective. A property of a particle as layout FILE has it, in these units: of MPM_LAMBDA it is Poisson's ratio.
*/
PetscReal MpmMaterialColumn(const MpmScene *scene, const PetscReal unit[], MpmProperty property, PetscInt64 id);
