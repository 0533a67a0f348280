/* The particles of a rank at the start, in more than one dimension. */
#include "march/particles.h"

/* The sites of one direction that may have a particle in this rank's cells there, and the cells that unwrapping adds. */
typedef struct {
  PetscInt    n;
  PetscInt64 *site; /* counted from the first that is taken */
  PetscInt   *shift;
} Sides;

/* Jitter may take a particle into a neighbour of its own cell. */
static PetscErrorCode FindSides(const MpmLayout *layout, const MpmGrid *grid, PetscInt a, Sides *s)
{
  const MpmGridAxis *axis = &grid->axis[a];
  const PetscInt     ppc = layout->ppc[a], most = (axis->count + 2) * ppc;

  PetscFunctionBegin;
  s->n = 0;
  PetscCall(PetscMalloc2(most, &s->site, most, &s->shift));
  for (PetscInt c = axis->first - 1; c <= axis->first + axis->count; c++) {
    const PetscInt wrapped = (c % axis->cells + axis->cells) % axis->cells;

    if (!axis->periodic && wrapped != c) continue;
    for (PetscInt j = 0; j < ppc; j++) {
      const PetscInt64 site = (PetscInt64)wrapped * ppc + j - layout->first[a];

      if (site < 0 || site >= layout->row[a]) continue;
      s->site[s->n]    = site;
      s->shift[s->n++] = c - wrapped - axis->first;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Visits the particles whose cell this rank has. With arrays it stores them, without it only counts them. */
static PetscInt Visit(const MpmLayout *layout, const MpmGrid *grid, const Sides sides[], PetscInt64 id[],
                      PetscInt *cell[], PetscReal *xi[])
{
  const PetscInt ny = sides[1].n, lines = grid->dim > 2 ? ny * sides[2].n : ny;
  PetscInt       n = 0;

  for (PetscInt line = 0; line < lines; line++) {
    for (PetscInt x = 0; x < sides[0].n; x++) {
      const PetscInt at[MPM_MAX_DIM] = {x, line % ny, line / ny};
      PetscInt64     g               = 0;
      PetscInt       place[MPM_MAX_DIM];
      PetscReal      part[MPM_MAX_DIM];
      PetscBool      own = PETSC_TRUE;

      for (PetscInt a = grid->dim - 1; a >= 0; a--) g = g * layout->row[a] + sides[a].site[at[a]];
      g = MpmLayoutIdAt(layout, g);
      if (g < 0) continue;
      MpmLayoutPlace(layout, g, place, part);
      for (PetscInt a = 0; a < grid->dim; a++) {
        place[a] += sides[a].shift[at[a]];
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
  }
  return n;
}

PetscErrorCode MpmParticlesPlaceBox(const MpmGrid *grid, MpmParticles *particles)
{
  Sides       sides[MPM_MAX_DIM] = {{0}};
  PetscInt64 *id;
  PetscInt   *cell[MPM_MAX_DIM];
  PetscReal  *xi[MPM_MAX_DIM];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < grid->dim; a++) PetscCall(FindSides(particles->layout, grid, a, &sides[a]));
  particles->count = Visit(particles->layout, grid, sides, NULL, NULL, NULL);
  PetscCall(DMSwarmSetLocalSizes(particles->swarm, particles->count, MpmParticlesRoom(particles)));
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  for (PetscInt a = 0; a < grid->dim; a++) {
    PetscCall(MpmParticlesGet(particles, MpmFieldCell[a], &cell[a]));
    PetscCall(MpmParticlesGet(particles, MpmFieldXi[a], &xi[a]));
  }
  (void)Visit(particles->layout, grid, sides, id, cell, xi);
  for (PetscInt a = 0; a < grid->dim; a++) {
    PetscCall(MpmParticlesRestore(particles, MpmFieldXi[a], &xi[a]));
    PetscCall(MpmParticlesRestore(particles, MpmFieldCell[a], &cell[a]));
    PetscCall(PetscFree2(sides[a].site, sides[a].shift));
  }
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  PetscCall(MpmParticlesSort(particles, grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}
