/*
   Kernels on plain arrays, for particles and for nodes. They use no PETSc objects, allocate nothing, and have no switch
   inside a loop over particles.
*/
#pragma once
#include <mpmstab/basis.h>

/*
   MpmBlockPlace - fills in a block of n <= MPM_BLOCK particles at the places xi[] of their cells. cell[p] is the local
   index of particle p's cell, and wall those of the first and last node (MpmDirectionWalls).

   Not collective. The block refers to xi[], which must stay while the block is used.
*/
void MpmBlockPlace(const MpmBasis *basis, PetscInt n, const PetscInt cell[], const PetscReal xi[], PetscReal half_width,
                   const PetscInt wall[2], MpmBlock *block);

/*
   A map along one direction with weights as MpmWeights sets them. MpmWeightsGather adds a times the sums over a
   particle's nodes to particle[]; MpmWeightsSpread adds what particles give to node[].

   Not collective.
*/
void MpmWeightsGather(const MpmBlock *block, PetscInt nodes, PetscInt stride, const PetscReal weight[], PetscReal a,
                      PetscReal particle[], const PetscReal node[]);
void MpmWeightsSpread(const MpmBlock *block, PetscInt nodes, PetscInt stride, const PetscReal weight[], PetscReal a,
                      const PetscReal particle[], PetscReal node[]);

/* Multiplies particle[] by a. For a = 0 the result is 0 whatever particle[] held. */
void MpmScale(PetscInt n, PetscReal a, PetscReal particle[]);

/*
   MpmPlaceBlock - moves n particles from their resting places (cell0, xi0) on by whole cells and part in [0,1) of a
   cell. The new places are (cell, xi).

   cell is a floor, so that a particle on a node belongs to the cell to the right of it. xi0 and part are each rounded
   once, and rounding must not decide on which side of a node 3/4 + 1/4 is. So sums xi0 + part within 2^-52 of 1 are on
   the node.
*/
void MpmPlaceBlock(PetscInt n, const PetscInt cell0[], const PetscReal xi0[], PetscInt whole, PetscReal part,
                   PetscInt cell[], PetscReal xi[]);

/* Returns the sum of squares of q[0..n). */
PetscReal MpmSumSquares(PetscInt n, const PetscReal q[]);

/* For i in [lo, hi), MpmNodeAdd adds a f[i] to out[i], and MpmNodeCopy sets out[i] = a f[i]. */
void MpmNodeAdd(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal f[], PetscReal out[]);
void MpmNodeCopy(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal f[], PetscReal out[]);
