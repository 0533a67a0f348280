/* Partition: which cells each rank has. In each direction the ranks along it have ranges of cells, as in DMDA. */
#pragma once
#include <mpmstab/layout.h>

/*S
   MpmPartition - the ranges of cells of the ranks.

   ranks    - the number of ranks along each direction, x fastest; all 0 where there is no way
   starts   - starts[a][r]: the first cell of the r-th rank along direction a; starts[a][ranks[a]] is the number of
              cells
   smallest - the number of cells in the shortest range of all directions
   load     - the largest number of particles that a rank has, over the mean; particles count where they rest without
              jitter
S*/
typedef struct {
  PetscInt  ranks[MPM_MAX_DIM], *starts[MPM_MAX_DIM], smallest;
  PetscReal load;
} MpmPartition;

/*
   MpmPartitionCreate - shares the cells among size ranks, such that every range has at least least cells.

   Equal ranges are shared for the fewest ghosts. Ranges of equal load are those with the smallest maximum of particles
   over the ranks (where none would be shorter than least cells; else near to it): the particles of a layout are a
   product of those of its directions, so each direction is cut for itself by the numbers of particles in its planes of
   cells. Of the ways to write size as a product (or the one that the layout asks for) the one with the least load is
   taken, and among those the one with the fewest ghosts.

   Not collective.

   Input Parameters: drifts - particles move through the grid. MPM_BALANCE_AUTO then shares equal ranges, because the
   load of others lasts for a few steps only; where particles rest it does so up to a load of MPM_BALANCE_BOUND.
*/
PetscErrorCode MpmPartitionCreate(const MpmLayout *layout, PetscMPIInt size, PetscInt least, PetscBool drifts,
                                  MpmPartition *partition);
PetscErrorCode MpmPartitionDestroy(MpmPartition *partition);

#define MPM_BALANCE_BOUND 1.25
