/* Maps: what the operations of a step multiply by, as sparse matrices, for particles at their places at one step. */
#pragma once
#include "program/slab.h"
#include "scheme/maps.h"
#include <petscmat.h>

#define MPM_PARITIES (MPM_MAX_DIM + 2)

/*S
   MpmMaps - the maps of a step, by kind, by axes and by the parity of the node register. Each is made when it is first
   asked for, once for all operations that use it. It starts with slab and step alone; MpmMapsDestroy destroys the rest.

   masses - the nodal masses, or NULL
S*/
typedef struct {
  const MpmSlab *slab;
  PetscInt64     step;
  Vec            masses;
  Mat            map[MPM_OP_KINDS][MPM_AXES][MPM_PARITIES];
} MpmMaps;

/*
   MpmMapsGet - the matrix of an operation that is a map.

   From nodes to particles it is particles x nodes. From particles to nodes it is nodes x particles, divided by the
   nodal
   masses; rows of nodes without mass are 0. A stencil is nodes x nodes, and SOLVE is (W^T m W)^+ M: W is G2P without
   the wall nodes that impose 0, m are the masses of the particles and M those of the nodes.

   Collective. SOLVE takes all eigenvalues of W^T m W, and refuses grids too large for that.
*/
PetscErrorCode MpmMapsGet(MpmMaps *maps, const MpmOp *op, Mat *map);

/* Collective. A copy of the matrix of P2G of a field that is even at walls, which the caller destroys. */
PetscErrorCode MpmMapsEven(const MpmSlab *slab, PetscInt64 step, Mat *map);

/* Collective. A new matrix nodes x nodes that is 1 for the nodes on one wall, and has no other entries. */
PetscErrorCode MpmWallSelection(const MpmSlab *slab, PetscInt axis, PetscInt side, Mat *map);

/* Collective. The numbers in the maps that were made, on all ranks. */
PetscErrorCode MpmMapsCount(const MpmMaps *maps, PetscReal *numbers);
PetscErrorCode MpmMapsDestroy(MpmMaps *maps);

/*
   Not collective. A number less than MPM_PARITIES for parities that mirror a node field alike. 0: even; 1 + a: the
   component of a vector along axis a; the last: a number that is imposed on walls.
*/
PetscInt MpmParityClass(const MpmLayout *layout, const MpmParity parity[]);

/*
   MpmNodeWeights - the nodes that a particle in a cell has weights at, and these weights: products of row[a][.] over
   the directions a, as MpmMapRow numbers them. drop is that of MpmNodesSeen. Returns how many there are:
   MpmNodeWeightsMost.

   MpmNodeWeightsMatrix - a matrix with memory for them, particles x nodes.

   Not collective; MpmNodeWeightsMatrix is.
*/
PetscInt MpmNodeWeights(const MpmSlab *slab, PetscReal row[][MPM_MAX_REACH], const MpmParity parity[], PetscBool drop,
                        const PetscInt cell[], PetscInt column[], PetscReal weight[]);
PetscInt MpmNodeWeightsMost(const MpmSlab *slab);
PetscErrorCode MpmNodeWeightsMatrix(const MpmSlab *slab, Mat *matrix);
