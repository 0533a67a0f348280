/*
   Node fields in DMDA vectors, and sums over the copies of nodes that ranks share.

   The sums are made by a star forest: its leaves are the ghosts of a local array, and its roots the same nodes where
   they are owned. The owner adds up what its ghosts have, and they get the sum. DMLocalToGlobal with ADD_VALUES and back
   would copy every node twice, for a few that are shared.
*/
#include "march/grid.h"
#include <mpmstab/table.h>

/* The owner of a node along one axis, and the node's index there. Returns false for a node beyond a wall. */
static PetscBool FindAlong(const MpmGridAxis *axis, PetscInt local, PetscInt *rank, PetscInt *index)
{
  PetscInt node = axis->first + local;

  if (!axis->periodic && (node < 0 || node >= axis->all)) return PETSC_FALSE;
  if (axis->periodic) node = (node % axis->cells + axis->cells) % axis->cells;
  *rank = 0;
  while (*rank + 1 < axis->ranks && node >= axis->starts[*rank + 1]) ++*rank;
  *index = node - axis->starts[*rank];
  return PETSC_TRUE;
}

/* The number of nodes that the r-th rank along an axis owns. */
static PetscInt NodesOf(const MpmGridAxis *axis, PetscInt r)
{
  return axis->starts[r + 1] - axis->starts[r] + (r == axis->ranks - 1 ? axis->all - axis->cells : 0);
}

/* Finds the owner of a ghost, and its index in the owner's local arrays. False: it is no ghost, or beyond a wall. */
static PetscBool FindOwner(const MpmGrid *grid, const PetscInt node[], PetscSFNode *owner)
{
  PetscBool ghost  = PETSC_FALSE;
  PetscInt  stride = 1, ranks = 1;

  for (PetscInt a = 0; a < grid->dim; a++)
    if (node[a] < 0 || node[a] >= grid->axis[a].nodes) ghost = PETSC_TRUE;
  *owner = (PetscSFNode){0, 0};
  for (PetscInt a = 0; a < grid->dim && ghost; a++) {
    const MpmGridAxis *axis = &grid->axis[a];
    PetscInt           rank, index;

    if (!FindAlong(axis, node[a], &rank, &index)) return PETSC_FALSE;
    owner->rank += ranks * rank;
    owner->index += stride * (index + grid->ghost);
    ranks *= axis->ranks;
    stride *= NodesOf(axis, rank) + 2 * grid->ghost;
  }
  return ghost;
}

static PetscErrorCode CreateForest(MpmGrid *grid)
{
  const MpmGridBox box  = MpmGridBoxOf(grid, grid->ghost);
  const PetscInt   size = MpmGridSize(grid);
  PetscInt         n    = 0, *ghost, node[MPM_MAX_DIM];
  PetscSFNode     *owner;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(size - MpmGridNodes(grid) + 1, &ghost, size - MpmGridNodes(grid) + 1, &owner));
  for (node[2] = box.lo[2]; node[2] < box.hi[2]; node[2]++)
    for (node[1] = box.lo[1]; node[1] < box.hi[1]; node[1]++)
      for (node[0] = box.lo[0]; node[0] < box.hi[0]; node[0]++) {
        if (!FindOwner(grid, node, &owner[n])) continue;
        ghost[n] = grid->origin;
        for (PetscInt a = 0; a < grid->dim; a++) ghost[n] += grid->axis[a].stride * node[a];
        n++;
      }
  PetscCall(PetscSFCreate(PetscObjectComm((PetscObject)grid->da), &grid->copies));
  PetscCall(PetscSFSetGraph(grid->copies, size, n, ghost, PETSC_COPY_VALUES, owner, PETSC_COPY_VALUES));
  PetscCall(PetscSFSetUp(grid->copies));
  PetscCall(PetscFree2(ghost, owner));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Gives a rank its share of the cells of a direction, and sets nodes[r], the nodes of the r-th rank. Between walls the
   last rank has more nodes than cells.
*/
static PetscErrorCode ShareAxis(const MpmDirection *direction, PetscInt ranks, const PetscInt starts[], PetscInt at,
                                MpmGridAxis *axis, PetscInt **nodes)
{
  PetscFunctionBegin;
  axis->cells    = direction->cells;
  axis->all      = direction->nodes;
  axis->periodic = direction->ends[0] == MPM_PERIODIC ? PETSC_TRUE : PETSC_FALSE;
  axis->ranks    = ranks;
  axis->at       = at;
  PetscCall(PetscMalloc1(ranks + 1, &axis->starts));
  PetscCall(PetscMalloc1(ranks, nodes));
  PetscCall(PetscArraycpy(axis->starts, starts, ranks + 1));
  for (PetscMPIInt r = 0; r < ranks; r++) (*nodes)[r] = NodesOf(axis, r);
  axis->first   = axis->starts[at];
  axis->count   = axis->starts[at + 1] - axis->first;
  axis->nodes   = (*nodes)[at];
  axis->wall[0] = !axis->periodic && at == 0 ? PETSC_TRUE : PETSC_FALSE;
  axis->wall[1] = !axis->periodic && at == ranks - 1 ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* DMDA numbers ranks as nodes, x fastest. */
static PetscErrorCode CreateDMDA(MPI_Comm comm, const MpmDirection direction[], const MpmPartition *partition,
                                 MpmGrid *g)
{
  const PetscInt *ranks = partition->ranks;
  PetscInt       *nodes[MPM_MAX_DIM], all[MPM_MAX_DIM], stride = 1, at;
  DMBoundaryType  kind[MPM_MAX_DIM];
  PetscMPIInt     rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  at = rank;
  for (PetscInt a = 0; a < g->dim; a++) {
    PetscCall(ShareAxis(&direction[a], ranks[a], partition->starts[a], at % ranks[a], &g->axis[a], &nodes[a]));
    at /= ranks[a];
    kind[a]           = g->axis[a].periodic ? DM_BOUNDARY_PERIODIC : DM_BOUNDARY_GHOSTED;
    all[a]            = direction[a].nodes;
    g->axis[a].stride = stride;
    g->origin += stride * g->ghost;
    stride *= g->axis[a].nodes + 2 * g->ghost;
  }
  if (g->dim == 1) PetscCall(DMDACreate1d(comm, kind[0], all[0], 1, g->ghost, nodes[0], &g->da));
  if (g->dim == 2)
    PetscCall(DMDACreate2d(comm, kind[0], kind[1], DMDA_STENCIL_BOX, all[0], all[1], ranks[0], ranks[1], 1, g->ghost,
                           nodes[0], nodes[1], &g->da));
  if (g->dim == 3)
    PetscCall(DMDACreate3d(comm, kind[0], kind[1], kind[2], DMDA_STENCIL_BOX, all[0], all[1], all[2], ranks[0],
                           ranks[1], ranks[2], 1, g->ghost, nodes[0], nodes[1], nodes[2], &g->da));
  PetscCall(DMSetUp(g->da));
  for (PetscInt a = 0; a < g->dim; a++) PetscCall(PetscFree(nodes[a]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridCreate(MPI_Comm comm, PetscInt dim, const MpmDirection direction[], const MpmPartition *partition,
                             PetscInt ghost, MpmGrid **grid)
{
  MpmGrid *g;

  PetscFunctionBegin;
  PetscCheck(partition->smallest > 0 && partition->smallest >= ghost, comm, PETSC_ERR_PLIB,
             "ghost layer wider than a rank's part");
  PetscCall(PetscNew(grid));
  g        = *grid;
  g->dim   = dim;
  g->ghost = ghost;
  PetscCall(CreateDMDA(comm, direction, partition, g));
  PetscCall(CreateForest(g));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridDestroy(MpmGrid **grid)
{
  PetscFunctionBegin;
  PetscCall(PetscSFDestroy(&(*grid)->copies));
  for (PetscInt a = 0; a < (*grid)->dim; a++) PetscCall(PetscFree((*grid)->axis[a].starts));
  PetscCall(DMDestroy(&(*grid)->da));
  PetscCall(PetscFree(*grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridGetArray(const MpmGrid *grid, Vec field, PetscReal **array)
{
  PetscFunctionBegin;
  PetscCall(VecGetArray(field, array));
  *array += grid->origin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridRestoreArray(const MpmGrid *grid, Vec field, PetscReal **array)
{
  PetscFunctionBegin;
  *array -= grid->origin;
  PetscCall(VecRestoreArray(field, array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridZero(const MpmGrid *grid, PetscReal array[])
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(array - grid->origin, MpmGridSize(grid)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridRefresh(const MpmGrid *grid, PetscInt n, PetscReal *const arrays[])
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < n; f++) {
    PetscReal *array = arrays[f] - grid->origin;

    PetscCall(PetscSFBcastBegin(grid->copies, MPIU_REAL, array, array, MPI_REPLACE));
  }
  for (PetscInt f = 0; f < n; f++) {
    PetscReal *array = arrays[f] - grid->origin;

    PetscCall(PetscSFBcastEnd(grid->copies, MPIU_REAL, array, array, MPI_REPLACE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridSum(const MpmGrid *grid, PetscInt n, PetscReal *const arrays[])
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < n; f++) {
    PetscReal *array = arrays[f] - grid->origin;

    PetscCall(PetscSFReduceBegin(grid->copies, MPIU_REAL, array, array, MPIU_SUM));
  }
  for (PetscInt f = 0; f < n; f++) {
    PetscReal *array = arrays[f] - grid->origin;

    PetscCall(PetscSFReduceEnd(grid->copies, MPIU_REAL, array, array, MPIU_SUM));
  }
  PetscCall(MpmGridRefresh(grid, n, arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmGridImages(const MpmGrid *grid, const MpmDirection direction[], const MpmParity parity[], PetscBool fold,
                   PetscReal array[])
{
  for (PetscInt axis = 0; axis < grid->dim; axis++) {
    const MpmGridAxis *a   = &grid->axis[axis];
    MpmGridBox         box = MpmGridBoxOf(grid, grid->ghost);
    PetscReal          sign[2];

    if (!a->wall[0] && !a->wall[1]) continue;
    MpmDirectionMirror(&direction[axis], parity[axis], sign);
    box.lo[axis] = 0;
    box.hi[axis] = 1;
    for (PetscInt r = 0; r < MpmGridRows(&box); r++)
      for (PetscInt i = box.lo[0]; i < box.hi[0]; i++)
        for (int end = 0; end < 2; end++) {
          const PetscInt inward = end ? -a->stride : a->stride, last = fold ? grid->ghost - 1 : grid->ghost;
          PetscReal     *wall = array + MpmGridRow(grid, &box, r) + i + (end ? (a->nodes - 1) * a->stride : 0);

          for (PetscInt g = 1; g <= last && a->wall[end]; g++)
            if (fold)
              wall[g * inward] += sign[end] * wall[-g * inward];
            else
              wall[-g * inward] = sign[end] * wall[g * inward];
        }
  }
}

PetscErrorCode MpmGridCopy(const MpmGrid *grid, PetscBool back, PetscInt stride, PetscReal own[], PetscReal array[])
{
  const MpmGridBox box = MpmGridBoxOf(grid, 0);

  PetscFunctionBegin;
  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    PetscReal *row = array + MpmGridRow(grid, &box, r);

    for (PetscInt i = 0; i < box.hi[0]; i++, own += stride)
      if (back)
        *own = row[i];
      else
        row[i] = *own;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscMPIInt MpmGridOwner(const MpmGrid *grid, const PetscInt cell[])
{
  PetscInt rank = 0, ranks = 1;

  for (PetscInt a = 0; a < grid->dim; a++) {
    const MpmGridAxis *axis = &grid->axis[a];
    PetscInt           r;

    /* Where the ranks have as many cells, this guess is off by one at most. */
    r = (PetscInt)((PetscInt64)cell[a] * axis->ranks / axis->cells);
    while (cell[a] < axis->starts[r]) r--;
    while (cell[a] >= axis->starts[r + 1]) r++;
    rank += ranks * r;
    ranks *= axis->ranks;
  }
  return (PetscMPIInt)rank;
}
