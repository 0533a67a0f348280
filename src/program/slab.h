/* Slab: which particles and nodes of a layout a rank has, as rows of matrices and vectors. */
#pragma once
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>

/*S
   MpmSlab - the rows of a rank.

   first, cells     - of the last direction, the first cell of this rank and their number: a rank has a slab of the
   grid.
                      In one dimension the march gives a rank the same cells.
   node0            - the number of this rank's first node. Node (i, j, k) has the number i + nodes_x (j + nodes_y k).
   nodes, particles, state - the numbers of nodes, particles and unknowns of this rank
   begin            - the id of this rank's first particle
   fields           - the number of fields of the state
S*/
typedef struct {
  MPI_Comm         comm;
  const MpmLayout *layout;
  const MpmScheme *scheme;
  MpmStep          step;
  PetscInt         first, cells, node0, nodes, begin, particles, state, fields;
} MpmSlab;

/* Collective. layout and scheme must outlive the slab, which holds no memory. */
PetscErrorCode MpmSlabOf(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                         MpmSlab *slab);

/*
   Not collective. The index of a node along an axis. stride: the distance of neighbours along it in the numbering of
   nodes.
*/
PetscInt MpmNodeAlong(const MpmLayout *layout, PetscInt node, PetscInt axis, PetscInt *stride);
