/* The order of particles that move each by itself: by their cells, x fastest. */
#include "march/particles.h"

#define SHARE 16 /* one particle in so many may be in a cell before that of the particle before it */

/* The number of a particle's cell in the box of this rank's cells and ghosts. */
static PetscInt Number(const MpmGrid *grid, PetscInt *const cell[], PetscInt p)
{
  PetscInt number = 0;

  for (PetscInt a = grid->dim - 1; a >= 0; a--)
    number = number * (grid->axis[a].count + 2 * grid->ghost) + cell[a][p] + grid->ghost;
  return number;
}

static PetscErrorCode GetCells(const MpmParticles *particles, const MpmGrid *grid, PetscInt *cell[])
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < grid->dim; a++) PetscCall(MpmParticlesGet(particles, MpmFieldCell[a], &cell[a]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RestoreCells(const MpmParticles *particles, const MpmGrid *grid, PetscInt *cell[])
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < grid->dim; a++) PetscCall(MpmParticlesRestore(particles, MpmFieldCell[a], &cell[a]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesCellOrder(const MpmParticles *particles, const MpmGrid *grid, PetscInt order[])
{
  PetscInt cells = 1, *cell[MPM_MAX_DIM], *next;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < grid->dim; a++) cells *= grid->axis[a].count + 2 * grid->ghost;
  PetscCall(PetscCalloc1(cells + 1, &next));
  PetscCall(GetCells(particles, grid, cell));
  for (PetscInt p = 0; p < particles->count; p++) next[Number(grid, cell, p) + 1]++;
  for (PetscInt c = 0; c < cells; c++) next[c + 1] += next[c];
  for (PetscInt p = 0; p < particles->count; p++) order[next[Number(grid, cell, p)]++] = p;
  PetscCall(RestoreCells(particles, grid, cell));
  PetscCall(PetscFree(next));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesSortIfNeeded(MpmParticles *particles, const MpmGrid *grid)
{
  PetscInt before = 0, n = 0, *cell[MPM_MAX_DIM];

  PetscFunctionBegin;
  PetscCall(GetCells(particles, grid, cell));
  for (PetscInt p = 0; p < particles->count; p++) {
    const PetscInt number = Number(grid, cell, p);

    n += number < before;
    before = number;
  }
  PetscCall(RestoreCells(particles, grid, cell));
  if (n > particles->count / SHARE) PetscCall(MpmParticlesSort(particles, grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}
