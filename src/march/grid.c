/* Node fields in DMDA vectors. */
#include "march/grid.h"
#include <stdlib.h>

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

/*
   All copies of a node along one axis, three at most: that of its owner and those that are ghosts of the ranks beside
   it. Returns their number, 0 for a node beyond a wall.
*/
#define MOST_ALONG 3
static PetscInt CopiesAlong(const MpmGridAxis *axis, PetscInt ghost, PetscInt local, PetscSFNode copy[])
{
  PetscInt owner, index, n = 0;

  if (!FindAlong(axis, local, &owner, &index)) return 0;
  copy[n++] = (PetscSFNode){owner, index};
  if (index < ghost && (axis->periodic || owner > 0)) {
    const PetscInt left = (owner + axis->ranks - 1) % axis->ranks;

    copy[n++] = (PetscSFNode){left, NodesOf(axis, left) + index};
  }
  if (index >= NodesOf(axis, owner) - ghost && (axis->periodic || owner < axis->ranks - 1))
    copy[n++] = (PetscSFNode){(owner + 1) % axis->ranks, index - NodesOf(axis, owner)};
  return n;
}

static int CompareCopies(const void *a, const void *b)
{
  const PetscSFNode *x = a, *y = b;

  if (x->rank != y->rank) return x->rank < y->rank ? -1 : 1;
  return (x->index > y->index) - (x->index < y->index);
}

#define MOST_COPIES 27

/* All copies of a local node, sorted, with their indices in local arrays. Returns their number. */
static PetscInt CopiesOf(const MpmGrid *grid, const PetscInt node[], PetscSFNode copy[])
{
  PetscInt n = 1, ranks = 1, stride[MOST_COPIES];

  copy[0]   = (PetscSFNode){0, 0};
  stride[0] = 1;
  for (PetscInt a = 0; a < grid->dim; a++) {
    const MpmGridAxis *axis = &grid->axis[a];
    PetscSFNode        along[MOST_ALONG];
    const PetscInt     nalong = CopiesAlong(axis, grid->ghost, node[a], along);

    for (PetscInt k = nalong - 1; k >= 0; k--) { /* the first n are read until they are written last */
      for (PetscInt c = 0; c < n; c++) {
        copy[k * n + c].rank  = copy[c].rank + ranks * along[k].rank;
        copy[k * n + c].index = copy[c].index + stride[c] * (along[k].index + grid->ghost);
        stride[k * n + c]     = stride[c] * (NodesOf(axis, along[k].rank) + 2 * grid->ghost);
      }
    }
    n *= nalong;
    ranks *= axis->ranks;
  }
  qsort(copy, n, sizeof *copy, CompareCopies);
  return n;
}

/* Whether a node may have several copies: in the middle of a rank's part it has one. */
static PetscBool NearEnd(const MpmGrid *grid, const PetscInt node[])
{
  for (PetscInt a = 0; a < grid->dim; a++)
    if (node[a] < grid->ghost || node[a] >= grid->axis[a].nodes - grid->ghost) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Whether a local index is that of the first copy on a rank. */
static PetscBool IsFirst(PetscMPIInt rank, PetscInt local, PetscInt n, const PetscSFNode copy[])
{
  PetscInt c = 0;

  while (c < n && copy[c].rank != rank) c++;
  return c < n && copy[c].index == local ? PETSC_TRUE : PETSC_FALSE;
}

/* Lists the nodes of this rank that have several copies. With all NULL it only counts them, and their copies. */
static void ListCopies(const MpmGrid *grid, PetscMPIInt rank, PetscInt count[2], PetscInt start[], PetscSFNode all[])
{
  const MpmGridBox box = MpmGridBoxOf(grid, grid->ghost);
  PetscInt         node[MPM_MAX_DIM];
  PetscSFNode      copy[MOST_COPIES];

  count[0] = count[1] = 0;
  for (node[2] = box.lo[2]; node[2] < box.hi[2]; node[2]++) {
    for (node[1] = box.lo[1]; node[1] < box.hi[1]; node[1]++) {
      for (node[0] = box.lo[0]; node[0] < box.hi[0]; node[0]++) {
        PetscInt local = grid->origin, n;

        if (!NearEnd(grid, node)) continue;
        for (PetscInt a = 0; a < grid->dim; a++) local += grid->axis[a].stride * node[a];
        n = CopiesOf(grid, node, copy);
        if (n < 2 || !IsFirst(rank, local, n, copy)) continue;
        if (all) {
          start[count[0]] = count[1];
          for (PetscInt c = 0; c < n; c++) all[count[1] + c] = copy[c];
        }
        count[0]++;
        count[1] += n;
      }
    }
  }
  if (all) start[count[0]] = count[1];
}

static PetscErrorCode CreateHalo(MpmGrid *grid)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)grid->da);
  PetscMPIInt    rank;
  PetscInt       count[2], *start;
  PetscSFNode   *all;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  ListCopies(grid, rank, count, NULL, NULL);
  PetscCall(PetscMalloc2(count[0] + 1, &start, count[1], &all));
  start[0] = 0;
  ListCopies(grid, rank, count, start, all);
  PetscCall(MpmHaloCreate(comm, MpmGridSize(grid), count[0], start, all, &grid->halo));
  PetscCall(PetscFree2(start, all));
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
  PetscCall(CreateHalo(g));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridDestroy(MpmGrid **grid)
{
  PetscFunctionBegin;
  PetscCall(MpmHaloDestroy(&(*grid)->halo));
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

PetscErrorCode MpmGridSum(const MpmGrid *grid, PetscInt n, PetscReal *const arrays[])
{
  PetscReal *base[MPM_HALO_FIELDS]; /* the arrays from their beginnings */

  PetscFunctionBegin;
  for (PetscInt f = 0; f < n; f++) base[f] = arrays[f] - grid->origin;
  PetscCall(MpmHaloSum(grid->halo, n, base));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nodes that lie in the planes across an axis, with all their ghosts. */
static MpmGridBox Across(const MpmGrid *grid, PetscInt axis)
{
  MpmGridBox box = MpmGridBoxOf(grid, grid->ghost);

  box.lo[axis] = 0;
  box.hi[axis] = 1;
  return box;
}

void MpmGridFold(const MpmGrid *grid, PetscInt axis, const PetscReal sign[2], PetscReal array[])
{
  const MpmGridAxis *a   = &grid->axis[axis];
  const MpmGridBox   box = Across(grid, axis);
  const PetscInt     s   = a->stride;

  if (!a->wall[0] && !a->wall[1]) return;
  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    for (PetscInt i = box.lo[0]; i < box.hi[0]; i++) {
      PetscReal *left = array + MpmGridRow(grid, &box, r) + i, *right = left + (a->nodes - 1) * s;

      for (PetscInt g = 1; g < grid->ghost; g++) {
        if (a->wall[0]) left[g * s] += sign[0] * left[-g * s];
        if (a->wall[1]) right[-g * s] += sign[1] * right[g * s];
      }
    }
  }
}

void MpmGridReflect(const MpmGrid *grid, PetscInt axis, const PetscReal sign[2], PetscReal array[])
{
  const MpmGridAxis *a   = &grid->axis[axis];
  const MpmGridBox   box = Across(grid, axis);
  const PetscInt     s   = a->stride;

  if (!a->wall[0] && !a->wall[1]) return;
  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    for (PetscInt i = box.lo[0]; i < box.hi[0]; i++) {
      PetscReal *left = array + MpmGridRow(grid, &box, r) + i, *right = left + (a->nodes - 1) * s;

      for (PetscInt g = 1; g <= grid->ghost; g++) {
        if (a->wall[0]) left[-g * s] = sign[0] * left[g * s];
        if (a->wall[1]) right[g * s] = sign[1] * right[-g * s];
      }
    }
  }
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
