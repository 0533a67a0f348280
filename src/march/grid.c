/*
   Node fields in DMDA vectors, and sums over the copies of nodes that ranks share.

   The sums are made by a star forest over the shared nodes. Each rank sends the sums of its copies to all ranks that
   have the node too, and each of them adds up. So there is one message to a neighbour, where a sum at the owner and its
   way back to the ghosts would take two, one after the other. DMLocalToGlobal with ADD_VALUES and back would also copy
   every node twice, for a few that are shared, and send a message for each field.
*/
#include "march/grid.h"
#include <mpmstab/table.h>
#include <petscsf.h>
#include <stdlib.h>

#define HALO_FIELDS (MPM_MAX_FIELDS + 1) /* the most fields at once: those of a table, and the masses */

/*
   MpmHalo_ - the nodes of a rank that have several copies, as own nodes and ghosts of this and other ranks.

   nnodes             - the number of these nodes
   copy, copy_node    - indices in a local array of this rank's copies of them, and the nodes' numbers; ncopies of them
   other_node         - of the nodes of other ranks that are the same, nothers in all: the number here. The first nlower
                        are those of lower ranks. Those of a node are in the order of ranks
   sf                 - roots are a rank's nodes, leaves the same nodes of other ranks. On one rank there is none
   unit               - unit[n]: n numbers side by side, made when it is first needed, or MPI_DATATYPE_NULL
   own, others, total - sums over a rank's copies, here and on other ranks, and over all copies: all fields at a node
                        side by side; there is room for so many fields (room)
*/
struct MpmHalo_ {
  PetscSF      sf;
  PetscInt     nnodes, ncopies, nlower, nothers, *copy, *copy_node, *other_node, room;
  MPI_Datatype unit[HALO_FIELDS + 1];
  PetscReal   *own, *others, *total;
};

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

/* ---- the halo ---- */

/*
   Lists this rank's copies of n nodes: node i has the copies start[i] to start[i + 1] of all, sorted by rank and index.
*/
static void ListOwn(PetscMPIInt rank, PetscInt n, const PetscInt start[], const PetscSFNode all[], MpmHalo *h)
{
  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt c = start[i]; c < start[i + 1]; c++) {
      if (all[c].rank != rank) continue;
      h->copy[h->ncopies]        = all[c].index;
      h->copy_node[h->ncopies++] = i;
    }
  }
}

/* Lists the first copy on each lower or each higher rank. */
static void ListOthers(PetscMPIInt rank, PetscBool lower, PetscInt n, const PetscInt start[], const PetscSFNode all[],
                       MpmHalo *h, PetscSFNode others[])
{
  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt c = start[i]; c < start[i + 1]; c++) {
      if (lower ? all[c].rank >= rank : all[c].rank <= rank) continue;
      if (c > start[i] && all[c].rank == all[c - 1].rank) continue;
      others[h->nothers]          = all[c];
      h->other_node[h->nothers++] = i;
    }
  }
}

/* Connects the nodes of this rank with those of others, which are given by their first copy there. */
static PetscErrorCode Connect(MPI_Comm comm, PetscInt size, MpmHalo *h, PetscSFNode others[])
{
  const PetscInt nothers = h->nothers;
  PetscInt      *number, *found;
  PetscSF        every; /* with all nodes of a local array as roots */

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(size, &number, nothers, &found));
  for (PetscInt c = 0; c < h->ncopies; c++) number[h->copy[c]] = h->copy_node[c];
  PetscCall(PetscSFCreate(comm, &every));
  PetscCall(PetscSFSetGraph(every, size, nothers, NULL, PETSC_COPY_VALUES, others, PETSC_COPY_VALUES));
  PetscCall(PetscSFBcastBegin(every, MPIU_INT, number, found, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(every, MPIU_INT, number, found, MPI_REPLACE));
  PetscCall(PetscSFDestroy(&every));
  for (PetscInt l = 0; l < nothers; l++) others[l].index = found[l];
  PetscCall(PetscFree2(number, found));
  PetscCall(PetscSFCreate(comm, &h->sf));
  PetscCall(PetscSFSetGraph(h->sf, h->nnodes, nothers, NULL, PETSC_COPY_VALUES, others, PETSC_COPY_VALUES));
  PetscCall(PetscSFSetUp(h->sf));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* size: that of a local array. */
static PetscErrorCode CreateHaloOf(MPI_Comm comm, PetscInt size, PetscInt n, const PetscInt start[],
                                   const PetscSFNode all[], MpmHalo **halo)
{
  PetscMPIInt  rank, ranks;
  PetscSFNode *others;
  MpmHalo     *h;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCall(PetscNew(halo));
  h         = *halo;
  h->nnodes = n;
  for (PetscInt f = 0; f <= HALO_FIELDS; f++) h->unit[f] = MPI_DATATYPE_NULL;
  PetscCall(PetscMalloc3(start[n], &h->copy, start[n], &h->copy_node, start[n], &h->other_node));
  PetscCall(PetscMalloc1(start[n], &others));
  ListOwn(rank, n, start, all, h);
  ListOthers(rank, PETSC_TRUE, n, start, all, h, others);
  h->nlower = h->nothers;
  ListOthers(rank, PETSC_FALSE, n, start, all, h, others);
  if (ranks > 1) PetscCall(Connect(comm, size, h, others));
  PetscCall(PetscFree(others));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyHalo(MpmHalo **halo)
{
  MpmHalo *h = *halo;

  PetscFunctionBegin;
  PetscCall(PetscSFDestroy(&h->sf));
  for (PetscInt f = 0; f <= HALO_FIELDS; f++)
    if (h->unit[f] != MPI_DATATYPE_NULL) PetscCallMPI(MPI_Type_free(&h->unit[f]));
  PetscCall(PetscFree3(h->own, h->others, h->total));
  PetscCall(PetscFree3(h->copy, h->copy_node, h->other_node));
  PetscCall(PetscFree(*halo));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes room for n fields. */
static PetscErrorCode MakeRoom(MpmHalo *h, PetscInt n)
{
  PetscFunctionBegin;
  PetscCheck(n <= HALO_FIELDS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "more fields than the halo has room for");
  if (n <= h->room) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree3(h->own, h->others, h->total));
  PetscCall(PetscMalloc3(n * h->nnodes, &h->own, n * h->nothers, &h->others, h->sf ? n * h->nnodes : 0, &h->total));
  h->room = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The type of a node's values. */
static PetscErrorCode GetUnit(MpmHalo *h, PetscInt n, MPI_Datatype *unit)
{
  PetscFunctionBegin;
  if (h->unit[n] == MPI_DATATYPE_NULL) {
    PetscCallMPI(MPI_Type_contiguous((PetscMPIInt)n, MPIU_REAL, &h->unit[n]));
    PetscCallMPI(MPI_Type_commit(&h->unit[n]));
  }
  *unit = h->unit[n];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the sums of other ranks, n numbers each. */
static void AddOthers(const MpmHalo *h, PetscInt n, PetscInt begin, PetscInt end)
{
  for (PetscInt l = begin; l < end; l++)
    for (PetscInt f = 0; f < n; f++) h->total[n * h->other_node[l] + f] += h->others[n * l + f];
}

/* Exchanges the sums of ranks, and adds all in the order of ranks. */
static PetscErrorCode AddUp(MpmHalo *h, PetscInt n)
{
  MPI_Datatype unit;

  PetscFunctionBegin;
  PetscCall(GetUnit(h, n, &unit));
  PetscCall(PetscSFBcastBegin(h->sf, unit, h->own, h->others, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(h->sf, unit, h->own, h->others, MPI_REPLACE));
  PetscCall(PetscArrayzero(h->total, n * h->nnodes));
  AddOthers(h, n, 0, h->nlower);
  for (PetscInt i = 0; i < n * h->nnodes; i++) h->total[i] += h->own[i];
  AddOthers(h, n, h->nlower, h->nothers);
  PetscFunctionReturn(PETSC_SUCCESS);
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
  PetscCall(CreateHaloOf(comm, MpmGridSize(grid), count[0], start, all, &grid->halo));
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
  PetscCall(DestroyHalo(&(*grid)->halo));
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
  MpmHalo *h = grid->halo;

  PetscFunctionBegin;
  if (n == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MakeRoom(h, n));
  PetscCall(PetscArrayzero(h->own, n * h->nnodes));
  for (PetscInt f = 0; f < n; f++) {
    PetscReal *restrict own         = h->own + f;
    const PetscReal *restrict array = arrays[f] - grid->origin;

    for (PetscInt c = 0; c < h->ncopies; c++) own[n * h->copy_node[c]] += array[h->copy[c]];
  }
  if (h->sf) PetscCall(AddUp(h, n));
  for (PetscInt f = 0; f < n; f++) {
    const PetscReal *restrict sum = (h->sf ? h->total : h->own) + f;
    PetscReal *restrict array     = arrays[f] - grid->origin;

    for (PetscInt c = 0; c < h->ncopies; c++) array[h->copy[c]] = sum[n * h->copy_node[c]];
  }
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
  if (!back) PetscCall(MpmGridZero(grid, array));
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
