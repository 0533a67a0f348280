#include "program/slab.h"
#include "scene/layout.h"

PetscErrorCode MpmSlabOf(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                         MpmSlab *s)
{
  const PetscInt last = layout->dim - 1;
  PetscMPIInt    rank, size;
  PetscInt       plane_nodes = 1;
  PetscInt64     begin, end, plane = 1; /* the particles of a plane across the last direction */

  PetscFunctionBegin;
  *s = (MpmSlab){.comm = comm, .layout = layout, .scheme = scheme, .step = *step};
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  s->cells = MpmGridCount(layout->grid[last].cells, size, rank);
  s->first = MpmGridFirst(layout->grid[last].cells, size, rank);
  for (PetscInt a = 0; a < last; a++) {
    plane_nodes *= layout->grid[a].nodes;
    plane *= layout->row[a];
  }
  s->node0 = s->first * plane_nodes;
  s->nodes = (s->cells + (rank == size - 1 ? layout->grid[last].nodes - layout->grid[last].cells : 0)) * plane_nodes;
  begin    = MpmLayoutParticlesBefore(layout, last, s->first);
  end      = MpmLayoutParticlesBefore(layout, last, s->first + s->cells);
  s->begin = (PetscInt)(plane * begin);
  s->particles = (PetscInt)(plane * (end - begin));
  if (layout->given) { /* in the order of their ids, wherever they are */
    s->begin     = (PetscInt)(layout->particles * rank / size);
    s->particles = (PetscInt)(layout->particles * (rank + 1) / size) - s->begin;
  }
  s->fields = scheme->table->nstate;
  s->state  = s->particles * s->fields;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt MpmNodeAlong(const MpmLayout *layout, PetscInt node, PetscInt axis, PetscInt *stride)
{
  *stride = 1;
  for (PetscInt a = 0; a < axis; a++) *stride *= layout->grid[a].nodes;
  return node / *stride % layout->grid[axis].nodes;
}
