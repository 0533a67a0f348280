/*
   The maps on plain arrays: no PETSc objects, no allocation, no switch inside a loop over particles.
*/
#pragma once
#include <mpmstab/basis.h>

/*
   MpmBlockPlace - fills in a block of n <= MPM_BLOCK particles, of which cell[p] are the local indices of their cells.

   Not collective. xi[] must stay while the block is used.
*/
void MpmBlockPlace(const MpmBasis *basis, PetscInt n, const PetscInt cell[], const PetscReal xi[], PetscReal half_width,
                   MpmBlock *block);

/* particle[] *= a. */
void MpmScale(PetscInt n, PetscReal a, PetscReal particle[]);

/*
   MpmPlaceBlock - where particles are: their resting place (cell0, xi0) moved on by whole cells and part in
   [0,1).

   cell = floor, so that a particle on a node belongs to the cell at its right. Sums within 2^-52 of 1 are on
   the node: xi0 and part are each rounded once, and rounding must not decide on which side of a node 3/4 +
   1/4 is.
*/
void MpmPlaceBlock(PetscInt n, const PetscInt cell0[], const PetscReal xi0[], PetscInt whole, PetscReal part,
                   PetscInt cell[], PetscReal xi[]);

/* Returns the sum of squares of q[0..n). */
PetscReal MpmSumSquares(PetscInt n, const PetscReal q[]);

/* out[i] = a (f[i+1] - 2 f[i] + f[i-1]) for i in [lo, hi), and the same added to out[i]. */
void MpmNodeLaplacian(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal f[], PetscReal out[]);
void MpmNodeAddLaplacian(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal f[], PetscReal out[]);

/* out[i] += a f[i], and out[i] = a f[i], for i in [lo, hi). */
void MpmNodeAdd(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal f[], PetscReal out[]);
void MpmNodeCopy(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal f[], PetscReal out[]);
