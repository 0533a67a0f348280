/* Grid: node fields in DMDA vectors, one node a cell, and the sum over ranks of what particles give to shared nodes. */
#pragma once
#include <mpmstab/compat.h>
#include <petscdmda.h>
#include <petscsf.h>

/*S
   MpmGrid - a grid of cells, periodic or between walls, distributed by DMDA.

   Local arrays have the owned nodes at indices [0, nodes), and ghosts at [-ghost, 0) and [nodes, nodes + ghost). Node i
   is the left end of cell i.

   cells  - the number of cells of the grid
   first  - the global index of local node 0
   count  - the number of cells of this rank
   nodes  - the number of nodes that this rank owns: those of its cells, and on the last rank also the wall at the right
   starts - starts[r]: the first cell of rank r
S*/
typedef struct {
  DM        da;
  PetscSF   halo; /* roots: owned nodes; leaves: ghost nodes; indices count from the beginning of the local array */
  PetscInt  cells, first, count, nodes, ghost;
  PetscBool wall[2]; /* this rank has the wall at the left, at the right */
  PetscBool periodic;
  PetscInt *starts;
} MpmGrid;

/*
   MpmGridCreate - distributes cells over the ranks of comm, with ghost nodes on either side.

   Collective. Every rank must get at least as many cells as ghost (see MpmGridSmallestCount).
*/
PetscErrorCode MpmGridCreate(MPI_Comm comm, PetscInt cells, PetscInt ghost, PetscBool periodic, MpmGrid **grid);
PetscErrorCode MpmGridDestroy(MpmGrid **grid);

/* Not collective. The smallest number of cells that one of size ranks gets. */
static inline PetscInt MpmGridSmallestCount(PetscInt cells, PetscMPIInt size)
{
  return cells / size;
}

/*
   Not collective. The number of cells that a rank of size ranks gets, and the first of them, as DMDA distributes them.
   The first cells % size ranks get one more than the others.
*/
static inline PetscInt MpmGridCount(PetscInt cells, PetscMPIInt size, PetscMPIInt rank)
{
  return cells / size + (cells % size > rank ? 1 : 0);
}
static inline PetscInt MpmGridFirst(PetscInt cells, PetscMPIInt size, PetscMPIInt rank)
{
  return cells / size * rank + PetscMin(rank, cells % size);
}

/* Not collective. The local array of a node field, indexed by local node, with its ghosts. */
PetscErrorCode MpmGridGetArray(const MpmGrid *grid, Vec field, PetscReal **array);
PetscErrorCode MpmGridRestoreArray(const MpmGrid *grid, Vec field, PetscReal **array);

/*
   Collective. For n local arrays, MpmGridSum adds ghosts to their owners, and MpmGridSpread copies owners to their
   ghosts. Both touch only shared nodes.
*/
PetscErrorCode MpmGridSum(const MpmGrid *grid, PetscInt n, PetscReal *const arrays[]);
PetscErrorCode MpmGridSpread(const MpmGrid *grid, PetscInt n, PetscReal *const arrays[]);

/*
   Not collective. Nodes beyond a wall are mirror images, sign[end] times those inside. MpmGridFold adds the sums at
   images, within ghost - 1 nodes of the wall, to the nodes that they are images of. MpmGridReflect sets the images.
*/
void MpmGridFold(const MpmGrid *grid, const PetscReal sign[2], PetscReal array[]);
void MpmGridReflect(const MpmGrid *grid, const PetscReal sign[2], PetscReal array[]);

/* Not collective. The rank that owns a cell in [0, cells). */
PetscMPIInt MpmGridOwner(const MpmGrid *grid, PetscInt cell);
