/* Grid: node fields in DMDA vectors, one node a cell, and the sum over ranks of what particles give to shared nodes. */
#pragma once
#include "march/partition.h"
#include <mpmstab/layout.h>
#include <petscdmda.h>

typedef struct MpmHalo_ MpmHalo; /* the nodes that ranks share */

/*S
   MpmGridAxis - one direction of a grid, and the part of it that this rank has. Node i is the left end of cell i.

   cells  - the number of cells of the grid
   all    - the number of its nodes
   first  - the global index of local node 0
   count  - the number of cells of this rank
   nodes  - the number of nodes that this rank owns: those of its cells, and on the last rank also those beyond them
   starts - starts[r]: the first cell of the r-th of the ranks along this direction
   ranks, at - the number of ranks along this direction, and which of them this rank is
   stride - the distance of neighbours along this direction in a local array
S*/
typedef struct {
  PetscInt  cells, all, first, count, nodes, stride;
  PetscInt *starts, ranks, at;
  PetscBool wall[2]; /* this rank has the wall at the left, at the right */
  PetscBool periodic;
} MpmGridAxis;

/*S
   MpmGrid - a grid of cells, in each direction periodic or between walls, distributed by DMDA.

   In each direction a rank owns the nodes [0, nodes), and has ghosts at [-ghost, 0) and [nodes, nodes + ghost). A local
   array holds all of these, x fastest. It is indexed from its node 0.

   dim    - the number of directions
   origin - the index of node 0, counted from the beginning of a local array
S*/
typedef struct {
  DM          da;
  MpmHalo    *halo; /* its indices count from the beginning of a local array */
  PetscInt    dim, ghost, origin;
  MpmGridAxis axis[MPM_MAX_DIM];
} MpmGrid;

/*
   MpmGridCreate - distributes cells over the ranks of comm, with ghost nodes on either side.

   Collective. Every rank must get at least as many cells as ghost in each direction.
*/
PetscErrorCode MpmGridCreate(MPI_Comm comm, PetscInt dim, const MpmDirection direction[], const MpmPartition *partition,
                             PetscInt ghost, MpmGrid **grid);
PetscErrorCode MpmGridDestroy(MpmGrid **grid);

/* Not collective. The number of nodes that this rank owns, and of all nodes of the grid. */
static inline PetscInt MpmGridNodes(const MpmGrid *grid)
{
  PetscInt nodes = 1;

  for (PetscInt a = 0; a < grid->dim; a++) nodes *= grid->axis[a].nodes;
  return nodes;
}

/* Not collective. The number of nodes of a local array, with its ghosts. */
static inline PetscInt MpmGridSize(const MpmGrid *grid)
{
  const MpmGridAxis *last = &grid->axis[grid->dim - 1];

  return last->stride * (last->nodes + 2 * grid->ghost);
}

/* Not collective. The local array of a node field, indexed by local node, with its ghosts. */
PetscErrorCode MpmGridGetArray(const MpmGrid *grid, Vec field, PetscReal **array);
PetscErrorCode MpmGridRestoreArray(const MpmGrid *grid, Vec field, PetscReal **array);

/* Not collective. Sets a local array to 0, with its ghosts. */
PetscErrorCode MpmGridZero(const MpmGrid *grid, PetscReal array[]);

/*
   Collective. For n local arrays, MpmGridSum sets each node, with its ghosts on all ranks, to the sum of what it and
   these ghosts have. It sends one message to a neighbour for all arrays.
*/
PetscErrorCode MpmGridSum(const MpmGrid *grid, PetscInt n, PetscReal *const arrays[]);

/*
   Not collective. Nodes beyond a wall are mirror images, with a sign that follows from the parity along the direction.
   With fold the sums at images, within ghost - 1 nodes of the wall, are added to the nodes that they are images of.
   Else the images are set. One direction comes after the other, each on all nodes and ghosts of the others, which does
   what is right at corners.
*/
void MpmGridImages(const MpmGrid *grid, const MpmDirection direction[], const MpmParity parity[], PetscBool fold,
                   PetscReal array[]);

/*
   Not collective. Copies own[stride n], of the n-th node that this rank owns, to a local array whose ghosts become 0,
   so that a sum over the copies is the owner's number; or back.
*/
PetscErrorCode MpmGridCopy(const MpmGrid *grid, PetscBool back, PetscInt stride, PetscReal own[], PetscReal array[]);

/* Not collective. The rank that owns a cell, which has an index in [0, cells) in each direction. */
PetscMPIInt MpmGridOwner(const MpmGrid *grid, const PetscInt cell[]);

/*S
   MpmGridBox - the nodes [lo, hi) of each direction, as rows along the first: how to go through a part of a local
                array.
S*/
typedef struct {
  PetscInt lo[MPM_MAX_DIM], hi[MPM_MAX_DIM];
} MpmGridBox;

/* Not collective. The nodes that a rank owns, and beyond further ones in each direction. */
static inline MpmGridBox MpmGridBoxOf(const MpmGrid *grid, PetscInt beyond)
{
  MpmGridBox box = {.hi = {1, 1, 1}};

  for (PetscInt a = 0; a < grid->dim; a++) {
    box.lo[a] = -beyond;
    box.hi[a] = grid->axis[a].nodes + beyond;
  }
  return box;
}

/* Not collective. The number of rows of a box, and the index of the node at which row r would have its node 0. */
static inline PetscInt MpmGridRows(const MpmGridBox *box)
{
  return (box->hi[1] - box->lo[1]) * (box->hi[2] - box->lo[2]);
}
static inline PetscInt MpmGridRow(const MpmGrid *grid, const MpmGridBox *box, PetscInt r)
{
  const PetscInt ny = box->hi[1] - box->lo[1];

  return (box->lo[1] + r % ny) * grid->axis[1].stride + (box->lo[2] + r / ny) * grid->axis[2].stride;
}
