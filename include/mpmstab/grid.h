/* Grid: nodes in DMDA vectors, one per cell, and the sum over ranks of what particles gave to shared nodes. */
#pragma once
#include <mpmstab/compat.h>
#include <petscdmda.h>
#include <petscsf.h>

/*S
   MpmGrid - a periodic grid of cells, distributed by DMDA.

   Local arrays have the owned nodes at indices [0, count) and ghosts at [-ghost, 0) and [count, count +
   ghost); node i is at the left of cell i, first is the global index of local node 0. starts[r] is the first
   node of rank r.
S*/
typedef struct {
  DM        da;
  PetscSF   halo; /* roots: owned nodes; leaves: ghost nodes; both index the local array from its beginning */
  PetscInt  cells, first, count, ghost;
  PetscInt *starts;
} MpmGrid;

/*
   MpmGridCreate - distributes cells over the ranks of comm with ghost nodes to either side.

   Collective. Needs at least ghost cells on every rank; MpmGridSmallestCount says how many there are.
*/
PetscErrorCode MpmGridCreate(MPI_Comm comm, PetscInt cells, PetscInt ghost, MpmGrid **grid);
PetscErrorCode MpmGridDestroy(MpmGrid **grid);

/* Not collective. Fewest cells that any of size ranks gets. */
static inline PetscInt MpmGridSmallestCount(PetscInt cells, PetscMPIInt size)
{
  return cells / size;
}

/* Not collective. A node field's local array, indexed by local node, ghosts included. */
PetscErrorCode MpmGridGetArray(const MpmGrid *grid, Vec field, PetscReal **array);
PetscErrorCode MpmGridRestoreArray(const MpmGrid *grid, Vec field, PetscReal **array);

/*
   Collective. In n local arrays, MpmGridSum adds ghosts to their owners; MpmGridSpread copies owners to their
   ghosts. Only shared nodes are touched.
*/
PetscErrorCode MpmGridSum(const MpmGrid *grid, PetscInt n, PetscReal *const arrays[]);
PetscErrorCode MpmGridSpread(const MpmGrid *grid, PetscInt n, PetscReal *const arrays[]);

/* Not collective. The rank that owns a cell in [0, cells). */
PetscMPIInt MpmGridOwner(const MpmGrid *grid, PetscInt cell);
