/* Layout: where particles start and what random numbers they get. Both follow from their global id alone. */
#pragma once
#include "base/hash.h"
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>

/*
   MpmLayoutSite - finds the cell of site g, which of the particles there it is (j), and how many there are (count), in
   one dimension.

   Not collective. Sites are numbered cell by cell; particle id has site first + id.
*/
void MpmLayoutSite(const MpmLayout *layout, PetscInt64 g, PetscInt *cell, PetscInt *j, PetscInt *count);

/* Not collective. Return the number of sites in the cells before a cell, and in it, in one dimension. */
PetscInt64 MpmLayoutSitesBefore(const MpmLayout *layout, PetscInt cell);
PetscInt   MpmLayoutSitesIn(const MpmLayout *layout, PetscInt cell);

extern const char *const MpmShapeNames[]; /* of the option shape */

/* Not collective. The particle at a site of the box of sites that particles take, -1: none. */
PetscInt64 MpmLayoutIdAt(const MpmLayout *layout, PetscInt64 box);

/* Not collective. The site of particle id in each direction. */
void MpmLayoutSites(const MpmLayout *layout, PetscInt64 id, PetscInt64 site[]);

/*
   MpmLayoutPlace - finds the resting place of particle id in each direction: its cell and its place xi in [0, 1) there.

   Not collective. The cell is not wrapped into the domain; jitter may move a particle into a neighbour of its own cell.
*/
void MpmLayoutPlace(const MpmLayout *layout, PetscInt64 id, PetscInt cell[], PetscReal xi[]);

#define MPM_LAYOUT_RANDOM "random" /* the word of the option layout */

/*
   MpmGivenCreateRandom - gives a layout particles with random places. MpmGivenScatter - places as many as it has sites:
   particle id is at cells times hash(seed', id) along a direction, with the seed' of jitter (docs/theory.md, section
   1).

   Not collective.
*/
PetscErrorCode MpmGivenCreateRandom(MpmLayout *layout);
PetscErrorCode MpmGivenScatter(MpmLayout *layout);

/* Not collective. The seed of jitter and random places in a direction, and of voids, for which axis is MPM_MAX_DIM. */
PetscInt64 MpmLayoutSeed(const MpmLayout *layout, PetscInt axis);

/* The columns of a file of particles after those of their places. */
enum { MPM_GIVEN_VOLUME = MPM_MAX_DIM, MPM_GIVEN_MASS, MPM_GIVEN_YOUNG, MPM_GIVEN_POISSON, MPM_GIVEN_FIXED };

/*
   MpmGivenRead - reads the particles of a CSV or HDF5 file with columns x, y, z in dim dimensions. Places are in the
                  scene's unit.

   Collective. Refuses a file that is none, in a message that begins with where it is named; others: what else is
   allowed there.
*/
PetscErrorCode MpmGivenRead(const char where[], const char others[], const char path[], PetscInt dim, MpmGiven **given);

/*
   MpmDistanceRead - reads the signed distance of a body in dim dimensions. unit: the length of a cell.
                     MpmDistanceDestroy - frees it.

   Collective. Refuses a file that is none, as MpmGivenRead does.
*/
PetscErrorCode MpmDistanceRead(const char where[], const char path[], PetscInt dim, PetscReal unit,
                               MpmDistance **distance);
PetscErrorCode MpmDistanceDestroy(MpmDistance **distance);

/*
   MpmGivenPlace - MpmLayoutPlace for the particles of a file. MpmGivenText - what of them is the file's, and what is
                   not.
   MpmGivenDestroy - frees them.

   Not collective.
*/
void           MpmGivenPlace(const MpmLayout *layout, PetscInt64 id, PetscInt cell[], PetscReal xi[]);
void           MpmGivenText(const MpmGiven *given, size_t room, char text[]);
PetscErrorCode MpmGivenDestroy(MpmGiven **given);

/*
   MpmLayoutIsVoid - whether the site of particle id is a void, where a share of all sites are voids.

   Not collective. Site number g is a void where hash(seed', g) < share, with the hash of base/hash.h and a seed' that
   is itself hashed from the layout's seed (docs/theory.md, section 1).
*/
PetscBool MpmLayoutIsVoid(const MpmLayout *layout, PetscInt64 id, PetscReal share);

/* Not collective. The resting place of particle id in each direction, in cells from the left end of the domain. */
void MpmLayoutRest(const MpmLayout *layout, PetscInt64 id, PetscReal x[]);

/*
   MpmLayoutPlaceAt - finds the place of particle id after a number of steps with a drift, in each direction. It leaves
   out the whole cells of drift: they move all particles alike and do not change the map from particles to particles.

   Not collective.
*/
void MpmLayoutPlaceAt(const MpmLayout *layout, const MpmFraction drift[], PetscInt64 id, PetscInt64 step,
                      PetscInt cell[], PetscReal xi[]);

/* Not collective. The options that say how large a layout is, as text: 'cells 8,4 with ppc 2,2'. */
#define MPM_SIZE_TEXT 128
void MpmLayoutSizeText(const MpmLayout *layout, size_t room, char text[]);

/* Collective. Refuses work on a layout that needs more memory than there is; see MpmMemoryCheck. */
PetscErrorCode MpmLayoutCheckMemory(MPI_Comm comm, const MpmLayout *layout, PetscReal bytes, const char what[]);

/*
   Not collective. The number of cells that a rank of size ranks gets, and the first of them, as DMDA distributes them.
   The first cells % size ranks get one more than the others.
*/
static inline PetscInt MpmGridCount(PetscInt cells, PetscMPIInt size, PetscMPIInt rank)
{
  return cells / size + (cells % size > rank ? 1 : 0);
}
static inline PetscInt MpmGridFirst(PetscInt cells, PetscMPIInt size, PetscMPIInt rank)
{
  return cells / size * rank + PetscMin(rank, cells % size);
}
