/* The particles of a rank at the start. */
#include "march/particles.h"

/* The sites of one direction that may have a particle in this rank's cells there, and the cells that unwrapping adds. */
typedef struct {
  PetscInt    n;
  PetscInt64 *site; /* counted from the first that is taken */
  PetscInt   *shift;
} Sides;

/* The arrays of the swarm; NULL: particles are only counted. */
typedef struct {
  PetscInt64 *id;
  PetscInt   *cell[MPM_MAX_DIM];
  PetscReal  *xi[MPM_MAX_DIM];
} Arrays;

/* Jitter may take a particle into a neighbour of its own cell. In one dimension cells may have different numbers of sites. */
static PetscErrorCode FindSides(const MpmLayout *layout, const MpmGrid *grid, PetscInt a, Sides *s)
{
  const MpmGridAxis *axis = &grid->axis[a];
  const PetscInt     most = (axis->count + 2) * layout->ppc[a];

  PetscFunctionBegin;
  s->n = 0;
  PetscCall(PetscMalloc2(most, &s->site, most, &s->shift));
  for (PetscInt c = axis->first - 1; c <= axis->first + axis->count; c++) {
    const PetscInt   wrapped = (c % axis->cells + axis->cells) % axis->cells;
    const PetscInt   sites   = layout->dim == 1 ? MpmLayoutSitesIn(layout, wrapped) : layout->ppc[a];
    const PetscInt64 before  = layout->dim == 1 ? MpmLayoutSitesBefore(layout, wrapped) : (PetscInt64)wrapped * sites;

    if (!axis->periodic && wrapped != c) continue;
    for (PetscInt j = 0; j < sites; j++) {
      const PetscInt64 site = before + j - layout->first[a];

      if (site < 0 || site >= layout->row[a]) continue;
      s->site[s->n]    = site;
      s->shift[s->n++] = c - wrapped - axis->first;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes particle g as the n-th if its cell, with shift, is one of this rank's. Returns how many there are then. */
static PetscInt Take(const MpmLayout *layout, const MpmGrid *grid, PetscInt64 g, const PetscInt shift[],
                     const Arrays *to, PetscInt n)
{
  PetscInt  place[MPM_MAX_DIM];
  PetscReal part[MPM_MAX_DIM];

  MpmLayoutPlace(layout, g, place, part);
  for (PetscInt a = 0; a < grid->dim; a++) {
    place[a] += shift[a];
    if (place[a] < 0 || place[a] >= grid->axis[a].count) return n;
  }
  if (!to) return n + 1;
  for (PetscInt a = 0; a < grid->dim; a++) {
    to->cell[a][n] = place[a];
    to->xi[a][n]   = part[a];
  }
  to->id[n] = g;
  return n + 1;
}

/* Visits the particles whose cell this rank has: those at sites, or those of a file by id. */
static PetscInt Visit(const MpmLayout *layout, const MpmGrid *grid, const Sides sides[], const Arrays *to)
{
  const PetscInt ny = grid->dim > 1 ? sides[1].n : 1, lines = grid->dim > 2 ? ny * sides[2].n : ny;
  PetscInt       n = 0, shift[MPM_MAX_DIM];

  for (PetscInt a = 0; a < grid->dim; a++) shift[a] = -grid->axis[a].first;
  for (PetscInt64 g = 0; layout->given && g < layout->particles; g++) n = Take(layout, grid, g, shift, to, n);
  for (PetscInt line = 0; line < lines && !layout->given; line++) {
    for (PetscInt x = 0; x < sides[0].n; x++) {
      const PetscInt at[MPM_MAX_DIM] = {x, line % ny, line / ny};
      PetscInt64     g               = 0;

      for (PetscInt a = grid->dim - 1; a >= 0; a--) {
        g        = g * layout->row[a] + sides[a].site[at[a]];
        shift[a] = sides[a].shift[at[a]];
      }
      g = MpmLayoutIdAt(layout, g);
      if (g >= 0) n = Take(layout, grid, g, shift, to, n);
    }
  }
  return n;
}

PetscErrorCode MpmParticlesPlace(const MpmGrid *grid, MpmParticles *particles)
{
  const MpmLayout *layout             = particles->layout;
  Sides            sides[MPM_MAX_DIM] = {{0}};
  Arrays           to;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < grid->dim && !layout->given; a++) PetscCall(FindSides(layout, grid, a, &sides[a]));
  particles->count = Visit(layout, grid, sides, NULL);
  PetscCall(DMSwarmSetLocalSizes(particles->swarm, particles->count, MpmParticlesRoom(particles)));
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &to.id));
  for (PetscInt a = 0; a < grid->dim; a++) {
    PetscCall(MpmParticlesGet(particles, MpmFieldCell[a], &to.cell[a]));
    PetscCall(MpmParticlesGet(particles, MpmFieldXi[a], &to.xi[a]));
  }
  (void)Visit(layout, grid, sides, &to);
  for (PetscInt a = grid->dim - 1; a >= 0; a--) {
    PetscCall(MpmParticlesRestore(particles, MpmFieldXi[a], &to.xi[a]));
    PetscCall(MpmParticlesRestore(particles, MpmFieldCell[a], &to.cell[a]));
    PetscCall(PetscFree2(sides[a].site, sides[a].shift));
  }
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &to.id));
  PetscCall(MpmParticlesSort(particles, grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}
