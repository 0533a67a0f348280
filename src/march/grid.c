/* Node fields in DMDA vectors. */
#include "march/grid.h"

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

/* The owner of a local node, and its index in the owner's local array. Returns false for a node beyond a wall. */
static PetscBool FindRoot(const MpmGrid *grid, const PetscInt node[], PetscSFNode *root)
{
  PetscInt rank = 0, ranks = 1, index = 0, stride = 1;

  for (PetscInt a = 0; a < grid->dim; a++) {
    const MpmGridAxis *axis = &grid->axis[a];
    PetscInt           r, i;

    if (!FindAlong(axis, node[a], &r, &i)) return PETSC_FALSE;
    rank += ranks * r;
    index += stride * (i + grid->ghost);
    ranks *= axis->ranks;
    stride *= NodesOf(axis, r) + 2 * grid->ghost;
  }
  root->rank  = rank;
  root->index = index;
  return PETSC_TRUE;
}

static PetscErrorCode CreateHalo(MpmGrid *grid)
{
  const MpmGridBox box = MpmGridBoxOf(grid, grid->ghost);
  const PetscInt   all = grid->axis[grid->dim - 1].stride * (grid->axis[grid->dim - 1].nodes + 2 * grid->ghost);
  PetscInt         n   = 0, node[MPM_MAX_DIM];
  PetscInt        *leaves;
  PetscSFNode     *roots;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(all - MpmGridNodes(grid), &leaves));
  PetscCall(PetscMalloc1(all - MpmGridNodes(grid), &roots));
  for (node[2] = box.lo[2]; node[2] < box.hi[2]; node[2]++) {
    for (node[1] = box.lo[1]; node[1] < box.hi[1]; node[1]++) {
      for (node[0] = box.lo[0]; node[0] < box.hi[0]; node[0]++) {
        PetscInt  local = grid->origin;
        PetscBool own   = PETSC_TRUE;

        for (PetscInt a = 0; a < grid->dim; a++) {
          local += grid->axis[a].stride * node[a];
          if (node[a] < 0 || node[a] >= grid->axis[a].nodes) own = PETSC_FALSE;
        }
        if (own || !FindRoot(grid, node, &roots[n])) continue;
        leaves[n++] = local;
      }
    }
  }
  PetscCall(MpmHaloCreate(PetscObjectComm((PetscObject)grid->da), all, n, leaves, roots, &grid->halo));
  PetscCall(PetscFree(leaves));
  PetscCall(PetscFree(roots));
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

/* The arrays from their beginnings. */
static void Bases(const MpmGrid *grid, PetscInt n, PetscReal *const arrays[], PetscReal *base[])
{
  for (PetscInt f = 0; f < n; f++) base[f] = arrays[f] - grid->origin;
}

PetscErrorCode MpmGridSum(const MpmGrid *grid, PetscInt n, PetscReal *const arrays[])
{
  PetscReal *base[MPM_HALO_FIELDS];

  PetscFunctionBegin;
  Bases(grid, n, arrays, base);
  PetscCall(MpmHaloSum(grid->halo, n, base));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridSpread(const MpmGrid *grid, PetscInt n, PetscReal *const arrays[])
{
  PetscReal *base[MPM_HALO_FIELDS];

  PetscFunctionBegin;
  Bases(grid, n, arrays, base);
  PetscCall(MpmHaloSpread(grid->halo, n, base));
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
