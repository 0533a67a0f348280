/* The particles of a rank at the start, where a file gives their places. */
#include "march/particles.h"

/* Visits the particles whose cell this rank has, by id. With arrays it stores them, without it only counts them. */
static PetscInt Visit(const MpmLayout *layout, const MpmGrid *grid, PetscInt64 id[], PetscInt *cell[], PetscReal *xi[])
{
  PetscInt n = 0;

  for (PetscInt64 g = 0; g < layout->particles; g++) {
    PetscInt  place[MPM_MAX_DIM];
    PetscReal part[MPM_MAX_DIM];
    PetscBool own = PETSC_TRUE;

    MpmLayoutPlace(layout, g, place, part);
    for (PetscInt a = 0; a < grid->dim; a++) {
      place[a] -= grid->axis[a].first;
      if (place[a] < 0 || place[a] >= grid->axis[a].count) own = PETSC_FALSE;
    }
    if (!own) continue;
    for (PetscInt a = 0; a < grid->dim && id; a++) {
      cell[a][n] = place[a];
      xi[a][n]   = part[a];
    }
    if (id) id[n] = g;
    n++;
  }
  return n;
}

PetscErrorCode MpmParticlesPlaceGiven(const MpmGrid *grid, MpmParticles *particles)
{
  PetscInt64 *id;
  PetscInt   *cell[MPM_MAX_DIM];
  PetscReal  *xi[MPM_MAX_DIM];

  PetscFunctionBegin;
  particles->count = Visit(particles->layout, grid, NULL, NULL, NULL);
  PetscCall(DMSwarmSetLocalSizes(particles->swarm, particles->count, MpmParticlesRoom(particles)));
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  for (PetscInt a = 0; a < grid->dim; a++) {
    PetscCall(MpmParticlesGet(particles, MpmFieldCell[a], &cell[a]));
    PetscCall(MpmParticlesGet(particles, MpmFieldXi[a], &xi[a]));
  }
  (void)Visit(particles->layout, grid, id, cell, xi);
  for (PetscInt a = 0; a < grid->dim; a++) {
    PetscCall(MpmParticlesRestore(particles, MpmFieldXi[a], &xi[a]));
    PetscCall(MpmParticlesRestore(particles, MpmFieldCell[a], &cell[a]));
  }
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  PetscCall(MpmParticlesSort(particles, grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}
