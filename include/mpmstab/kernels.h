/*
   The maps on plain arrays: no PETSc objects, no allocation, no switch inside a loop over particles.

   Particles come in blocks of n, in the order of their cells for speed (any order is correct). cell[p] is the
   local index of the particle's cell, xi[p] in [0,1) its place in the cell; node[i] is the node at the left
   of cell i. All arrays are distinct.
*/
#pragma once
#include <mpmstab/compat.h>

/*
   Every map between particles and nodes has this shape:

     P2G    node[]     += sum over particles of phi_ip particle[p]    (a is not used; not yet divided by mass)
     G2P    particle[] += a sum_i phi_ip node[i]
     GRAD   particle[] += a h sum_i dphi_ip/dx node[i]
*/
typedef void (*MpmKernel)(PetscInt n, const PetscInt cell[], const PetscReal xi[], PetscReal a, PetscReal particle[],
                          PetscReal node[]);

/* P2G and the nodal masses in one go, for particles that have moved: mass[] += sum over particles of phi_ip. */
typedef void (*MpmMassKernel)(PetscInt n, const PetscInt cell[], const PetscReal xi[], const PetscReal particle[],
                              PetscReal node[], PetscReal mass[]);

void MpmHatP2G(PetscInt n, const PetscInt cell[], const PetscReal xi[], PetscReal a, PetscReal particle[],
               PetscReal node[]);
void MpmHatP2GMass(PetscInt n, const PetscInt cell[], const PetscReal xi[], const PetscReal particle[],
                   PetscReal node[], PetscReal mass[]);
void MpmHatG2P(PetscInt n, const PetscInt cell[], const PetscReal xi[], PetscReal a, PetscReal particle[],
               PetscReal node[]);
void MpmHatGrad(PetscInt n, const PetscInt cell[], const PetscReal xi[], PetscReal a, PetscReal particle[],
                PetscReal node[]);

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

/* out[i] += f[i] for i in [lo, hi). */
void MpmNodeAdd(PetscInt lo, PetscInt hi, const PetscReal f[], PetscReal out[]);
