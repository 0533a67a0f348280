/* The nodes that ranks share, and the sums of node fields over their copies: one message to a neighbour for all fields. */
#pragma once
#include <mpmstab/table.h>
#include <petscsf.h>

#define MPM_HALO_FIELDS (MPM_MAX_FIELDS + 1) /* the most fields at once: those of a table, and the masses */

/*S
   MpmHalo - the nodes of a rank that have several copies, as own nodes and ghosts of this and other ranks.

   nnodes             - the number of these nodes
   copy, copy_node    - indices in a local array of this rank's copies of them, and the nodes' numbers; ncopies of them
   other_node         - of the nodes of other ranks that are the same, nothers in all: the number here. The first nlower
                        are those of lower ranks. Those of a node are in the order of ranks
   sf                 - roots are a rank's nodes, leaves the same nodes of other ranks. On one rank there is none
   unit               - unit[n]: n numbers side by side, made when it is first needed, or MPI_DATATYPE_NULL
   own, others, total - sums over a rank's copies, here and on other ranks, and over all copies: all fields at a node side
                        by side; there is room for so many fields (room)
S*/
typedef struct {
  PetscSF      sf;
  PetscInt     nnodes, ncopies, nlower, nothers, *copy, *copy_node, *other_node, room;
  MPI_Datatype unit[MPM_HALO_FIELDS + 1];
  PetscReal   *own, *others, *total;
} MpmHalo;

/*
   MpmHaloCreate - finds what ranks share. Node i of n has the copies start[i] to start[i + 1] of all, sorted by rank and
   index, at least one of them on this rank. size: that of a local array.

   Collective.
*/
PetscErrorCode MpmHaloCreate(MPI_Comm comm, PetscInt size, PetscInt n, const PetscInt start[], const PetscSFNode all[],
                             MpmHalo **halo);
PetscErrorCode MpmHaloDestroy(MpmHalo **halo);

/*
   MpmHaloSum - sets all copies of a node to their sum, in n local arrays. The sums of a rank's copies are added in the order
   of ranks, so all ranks get the same numbers.

   Collective.
*/
PetscErrorCode MpmHaloSum(MpmHalo *halo, PetscInt n, PetscReal *const arrays[]);
