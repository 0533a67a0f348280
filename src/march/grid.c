/*
   Node fields in DMDA vectors. Halo sums use a star forest over the ghost nodes alone. DMLocalToGlobal with ADD_VALUES
   and back would copy every node twice, for a few that are shared.
*/
#include "march/grid.h"

static PetscErrorCode CreateHalo(MpmGrid *grid)
{
  PetscInt     n = 0;
  PetscInt    *leaves;
  PetscSFNode *roots;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(2 * grid->ghost, &leaves));
  PetscCall(PetscMalloc1(2 * grid->ghost, &roots));
  for (PetscInt g = 0; g < 2 * grid->ghost; g++) {
    const PetscInt local = g < grid->ghost ? g - grid->ghost : grid->nodes + g - grid->ghost;
    PetscInt       node  = grid->first + local;

    if (!grid->periodic && (node < 0 || node > grid->cells)) continue;
    if (grid->periodic) node = (node % grid->cells + grid->cells) % grid->cells;
    leaves[n]      = local + grid->ghost;
    roots[n].rank  = MpmGridOwner(grid, PetscMin(node, grid->cells - 1));
    roots[n].index = node - grid->starts[roots[n].rank] + grid->ghost;
    n++;
  }
  PetscCall(PetscSFCreate(PetscObjectComm((PetscObject)grid->da), &grid->halo));
  PetscCall(PetscSFSetGraph(grid->halo, grid->nodes + 2 * grid->ghost, n, leaves, PETSC_OWN_POINTER, roots,
                            PETSC_OWN_POINTER));
  PetscCall(PetscSFSetUp(grid->halo));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives a rank its share of the cells, as DMDA does. Between walls the last rank has one node more than cells. */
static PetscErrorCode CreateDMDA(MPI_Comm comm, MpmGrid *g)
{
  PetscMPIInt rank, size;
  PetscInt   *nodes;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc1(size + 1, &g->starts));
  PetscCall(PetscMalloc1(size, &nodes));
  for (PetscMPIInt r = 0; r <= size; r++) g->starts[r] = MpmGridFirst(g->cells, size, r);
  for (PetscMPIInt r = 0; r < size; r++) nodes[r] = MpmGridCount(g->cells, size, r);
  g->first = g->starts[rank];
  g->count = nodes[rank];
  if (!g->periodic) nodes[size - 1]++;
  g->nodes   = nodes[rank];
  g->wall[0] = !g->periodic && rank == 0 ? PETSC_TRUE : PETSC_FALSE;
  g->wall[1] = !g->periodic && rank == size - 1 ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(DMDACreate1d(comm, g->periodic ? DM_BOUNDARY_PERIODIC : DM_BOUNDARY_GHOSTED,
                         g->cells + (g->periodic ? 0 : 1), 1, g->ghost, nodes, &g->da));
  PetscCall(DMSetUp(g->da));
  PetscCall(PetscFree(nodes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridCreate(MPI_Comm comm, PetscInt cells, PetscInt ghost, PetscBool periodic, MpmGrid **grid)
{
  PetscMPIInt size;
  MpmGrid    *g;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCheck(MpmGridSmallestCount(cells, size) >= ghost, comm, PETSC_ERR_PLIB, "ghost layer wider than a rank's part");
  PetscCall(PetscNew(grid));
  g           = *grid;
  g->cells    = cells;
  g->ghost    = ghost;
  g->periodic = periodic;
  PetscCall(CreateDMDA(comm, g));
  PetscCall(CreateHalo(g));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridDestroy(MpmGrid **grid)
{
  PetscFunctionBegin;
  PetscCall(PetscSFDestroy(&(*grid)->halo));
  PetscCall(PetscFree((*grid)->starts));
  PetscCall(DMDestroy(&(*grid)->da));
  PetscCall(PetscFree(*grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridGetArray(const MpmGrid *grid, Vec field, PetscReal **array)
{
  PetscFunctionBegin;
  PetscCall(VecGetArray(field, array));
  *array += grid->ghost;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridRestoreArray(const MpmGrid *grid, Vec field, PetscReal **array)
{
  PetscFunctionBegin;
  *array -= grid->ghost;
  PetscCall(VecRestoreArray(field, array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridSum(const MpmGrid *grid, PetscInt n, PetscReal *const arrays[])
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < n; f++) {
    PetscReal *base = arrays[f] - grid->ghost;
    PetscCall(PetscSFReduceBegin(grid->halo, MPIU_REAL, base, base, MPI_SUM));
  }
  for (PetscInt f = 0; f < n; f++) {
    PetscReal *base = arrays[f] - grid->ghost;
    PetscCall(PetscSFReduceEnd(grid->halo, MPIU_REAL, base, base, MPI_SUM));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridSpread(const MpmGrid *grid, PetscInt n, PetscReal *const arrays[])
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < n; f++) {
    PetscReal *base = arrays[f] - grid->ghost;
    PetscCall(PetscSFBcastBegin(grid->halo, MPIU_REAL, base, base, MPI_REPLACE));
  }
  for (PetscInt f = 0; f < n; f++) {
    PetscReal *base = arrays[f] - grid->ghost;
    PetscCall(PetscSFBcastEnd(grid->halo, MPIU_REAL, base, base, MPI_REPLACE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmGridFold(const MpmGrid *grid, const PetscReal sign[2], PetscReal array[])
{
  PetscReal *right = array + grid->nodes - 1;

  for (PetscInt g = 1; g < grid->ghost; g++) {
    if (grid->wall[0]) array[g] += sign[0] * array[-g];
    if (grid->wall[1]) right[-g] += sign[1] * right[g];
  }
}

void MpmGridReflect(const MpmGrid *grid, const PetscReal sign[2], PetscReal array[])
{
  PetscReal *right = array + grid->nodes - 1;

  for (PetscInt g = 1; g <= grid->ghost; g++) {
    if (grid->wall[0]) array[-g] = sign[0] * array[g];
    if (grid->wall[1]) right[g] = sign[1] * right[-g];
  }
}

PetscMPIInt MpmGridOwner(const MpmGrid *grid, PetscInt cell)
{
  PetscMPIInt size, r;

  /* DMDA gives every rank cells / size, and the first ranks one more. So this guess is off by little. */
  (void)MPI_Comm_size(PetscObjectComm((PetscObject)grid->da), &size);
  r = (PetscMPIInt)((PetscInt64)cell * size / grid->cells);
  while (cell < grid->starts[r]) r--;
  while (cell >= grid->starts[r + 1]) r++;
  return r;
}
