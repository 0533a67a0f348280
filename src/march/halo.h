/* The nodes that ranks share, and the sums and copies of node fields between them: one message for all fields. */
#pragma once
#include <mpmstab/table.h>
#include <petscsf.h>

#define MPM_HALO_FIELDS (MPM_MAX_FIELDS + 1) /* the most fields at once: those of a table, and the masses */

/*S
   MpmHalo - the shared nodes of a rank.

   near[0], near[1] - indices in a local array of ghosts that stand for own nodes, as in a periodic direction with one
                      rank, and of these nodes; nnear of them
   sf               - of the others: roots are owned nodes that are ghosts on another rank, leaves ghosts; both are
                      numbered from 0. On one rank there is none
   root, leaf       - their indices in a local array, nroots and nleaves of them
   unit             - unit[n]: n numbers side by side, made when it is first needed, or MPI_DATATYPE_NULL
   roots, leaves    - the values of all fields at a node side by side; there is room for so many fields (room)
S*/
typedef struct {
  PetscSF      sf;
  PetscInt     nnear, nroots, nleaves, *near[2], *root, *leaf, room;
  MPI_Datatype unit[MPM_HALO_FIELDS + 1];
  PetscReal   *roots, *leaves;
} MpmHalo;

/*
   MpmHaloCreate - finds the shared nodes from this rank's ghosts and their owners. all: the size of a local array.

   Collective.
*/
PetscErrorCode MpmHaloCreate(MPI_Comm comm, PetscInt all, PetscInt n, const PetscInt ghost[], const PetscSFNode owner[],
                             MpmHalo **halo);
PetscErrorCode MpmHaloDestroy(MpmHalo **halo);

/* Collective. For n local arrays: MpmHaloSum adds ghosts to their owners, and MpmHaloSpread copies owners to ghosts. */
PetscErrorCode MpmHaloSum(MpmHalo *halo, PetscInt n, PetscReal *const arrays[]);
PetscErrorCode MpmHaloSpread(MpmHalo *halo, PetscInt n, PetscReal *const arrays[]);
