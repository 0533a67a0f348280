/* Particles: a DMSwarm of the fields the table names, their places, and who owns them. */
#pragma once
#include "march/grid.h"
#include "scene/layout.h"
#include "scene/material.h"
#include <mpmstab/scene.h>
#include <petscdmswarm.h>

/*S
   MpmParticles - the particles of this rank, in the order of their places.

   A particle's place at step n is cell + xi + n delta. The swarm keeps (cell, xi) of the resting particle:
   cell as a local index of the grid, moved on by the rebased whole cells that drift has carried it; the rest of
   n delta is common to all particles and is formed exactly, so that nothing accumulates and moving costs no
   memory traffic. DMSwarm's own pid field is the global id.
S*/
typedef struct {
  DM               swarm;
  const MpmLayout *layout;
  const MpmTable  *table;
  MpmFraction      drift;
  PetscInt         count;    /* on this rank */
  PetscInt         per_cell; /* particle p + per_cell rests where p does, one cell on; 0: not so for all */
  PetscInt64       total;    /* on all ranks */
  PetscInt64       step;     /* time level of the places */
  PetscInt64       rebased;  /* whole cells of drift already in the cell field */
  PetscBool        parallel;
} MpmParticles;

/* Where this rank's particles rest, and their masses where these differ (else NULL): the swarm's arrays. */
typedef struct {
  const PetscInt  *cell;
  const PetscReal *xi, *mass;
} MpmPlaces;

extern const char MpmFieldCell[], MpmFieldXi[];

/*
   MpmParticlesCreate - places a layout's particles, with the properties in which they differ; the fields of the table's
   state are there and hold zeros.

   Collective. layout and table must outlive the particles.
*/
PetscErrorCode MpmParticlesCreate(const MpmLayout *layout, const MpmTable *table, const MpmFraction *drift,
                                  const MpmGrid *grid, MpmParticles **particles);
PetscErrorCode MpmParticlesDestroy(MpmParticles **particles);

/* Not collective. Gives the fields a scene's initial data, divided by 2^exponent. */
PetscErrorCode MpmParticlesFill(const MpmScene *scene, const MpmGrid *grid, PetscInt exponent, MpmParticles *particles);

/* Not collective. Gives every field random numbers in [-amplitude, amplitude), hashed from seed and particle id. */
PetscErrorCode MpmParticlesFillRandom(PetscInt64 seed, PetscReal amplitude, MpmParticles *particles);

/* Not collective. Gives the particles, by their ids, the properties that vary. */
PetscErrorCode MpmParticlesWeigh(MpmParticles *particles);

/*
   Not collective. How many more particles than it has a rank's arrays have room for: without, the swarm would give back
   and ask again for the memory of all arrays with each particle that leaves.
*/
PetscInt MpmParticlesRoom(const MpmParticles *particles);

/* Not collective. Finds per_cell; to be called when places have changed. */
PetscErrorCode MpmParticlesComparePlaces(MpmParticles *particles);

/* Not collective. Where the particles are at a step, from the swarm's (cell, xi): whole cells and part in [0,1) on. */
PetscErrorCode MpmParticlesWhere(const MpmParticles *particles, PetscInt64 step, PetscInt *whole, PetscReal *part);

/* Not collective. Access to a swarm field by name; every Get needs its Restore. */
PetscErrorCode MpmParticlesGet(const MpmParticles *particles, const char name[], void *array);
PetscErrorCode MpmParticlesRestore(const MpmParticles *particles, const char name[], void *array);

/* Not collective. The Lagrangian coordinate X / h of a particle, in [0, cells), from its swarm fields. */
static inline PetscReal MpmParticlesLagrangian(const MpmParticles *particles, const MpmGrid *grid, PetscInt cell,
                                               PetscReal xi)
{
  PetscInt64 home = (grid->first + cell - particles->rebased) % grid->cells;

  if (home < 0) home += grid->cells;
  return home + xi;
}

/*
   MpmParticlesRebase - takes the whole cells of drift into the cell field; particles that have left go to
   their owners.

   Collective. On return the particles are in the order of their places again and none is lost (checked).
*/
PetscErrorCode MpmParticlesRebase(MpmParticles *particles, const MpmGrid *grid);
