/*
   Migration. The drift is the same for all particles. So every rank knows without communication when particles may have
   reached the end of the ghost layer, and they are sent only then. The swarm fills the holes that they leave with its
   last particles. The speed of passes depends on the order of places, which is therefore restored.
*/
#include "march/particles.h"
#include "scheme/kernels.h"
#include <stdint.h>
#include <stdlib.h>

#define SHARE 16 /* one particle in so many may be in a cell before that of the particle before it */

/*
   Sets the global cell of each particle along one axis. Cells are global until particles have arrived. The particles
   are at whole cells and part of a cell from their resting places.
*/
static PetscErrorCode SetGlobalCells(MpmParticles *particles, const MpmGridAxis *axis, PetscInt a, PetscInt whole,
                                     PetscReal part)
{
  const PetscReal *xi;
  PetscInt        *cell;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, MpmFieldXi[a], &xi));
  PetscCall(MpmParticlesGet(particles, MpmFieldCell[a], &cell));
  for (PetscInt p = 0; p < particles->count; p++) {
    PetscInt  now = cell[p];
    PetscReal place;

    if (particles->drift[a].value != 0) MpmPlaceBlock(1, &cell[p], &xi[p], whole, part, &now, &place);
    now = (axis->first + now) % axis->cells;
    if (now < 0) now += axis->cells;
    cell[p] = now;
  }
  PetscCall(MpmParticlesRestore(particles, MpmFieldCell[a], &cell));
  PetscCall(MpmParticlesRestore(particles, MpmFieldXi[a], &xi));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the owners of the particles from their global cells, and counts the particles that leave. */
static PetscErrorCode SetOwners(MpmParticles *particles, const MpmGrid *grid, PetscInt64 *leaving)
{
  PetscInt   *cell[MPM_MAX_DIM], *owner;
  PetscMPIInt self;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm((PetscObject)particles->swarm), &self));
  PetscCall(MpmParticlesGet(particles, DMSwarmField_rank, &owner));
  for (PetscInt a = 0; a < grid->dim; a++) PetscCall(MpmParticlesGet(particles, MpmFieldCell[a], &cell[a]));
  for (PetscInt p = 0; p < particles->count; p++) {
    PetscInt  now[MPM_MAX_DIM];
    PetscBool stays = PETSC_TRUE;

    for (PetscInt a = 0; a < grid->dim; a++) {
      const MpmGridAxis *axis = &grid->axis[a];

      now[a] = cell[a][p];
      if (now[a] < axis->first || now[a] >= axis->first + axis->count) stays = PETSC_FALSE;
    }
    owner[p] = stays ? self : MpmGridOwner(grid, now);
    *leaving += !stays;
  }
  for (PetscInt a = 0; a < grid->dim; a++) PetscCall(MpmParticlesRestore(particles, MpmFieldCell[a], &cell[a]));
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_rank, &owner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Turns the global cells that particles are in now into local resting cells: takes back the part of the drift that is
   less than a cell, and leaves whole cells in.
*/
static PetscErrorCode SetRestingCells(MpmParticles *particles, const MpmGridAxis *axis, PetscInt a, PetscReal part)
{
  const PetscReal *xi;
  PetscInt        *cell;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, MpmFieldXi[a], &xi));
  PetscCall(MpmParticlesGet(particles, MpmFieldCell[a], &cell));
  for (PetscInt p = 0; p < particles->count; p++) {
    const PetscInt zero  = 0;
    PetscInt       carry = 0;
    PetscReal      place;

    if (particles->drift[a].value != 0) MpmPlaceBlock(1, &zero, &xi[p], 0, part, &carry, &place);
    cell[p] -= axis->first + carry;
  }
  PetscCall(MpmParticlesRestore(particles, MpmFieldCell[a], &cell));
  PetscCall(MpmParticlesRestore(particles, MpmFieldXi[a], &xi));
  PetscFunctionReturn(PETSC_SUCCESS);
}

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

/* order[i] is the i-th particle by its cell, x fastest. Those of a cell stay in the order that they are in. */
static PetscErrorCode FindCellOrder(const MpmParticles *particles, const MpmGrid *grid, PetscInt order[])
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

/* order[i] is the i-th particle by (cell, xi, id): a sort by cell, then an insertion sort within a cell. */
static PetscErrorCode FindOrder(const MpmParticles *particles, const MpmGrid *grid, PetscInt order[])
{
  const PetscInt64 *id;
  const PetscReal  *xi;
  const PetscInt   *cell;

  PetscFunctionBegin;
  PetscCall(FindCellOrder(particles, grid, order));
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  PetscCall(MpmParticlesGet(particles, MpmFieldXi[0], &xi));
  PetscCall(MpmParticlesGet(particles, MpmFieldCell[0], &cell));
  for (PetscInt i = 1; i < particles->count; i++) {
    const PetscInt p = order[i];
    PetscInt       j = i;

    for (; j > 0 && cell[order[j - 1]] == cell[p]; j--) {
      const PetscInt q = order[j - 1];

      if (xi[q] < xi[p] || (xi[q] == xi[p] && id[q] < id[p])) break;
      order[j] = q;
    }
    order[j] = p;
  }
  PetscCall(MpmParticlesRestore(particles, MpmFieldCell[0], &cell));
  PetscCall(MpmParticlesRestore(particles, MpmFieldXi[0], &xi));
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the order of particles in more than one dimension depends on, the most important first. */
typedef struct {
  PetscInt64 cells, line; /* numbers of the row of cells, and of the line */
  PetscReal  xi;
  PetscInt64 id;
  PetscInt   cell, particle;
} Key;

static int CompareKeys(const void *left, const void *right)
{
  const Key *a = left, *b = right;

  if (a->cells != b->cells) return a->cells < b->cells ? -1 : 1;
  if (a->line != b->line) return a->line < b->line ? -1 : 1;
  if (a->cell != b->cell) return a->cell < b->cell ? -1 : 1;
  if (a->xi != b->xi) return a->xi < b->xi ? -1 : 1;
  return a->id < b->id ? -1 : 1;
}

/* As FindOrder, for the order by rows of cells and lines. */
static PetscErrorCode FindRowOrder(const MpmParticles *particles, const MpmGrid *grid, PetscInt order[])
{
  const PetscInt64 *id;
  const PetscReal  *xi;
  const PetscInt   *cell[MPM_MAX_DIM];
  Key              *key;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(particles->count, &key));
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  PetscCall(MpmParticlesGet(particles, MpmFieldXi[0], &xi));
  for (PetscInt a = 0; a < grid->dim; a++) PetscCall(MpmParticlesGet(particles, MpmFieldCell[a], &cell[a]));
  for (PetscInt p = 0; p < particles->count; p++) {
    key[p] =
        (Key){.line = id[p] / particles->layout->row[0], .xi = xi[p], .id = id[p], .cell = cell[0][p], .particle = p};
    for (PetscInt a = grid->dim - 1; a > 0; a--) key[p].cells = key[p].cells * (grid->axis[a].count + 1) + cell[a][p];
  }
  for (PetscInt a = 0; a < grid->dim; a++) PetscCall(MpmParticlesRestore(particles, MpmFieldCell[a], &cell[a]));
  PetscCall(MpmParticlesRestore(particles, MpmFieldXi[0], &xi));
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  qsort(key, (size_t)particles->count, sizeof *key, CompareKeys);
  for (PetscInt i = 0; i < particles->count; i++) order[i] = key[i].particle;
  PetscCall(PetscFree(key));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Applies the order to one field, in words of four bytes. So the buffer takes four bytes a particle, not eight. */
static PetscErrorCode Reorder(const MpmParticles *particles, const char name[], const PetscInt order[],
                              uint32_t buffer[])
{
  const PetscInt n = particles->count;
  PetscDataType  type;
  size_t         bytes, words;
  uint32_t      *field;

  PetscFunctionBegin;
  PetscCall(DMSwarmGetField(particles->swarm, name, NULL, &type, (void **)&field));
  PetscCall(PetscDataTypeGetSize(type, &bytes));
  words = bytes / sizeof *field;
  PetscCheck(bytes % sizeof *field == 0, PETSC_COMM_SELF, PETSC_ERR_PLIB, "field %s has no whole words", name);
  for (size_t w = 0; w < words; w++) {
    for (PetscInt i = 0; i < n; i++) buffer[i] = field[words * (size_t)order[i] + w];
    for (PetscInt i = 0; i < n; i++) field[words * (size_t)i + w] = buffer[i];
  }
  PetscCall(DMSwarmRestoreField(particles->swarm, name, NULL, &type, (void **)&field));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesSort(MpmParticles *particles, const MpmGrid *grid)
{
  PetscInt *order;
  uint32_t *buffer;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(particles->count, &order));
  if (particles->own)
    PetscCall(FindCellOrder(particles, grid, order));
  else if (grid->dim == 1)
    PetscCall(FindOrder(particles, grid, order));
  else
    PetscCall(FindRowOrder(particles, grid, order));
  PetscCall(PetscMalloc1(particles->count, &buffer));
  PetscCall(Reorder(particles, DMSwarmField_pid, order, buffer));
  for (PetscInt a = 0; a < grid->dim; a++) {
    PetscCall(Reorder(particles, MpmFieldCell[a], order, buffer));
    PetscCall(Reorder(particles, MpmFieldXi[a], order, buffer));
  }
  for (PetscInt f = 0; f < MpmTableHeld(particles->table); f++)
    PetscCall(Reorder(particles, particles->table->names[f], order, buffer));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (particles->layout->varies[w]) PetscCall(Reorder(particles, MpmPropertyNames[w], order, buffer));
  PetscCall(PetscFree(buffer));
  PetscCall(PetscFree(order));
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

PetscErrorCode MpmParticlesRebase(MpmParticles *particles, const MpmGrid *grid)
{
  MPI_Comm   comm = PetscObjectComm((PetscObject)particles->swarm);
  PetscInt   whole[MPM_MAX_DIM], size;
  PetscInt64 leaving = 0;
  PetscReal  part[MPM_MAX_DIM];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < grid->dim; a++) {
    PetscCall(MpmParticlesWhere(particles, a, particles->step, &whole[a], &part[a]));
    PetscCall(SetGlobalCells(particles, &grid->axis[a], a, whole[a], part[a]));
  }
  if (particles->parallel) {
    PetscCall(SetOwners(particles, grid, &leaving));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &leaving, 1, MPIU_INT64, MPI_SUM, comm));
    if (leaving) PetscCall(DMSwarmMigrate(particles->swarm, PETSC_TRUE));
    PetscCall(DMSwarmGetLocalSize(particles->swarm, &particles->count));
    PetscCall(DMSwarmGetSize(particles->swarm, &size));
    PetscCheck(size == particles->total, comm, PETSC_ERR_PLIB,
               "%" PetscInt_FMT " particles after migration, %" PetscInt64_FMT " before", size, particles->total);
  }
  for (PetscInt a = 0; a < grid->dim; a++) {
    PetscCall(SetRestingCells(particles, &grid->axis[a], a, part[a]));
    particles->rebased[a] += whole[a];
  }
  PetscCall(MpmParticlesSort(particles, grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}
