/*
   Migration. The drift is the same for all particles. So every rank knows without communication when particles may have
   reached the end of the ghost layer, and they are sent only then. The swarm fills the holes that they leave with its
   last particles. The speed of passes depends on the order of places, which is therefore restored.
*/
#include "march/particles.h"
#include "scheme/kernels.h"
#include <stdint.h>

/* Sets global cells and owners, and counts the particles that leave. Cells are global until particles have arrived. */
static PetscErrorCode SetOwners(MpmParticles *particles, const MpmGrid *grid, PetscInt whole, PetscReal part,
                                PetscInt64 *leaving)
{
  const PetscReal *xi;
  PetscInt        *cell, *owner = NULL, self;
  PetscMPIInt      rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm((PetscObject)particles->swarm), &rank));
  self     = rank;
  *leaving = 0;
  PetscCall(MpmParticlesGet(particles, MpmFieldXi, &xi));
  PetscCall(MpmParticlesGet(particles, MpmFieldCell, &cell));
  if (particles->parallel) PetscCall(MpmParticlesGet(particles, DMSwarmField_rank, &owner));
  for (PetscInt p = 0; p < particles->count; p++) {
    PetscInt  now;
    PetscReal place;

    MpmPlaceBlock(1, &cell[p], &xi[p], whole, part, &now, &place);
    now = (grid->first + now) % grid->cells;
    if (now < 0) now += grid->cells;
    cell[p] = now;
    if (!owner) continue;
    owner[p] = now >= grid->first && now < grid->first + grid->count ? self : MpmGridOwner(grid, now);
    *leaving += owner[p] != self;
  }
  if (particles->parallel) PetscCall(MpmParticlesRestore(particles, DMSwarmField_rank, &owner));
  PetscCall(MpmParticlesRestore(particles, MpmFieldCell, &cell));
  PetscCall(MpmParticlesRestore(particles, MpmFieldXi, &xi));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Turns the global cells that particles are in now into local resting cells: takes back the part of the drift that is
   less than a cell, and leaves whole cells in.
*/
static PetscErrorCode SetRestingCells(MpmParticles *particles, const MpmGrid *grid, PetscReal part)
{
  const PetscReal *xi;
  PetscInt        *cell;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, MpmFieldXi, &xi));
  PetscCall(MpmParticlesGet(particles, MpmFieldCell, &cell));
  for (PetscInt p = 0; p < particles->count; p++) {
    const PetscInt zero = 0;
    PetscInt       carry;
    PetscReal      place;

    MpmPlaceBlock(1, &zero, &xi[p], 0, part, &carry, &place);
    cell[p] -= grid->first + carry;
  }
  PetscCall(MpmParticlesRestore(particles, MpmFieldCell, &cell));
  PetscCall(MpmParticlesRestore(particles, MpmFieldXi, &xi));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* order[i] is the i-th particle by (cell, xi, id): a counting sort by cell, then an insertion sort within a cell. */
static PetscErrorCode FindOrder(const MpmParticles *particles, const MpmGrid *grid, PetscInt order[])
{
  const PetscInt64 *id;
  const PetscReal  *xi;
  const PetscInt   *cell;
  PetscInt         *next;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  PetscCall(MpmParticlesGet(particles, MpmFieldXi, &xi));
  PetscCall(MpmParticlesGet(particles, MpmFieldCell, &cell));
  PetscCall(PetscCalloc1(grid->count + 2, &next)); /* for cells -1 to count - 1, and the end */
  for (PetscInt p = 0; p < particles->count; p++) next[cell[p] + 2]++;
  for (PetscInt c = 0; c <= grid->count; c++) next[c + 1] += next[c];
  for (PetscInt p = 0; p < particles->count; p++) order[next[cell[p] + 1]++] = p;
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
  PetscCall(PetscFree(next));
  PetscCall(MpmParticlesRestore(particles, MpmFieldCell, &cell));
  PetscCall(MpmParticlesRestore(particles, MpmFieldXi, &xi));
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
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

static PetscErrorCode RestoreOrder(MpmParticles *particles, const MpmGrid *grid)
{
  PetscInt *order;
  uint32_t *buffer;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(particles->count, &order));
  PetscCall(FindOrder(particles, grid, order));
  PetscCall(PetscMalloc1(particles->count, &buffer));
  PetscCall(Reorder(particles, DMSwarmField_pid, order, buffer));
  PetscCall(Reorder(particles, MpmFieldCell, order, buffer));
  PetscCall(Reorder(particles, MpmFieldXi, order, buffer));
  for (PetscInt f = 0; particles->table->fields[f]; f++)
    PetscCall(Reorder(particles, particles->table->fields[f], order, buffer));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (particles->layout->varies[w]) PetscCall(Reorder(particles, MpmPropertyNames[w], order, buffer));
  PetscCall(PetscFree(buffer));
  PetscCall(PetscFree(order));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesRebase(MpmParticles *particles, const MpmGrid *grid)
{
  MPI_Comm   comm = PetscObjectComm((PetscObject)particles->swarm);
  PetscInt   whole, size;
  PetscInt64 leaving;
  PetscReal  part;

  PetscFunctionBegin;
  PetscCall(MpmParticlesWhere(particles, particles->step, &whole, &part));
  PetscCall(SetOwners(particles, grid, whole, part, &leaving));
  if (particles->parallel) {
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &leaving, 1, MPIU_INT64, MPI_SUM, comm));
    if (leaving) PetscCall(DMSwarmMigrate(particles->swarm, PETSC_TRUE));
    PetscCall(DMSwarmGetLocalSize(particles->swarm, &particles->count));
    PetscCall(DMSwarmGetSize(particles->swarm, &size));
    PetscCheck(size == particles->total, comm, PETSC_ERR_PLIB,
               "%" PetscInt_FMT " particles after migration, %" PetscInt64_FMT " before", size, particles->total);
  }
  PetscCall(SetRestingCells(particles, grid, part));
  particles->rebased += whole;
  PetscCall(RestoreOrder(particles, grid));
  PetscCall(MpmParticlesComparePlaces(particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}
