/*
   The maps on plain arrays: no PETSc objects, no allocation, no switch inside a loop over particles.
*/
#pragma once
#include <mpmstab/compat.h>

#define MPM_BLOCK 256 /* particles that go through a pass together, at most */

/*S
   MpmBlock - where a block of particles is: what kernels need to know of them besides the data.

   Particles come in the order of their cells for speed (any order is correct). xi[p] in [0,1) is a particle's place in
   its cell, first[p] the local index of the first node that it sees; half_width is half of a particle's width, in cells, for
   bases that have one. Particles [begin, end) come in runs of length: those of a run see the same nodes, those of the
   next run the nodes one further on. begin = end = n: nothing of the kind.
S*/
typedef struct {
  PetscInt         n, begin, end, length, first[MPM_BLOCK];
  const PetscReal *xi;
  PetscReal        half_width;
} MpmBlock;

/*
   Every map between particles and nodes has this shape:

     P2G         node[]     += a sum over particles of phi_ip particle[p]
     P2G_AFFINE  node[]     += a sum over particles of phi_ip particle[p] (x_i - x_p) / h
     DIV         node[]     += a h sum over particles of dphi_ip/dx particle[p]
     G2P         particle[] += a sum_i phi_ip node[i]
     G2P_AFFINE  particle[] += a sum_i phi_ip node[i] (x_i - x_p) h / sum_i phi_ip (x_i - x_p)^2
     GRAD        particle[] += a h sum_i dphi_ip/dx node[i]

   What goes to nodes is not yet divided by mass. Node i is at the left of cell i. All arrays are distinct.
*/
typedef void (*MpmKernel)(const MpmBlock *block, PetscReal a, PetscReal particle[], PetscReal node[]);

/* P2G and the nodal masses in one go, for particles that have moved: mass[] += sum over particles of phi_ip. */
typedef void (*MpmMassKernel)(const MpmBlock *block, const PetscReal particle[], PetscReal node[], PetscReal mass[]);

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

/* out[i] = a (f[i+1] - 2 f[i] + f[i-1]) for i in [lo, hi). */
void MpmNodeLaplacian(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal f[], PetscReal out[]);

/* out[i] += a f[i], and out[i] = a f[i], for i in [lo, hi). */
void MpmNodeAdd(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal f[], PetscReal out[]);
void MpmNodeCopy(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal f[], PetscReal out[]);
