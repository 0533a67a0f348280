/* Grid: nodes in DMDA vectors, one per cell, and the sum over ranks of what particles gave to shared nodes. */
#pragma once
#include <mpmstab/compat.h>
#include <petscdmda.h>
#include <petscsf.h>

/*S
   MpmGrid - a grid of cells, periodic or between walls, distributed by DMDA.

   Local arrays have the owned nodes at indices [0, nodes) and ghosts at [-ghost, 0) and [nodes, nodes + ghost); node i
   is at the left of cell i, first is the global index of local node 0. A rank owns the nodes of its count cells, the
   last one also the wall at the right. starts[r] is the first cell of rank r.
S*/
typedef struct {
  DM        da;
  PetscSF   halo; /* roots: owned nodes; leaves: ghost nodes; both index the local array from its beginning */
  PetscInt  cells, first, count, nodes, ghost;
  PetscBool wall[2]; /* whether this rank has the wall at the left, at the right */
  PetscBool periodic;
  PetscInt *starts;
} MpmGrid;

/*
   MpmGridCreate - distributes cells over the ranks of comm with ghost nodes to either side.

   Collective. Needs at least ghost cells on every rank; MpmGridSmallestCount says how many there are.
*/
PetscErrorCode MpmGridCreate(MPI_Comm comm, PetscInt cells, PetscInt ghost, PetscBool periodic, MpmGrid **grid);
PetscErrorCode MpmGridDestroy(MpmGrid **grid);

/* Not collective. Fewest cells that any of size ranks gets. */
static inline PetscInt MpmGridSmallestCount(PetscInt cells, PetscMPIInt size)
{
  return cells / size;
}

/*
   Not collective. Which cells a rank of size ranks gets, as DMDA deals them: the number of them, one more for the first
   cells % size ranks than for the others, and the first of them.
*/
static inline PetscInt MpmGridCount(PetscInt cells, PetscMPIInt size, PetscMPIInt rank)
{
  return cells / size + (cells % size > rank ? 1 : 0);
}
static inline PetscInt MpmGridFirst(PetscInt cells, PetscMPIInt size, PetscMPIInt rank)
{
  return cells / size * rank + PetscMin(rank, cells % size);
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

/*
   Not collective. Nodes beyond a wall are mirror images, sign[end] times those inside. MpmGridFold gives what particles
   have summed to them (within ghost - 1 nodes of the wall) to those they stand for; MpmGridReflect sets them.
*/
void MpmGridFold(const MpmGrid *grid, const PetscReal sign[2], PetscReal array[]);
void MpmGridReflect(const MpmGrid *grid, const PetscReal sign[2], PetscReal array[]);

/* Not collective. The rank that owns a cell in [0, cells). */
PetscMPIInt MpmGridOwner(const MpmGrid *grid, PetscInt cell);
