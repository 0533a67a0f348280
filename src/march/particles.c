/* Particles in a DMSwarm of type BASIC, with own places and owners: DMSWARM_PIC does not support one dimension. */
#include "base/large_pages.h"
#include "march/particles.h"
#include <math.h>

const char *const MpmFieldCell[] = {"cell", "cell_y", "cell_z"}, *const MpmFieldXi[] = {"xi", "xi_y", "xi_z"};

PetscErrorCode MpmParticlesWhere(const MpmParticles *particles, PetscInt axis, PetscInt64 step, PetscInt *whole,
                                 PetscReal *part)
{
  PetscInt64 cells;

  PetscFunctionBegin;
  MpmFractionMultiple(&particles->drift[axis], step, &cells, part);
  *whole = (PetscInt)(cells - particles->rebased[axis]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesGet(const MpmParticles *particles, const char name[], void *array)
{
  PetscFunctionBegin;
  PetscCall(DMSwarmGetField(particles->swarm, name, NULL, NULL, (void **)array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesRestore(const MpmParticles *particles, const char name[], void *array)
{
  PetscFunctionBegin;
  PetscCall(DMSwarmRestoreField(particles->swarm, name, NULL, NULL, (void **)array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateSwarm(const MpmGrid *grid, MpmParticles *particles)
{
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)grid->da), &size));
  particles->parallel = size > 1 ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(DMCreate(PetscObjectComm((PetscObject)grid->da), &particles->swarm));
  PetscCall(DMSetType(particles->swarm, DMSWARM));
  PetscCall(DMSetDimension(particles->swarm, grid->dim));
  PetscCall(DMSwarmSetType(particles->swarm, DMSWARM_BASIC));
  PetscCall(DMSwarmInitializeFieldRegister(particles->swarm));
  for (PetscInt a = 0; a < grid->dim; a++) {
    PetscCall(DMSwarmRegisterPetscDatatypeField(particles->swarm, MpmFieldCell[a], 1, PETSC_INT));
    PetscCall(DMSwarmRegisterPetscDatatypeField(particles->swarm, MpmFieldXi[a], 1, PETSC_REAL));
  }
  for (PetscInt f = 0; f < MpmTableHeld(particles->table); f++)
    PetscCall(DMSwarmRegisterPetscDatatypeField(particles->swarm, particles->table->names[f], 1, PETSC_REAL));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (particles->layout->varies[w])
      PetscCall(DMSwarmRegisterPetscDatatypeField(particles->swarm, MpmPropertyNames[w], 1, PETSC_REAL));
  PetscCall(DMSwarmFinalizeFieldRegister(particles->swarm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt MpmParticlesRoom(const MpmParticles *particles)
{
  return particles->parallel ? particles->count / 64 + 256 : 0;
}

PetscErrorCode MpmParticlesFillRandom(PetscInt64 seed, PetscReal amplitude, MpmParticles *particles)
{
  const PetscInt64 *id;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  for (PetscInt f = 0; particles->table->fields[f]; f++) {
    const PetscInt64 of_field = MpmParticlesSeed(seed, f);
    PetscReal       *q;

    PetscCall(MpmParticlesGet(particles, particles->table->fields[f], &q));
    for (PetscInt p = 0; p < particles->count; p++) q[p] = amplitude * (2 * MpmHash(of_field, id[p]) - 1);
    PetscCall(MpmParticlesRestore(particles, particles->table->fields[f], &q));
  }
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the fields to the exact solution at the start; a staggered field starts half a step earlier. */
static PetscErrorCode FillExact(const MpmScene *scene, PetscReal amplitude, MpmParticles *particles)
{
  const MpmProfile  profile = MpmSceneProfile(scene, amplitude);
  const PetscInt64 *id;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  for (PetscInt f = 0; particles->table->fields[f]; f++) {
    PetscReal *q;

    PetscCall(MpmParticlesGet(particles, particles->table->fields[f], &q));
    for (PetscInt p = 0; p < particles->count; p++) {
      PetscReal X[MPM_MAX_DIM];

      MpmParticlesLagrangian(particles, id[p], scene->cell_width, X);
      q[p] = MpmSceneExact(scene, &profile, f, X, 0);
    }
    PetscCall(MpmParticlesRestore(particles, particles->table->fields[f], &q));
  }
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Particles that are held start at rest: what they get by G2P is 0. */
static PetscErrorCode Hold(MpmParticles *particles)
{
  const MpmTable  *table = particles->table;
  const PetscReal *mobility;
  PetscReal       *q;

  PetscFunctionBegin;
  if (!particles->layout->varies[MPM_MOBILITY]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmParticlesGet(particles, MpmPropertyNames[MPM_MOBILITY], &mobility));
  for (PetscInt o = 0; o < table->nops; o++) {
    if (MpmOpTraitsOf(table->ops[o].kind).weight != MPM_MOBILITY || table->ops[o].dst >= table->nstate) continue;
    PetscCall(MpmParticlesGet(particles, table->fields[table->ops[o].dst], &q));
    for (PetscInt p = 0; p < particles->count; p++) q[p] *= mobility[p];
    PetscCall(MpmParticlesRestore(particles, table->fields[table->ops[o].dst], &q));
  }
  PetscCall(MpmParticlesRestore(particles, MpmPropertyNames[MPM_MOBILITY], &mobility));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesFill(const MpmScene *scene, PetscInt exponent, MpmParticles *particles)
{
  const PetscReal amplitude = scalbn(scene->amplitude, -(int)exponent);

  PetscFunctionBegin;
  if (scene->initial == MPM_INITIAL_RANDOM)
    PetscCall(MpmParticlesFillRandom(particles->layout->seed, amplitude, particles));
  else if (scene->initial != MPM_INITIAL_EIGENMODE)
    PetscCall(FillExact(scene, amplitude, particles));
  PetscCall(Hold(particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesWeigh(MpmParticles *particles)
{
  const PetscInt64 *id;
  PetscReal        *weight;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++) {
    if (!particles->layout->varies[w]) continue;
    PetscCall(MpmParticlesGet(particles, MpmPropertyNames[w], &weight));
    for (PetscInt p = 0; p < particles->count; p++)
      weight[p] = MpmMaterialProperty(particles->layout, (MpmProperty)w, id[p]);
    PetscCall(MpmParticlesRestore(particles, MpmPropertyNames[w], &weight));
  }
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the particles of a rank at the start ---- */

/*
   The sites of one direction that may have a particle in this rank's cells there, and the cells that unwrapping adds.
*/
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

/*
   Jitter may take a particle into a neighbour of its own cell. In one dimension cells may have different numbers of
   sites.
*/
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

static PetscErrorCode Place(const MpmGrid *grid, MpmParticles *particles)
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

/* Every pass goes through all of these arrays. */
static PetscErrorCode UseLargePages(MpmParticles *particles)
{
  const char *name[2 * MPM_MAX_DIM + MPM_MAX_FIELDS + MPM_PROPERTIES];
  PetscInt    n = 0;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < particles->layout->dim; a++) {
    name[n++] = MpmFieldCell[a];
    name[n++] = MpmFieldXi[a];
  }
  for (PetscInt f = 0; f < MpmTableHeld(particles->table); f++) name[n++] = particles->table->names[f];
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (particles->layout->varies[w]) name[n++] = MpmPropertyNames[w];
  for (PetscInt i = 0; i < n; i++) {
    PetscDataType type;
    size_t        size;
    void         *array;

    PetscCall(DMSwarmGetField(particles->swarm, name[i], NULL, &type, &array));
    PetscCall(PetscDataTypeGetSize(type, &size));
    MpmLargePages(array, size * (size_t)particles->count);
    PetscCall(DMSwarmRestoreField(particles->swarm, name[i], NULL, &type, &array));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesCreate(const MpmLayout *layout, const MpmTable *table, const MpmFraction *drift,
                                  const MpmGrid *grid, MpmParticles **particles)
{
  PetscInt size;

  PetscFunctionBegin;
  PetscCall(PetscNew(particles));
  (*particles)->layout = layout;
  (*particles)->table  = table;
  (*particles)->total  = layout->particles;
  (*particles)->own    = MpmTableIsFinite(table);
  if (!(*particles)->own) PetscCall(PetscArraycpy((*particles)->drift, drift, MPM_MAX_DIM));
  PetscCall(CreateSwarm(grid, *particles));
  PetscCall(Place(grid, *particles));
  PetscCall(DMSwarmGetSize((*particles)->swarm, &size));
  PetscCheck(size == (*particles)->total, PetscObjectComm((PetscObject)grid->da), PETSC_ERR_PLIB,
             "%" PetscInt_FMT " particles placed of %" PetscInt64_FMT, size, (*particles)->total);
  PetscCall(UseLargePages(*particles));
  PetscCall(MpmParticlesWeigh(*particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesDestroy(MpmParticles **particles)
{
  PetscFunctionBegin;
  PetscCall(DMDestroy(&(*particles)->swarm));
  PetscCall(PetscFree(*particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}
