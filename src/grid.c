/*
   Nodes in DMDA vectors. Halo sums go through a star forest over the ghost nodes alone: DMLocalToGlobal with
   ADD_VALUES and back would copy every node twice, for a handful that are shared.
*/
#include <mpmstab/grid.h>

static PetscErrorCode CreateHalo(MpmGrid *grid)
{
  const PetscInt n = 2 * grid->ghost;
  PetscInt      *leaves;
  PetscSFNode   *roots;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &leaves));
  PetscCall(PetscMalloc1(n, &roots));
  for (PetscInt g = 0; g < n; g++) {
    const PetscInt local = g < grid->ghost ? g - grid->ghost : grid->count + g - grid->ghost;
    const PetscInt cell  = ((grid->first + local) % grid->cells + grid->cells) % grid->cells;

    leaves[g]      = local + grid->ghost;
    roots[g].rank  = MpmGridOwner(grid, cell);
    roots[g].index = cell - grid->starts[roots[g].rank] + grid->ghost;
  }
  PetscCall(PetscSFCreate(PetscObjectComm((PetscObject)grid->da), &grid->halo));
  PetscCall(PetscSFSetGraph(grid->halo, grid->count + n, n, leaves, PETSC_OWN_POINTER, roots, PETSC_OWN_POINTER));
  PetscCall(PetscSFSetUp(grid->halo));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmGridCreate(MPI_Comm comm, PetscInt cells, PetscInt ghost, MpmGrid **grid)
{
  const PetscInt *counts;
  PetscMPIInt     size;
  MpmGrid        *g;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCheck(MpmGridSmallestCount(cells, size) >= ghost, comm, PETSC_ERR_PLIB, "ghost layer wider than a rank's part");
  PetscCall(PetscNew(grid));
  g        = *grid;
  g->cells = cells;
  g->ghost = ghost;
  PetscCall(DMDACreate1d(comm, DM_BOUNDARY_PERIODIC, cells, 1, ghost, NULL, &g->da));
  PetscCall(DMSetUp(g->da));
  PetscCall(DMDAGetCorners(g->da, &g->first, NULL, NULL, &g->count, NULL, NULL));
  PetscCall(DMDAGetOwnershipRanges(g->da, &counts, NULL, NULL));
  PetscCall(PetscMalloc1(size + 1, &g->starts));
  g->starts[0] = 0;
  for (PetscMPIInt r = 0; r < size; r++) g->starts[r + 1] = g->starts[r] + counts[r];
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

PetscMPIInt MpmGridOwner(const MpmGrid *grid, PetscInt cell)
{
  PetscMPIInt size, r;

  /* DMDA gives every rank cells/size, and one more to the first ones: this guess is off by little */
  (void)MPI_Comm_size(PetscObjectComm((PetscObject)grid->da), &size);
  r = (PetscMPIInt)((PetscInt64)cell * size / grid->cells);
  while (cell < grid->starts[r]) r--;
  while (cell >= grid->starts[r + 1]) r++;
  return r;
}
