/* Layout: where particles start and what random numbers they get, from their global id alone. */
#pragma once
#include "base/hash.h"
#include <mpmstab/scene.h>

/*
   MpmLayoutSite - the cell of site g, which of the count particles there it is, and how many there are.

   Not collective. Sites are numbered cell by cell; particle id has site first + id.
*/
void MpmLayoutSite(const MpmScene *scene, PetscInt64 g, PetscInt *cell, PetscInt *j, PetscInt *count);

/* Not collective. The number of sites in the cells before one, and in it. */
PetscInt64 MpmLayoutSitesBefore(const MpmScene *scene, PetscInt cell);
PetscInt   MpmLayoutSitesIn(const MpmScene *scene, PetscInt cell);

/*
   MpmLayoutPlace - resting place of particle id: its cell (unwrapped: jitter may take it into a neighbour of
   its own cell) and its place xi in [0,1) there.

   Not collective.
*/
void MpmLayoutPlace(const MpmScene *scene, PetscInt64 id, PetscInt *cell, PetscReal *xi);

/*
   MpmLayoutPlaceAt - place of particle id after a number of steps, but for the whole cells of drift: they move all
   particles alike and leave the map from particles to particles as it is.

   Not collective.
*/
void MpmLayoutPlaceAt(const MpmScene *scene, PetscInt64 id, PetscInt64 step, PetscInt *cell, PetscReal *xi);

#define MPM_LONGEST_PERIOD 10000 /* steps, each an operator to multiply with */

/*
   MpmLayoutPeriod - steps after which the particles are where they were, but for whole cells: the denominator of the
   drift, 1 at rest.

   Collective. Refuses drifts that are no fraction, or one with a period too long to follow.
*/
PetscErrorCode MpmLayoutPeriod(const MpmScene *scene, PetscInt *period);

/* Not collective. Whether all cells are alike and there is no end, so that Fourier modes do not mix. */
static inline PetscBool MpmLayoutIsUniform(const MpmScene *scene)
{
  for (PetscInt property = 0; property < MPM_PROPERTIES; property++)
    if (scene->table->varies[property]) return PETSC_FALSE;
  return scene->jitter == 0 && MpmSceneIsPeriodic(scene) && MpmSceneIsFull(scene) ? PETSC_TRUE : PETSC_FALSE;
}
