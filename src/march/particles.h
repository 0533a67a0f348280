/* Particles: their fields in a DMSwarm, their places, and the ranks that own them. */
#pragma once
#include "march/grid.h"
#include "scene/layout.h"
#include "scene/material.h"
#include <mpmstab/scene.h>
#include <petscdmswarm.h>

/*S
   MpmParticles - the particles of this rank, in the order of their places.

   At step n a particle of drift delta is at cell + xi + n delta, in each direction. The swarm keeps (cell, xi) of its
   resting place, in fields of their own for each direction. cell is a local index of the grid. Migration adds the whole
   cells of drift to it that rebased counts. The rest of n delta is the same for all particles and is formed exactly. So
   nothing accumulates, and moving writes nothing to memory. The global id is DMSwarm's own field pid.

   At finite deformation particles move each by itself (own). (cell, xi) is where they are, and ADVANCE writes it. They
   are in the order of their cells, x fastest, when they have been sorted, and in any order after that.

   Else, in one dimension particles are in the order of their places. In more, those of a row of cells along x come
   after one another, row by row. Within it they are in lines: the particles of a line had equal indices of their sites
   in the other directions. Within a line they are in the order of their places.
S*/
typedef struct {
  DM               swarm;
  const MpmLayout *layout;
  const MpmTable  *table;
  MpmFraction      drift[MPM_MAX_DIM];
  PetscInt         count;                /* number of particles on this rank */
  PetscInt64       total;                /* number of particles on all ranks */
  PetscInt64       step;                 /* time step of the places */
  PetscInt64       rebased[MPM_MAX_DIM]; /* whole cells of drift that are in the cell fields */
  PetscBool        parallel, own;
} MpmParticles;

/* The names of the fields with the resting places, by direction. */
extern const char *const MpmFieldCell[], *const MpmFieldXi[];

/*
   MpmParticlesCreate - places a layout's particles, with the properties in which they differ. The fields of the table's
   state hold zeros.

   Collective. layout and table must outlive the particles.
*/
PetscErrorCode MpmParticlesCreate(const MpmLayout *layout, const MpmTable *table, const MpmFraction drift[],
                                  const MpmGrid *grid, MpmParticles **particles);
PetscErrorCode MpmParticlesDestroy(MpmParticles **particles);

/*
   Not collective. Sets the fields to a scene's initial data, divided by 2^exponent. With initial data eigenmode they
   stay 0, and the caller sets them (MpmModeFileFill).
*/
PetscErrorCode MpmParticlesFill(const MpmScene *scene, PetscInt exponent, MpmParticles *particles);

/* Not collective. Sets every field to random numbers in [-amplitude, amplitude), hashed from seed and particle id. */
PetscErrorCode MpmParticlesFillRandom(PetscInt64 seed, PetscReal amplitude, MpmParticles *particles);

/* Not collective. A seed for each random field of a layout with a seed, so that these are independent. */
static inline PetscInt64 MpmParticlesSeed(PetscInt64 seed, PetscInt field)
{
  return (PetscInt64)(0x1p52 * MpmHash(seed + 1, -2 - field));
}

/* Not collective. Sets the properties that vary, from the ids of the particles. */
PetscErrorCode MpmParticlesWeigh(MpmParticles *particles);

/*
   Not collective. The number of particles that a rank's arrays have room for besides its own. Without such room the
   swarm would allocate all arrays anew with each particle that leaves.
*/
PetscInt MpmParticlesRoom(const MpmParticles *particles);

/*
   Not collective. The drift along an axis from the swarm's (cell, xi) to the places at a step: whole cells, and part in
   [0,1).
*/
PetscErrorCode MpmParticlesWhere(const MpmParticles *particles, PetscInt axis, PetscInt64 step, PetscInt *whole,
                                 PetscReal *part);

/* Not collective. Whether all particles move by the drift, relative to the grid. */
static inline PetscBool MpmParticlesMove(const MpmParticles *particles)
{
  for (PetscInt a = 0; a < particles->layout->dim; a++)
    if (particles->drift[a].value != 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Not collective. Access to a swarm field by name; every Get needs its Restore. */
PetscErrorCode MpmParticlesGet(const MpmParticles *particles, const char name[], void *array);
PetscErrorCode MpmParticlesRestore(const MpmParticles *particles, const char name[], void *array);

/* Not collective. The Lagrangian coordinates X = x - U0 t of a particle, in the unit of the cell's width. */
static inline void MpmParticlesLagrangian(const MpmParticles *particles, PetscInt64 id, PetscReal cell_width,
                                          PetscReal X[])
{
  MpmLayoutRest(particles->layout, id, X);
  for (PetscInt a = 0; a < particles->layout->dim; a++) X[a] *= cell_width;
}

/*
   MpmParticlesSortIfNeeded - brings particles that move each by itself into the order of their cells, if some share of
   them is out of order.

   Not collective. It depends on the places and the order alone, so that a run that resumes sorts as one that did not
   end.
*/
PetscErrorCode MpmParticlesSortIfNeeded(MpmParticles *particles, const MpmGrid *grid);

/* Not collective. Brings the particles into the order of their places. */
PetscErrorCode MpmParticlesSort(MpmParticles *particles, const MpmGrid *grid);

/*
   MpmParticlesRebase - adds the whole cells of drift to the cell field, and sends particles that have left this rank's
   cells to their owners.

   Collective. On return the particles are in the order of their places again. It is checked that none is lost.
*/
PetscErrorCode MpmParticlesRebase(MpmParticles *particles, const MpmGrid *grid);
