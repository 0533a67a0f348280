/* Kernels of finite deformation, on plain arrays of n particles. A tensor has dim rows of dim arrays. */
#pragma once
#include <mpmstab/boundary.h>

/*
   MpmStretch - F <- (I + L + twice L L) F.

   Not collective. Returns the first particle whose det F is then not positive and finite, or n.
*/
PetscInt MpmStretch(PetscInt dim, PetscInt n, PetscReal twice, PetscReal *const F[], const PetscReal *const L[]);

/* Not collective. det F of one particle, whose tensor is dim rows of dim numbers. */
PetscReal MpmDeterminant(PetscInt dim, const PetscReal F[]);

/*
   MpmAdvance - moves n particles along one direction by way[], in cells. The first cell of the direction is `first`
   cells to the left of cell 0.

   Not collective. range: the least and the largest cell, which it widens. Returns the first particle that would go a
   cell or further, or out of a direction that is not periodic, or n. Such a particle stays where it is.
*/
PetscInt MpmAdvance(const MpmDirection *direction, PetscInt first, PetscInt n, const PetscReal way[], PetscInt cell[],
                    PetscReal xi[], PetscInt range[2]);
