/* Layout: where particles start and what random numbers they get, from their global id alone. */
#pragma once
#include "base/hash.h"
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>

/*
   MpmLayoutSite - the cell of site g, which of the count particles there it is, and how many there are.

   Not collective. Sites are numbered cell by cell; particle id has site first + id.
*/
void MpmLayoutSite(const MpmLayout *layout, PetscInt64 g, PetscInt *cell, PetscInt *j, PetscInt *count);

/* Not collective. The number of sites in the cells before one, and in it. */
PetscInt64 MpmLayoutSitesBefore(const MpmLayout *layout, PetscInt cell);
PetscInt   MpmLayoutSitesIn(const MpmLayout *layout, PetscInt cell);

/*
   MpmLayoutPlace - resting place of particle id: its cell (unwrapped: jitter may take it into a neighbour of
   its own cell) and its place xi in [0,1) there.

   Not collective.
*/
void MpmLayoutPlace(const MpmLayout *layout, PetscInt64 id, PetscInt *cell, PetscReal *xi);

/*
   MpmLayoutPlaceAt - place of particle id after a number of steps with a drift, but for the whole cells of drift: they
   move all particles alike and leave the map from particles to particles as it is.

   Not collective.
*/
void MpmLayoutPlaceAt(const MpmLayout *layout, const MpmFraction *drift, PetscInt64 id, PetscInt64 step, PetscInt *cell,
                      PetscReal *xi);

/* Collective. Refuses work on a layout that needs more memory than there is; see MpmMemoryCheck. */
PetscErrorCode MpmLayoutCheckMemory(MPI_Comm comm, const MpmLayout *layout, PetscReal bytes, const char what[]);
