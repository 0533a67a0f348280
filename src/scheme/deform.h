/* Kernels of finite deformation, on plain arrays of n particles. A tensor has dim rows of dim arrays. */
#pragma once
#include <mpmstab/boundary.h>
#include <mpmstab/material.h>

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

/*
   MpmStressAhead - the stress T at a part a of a step with the slopes L, brought back to its start, and
   MpmStressAheadTangent, its differential along dL and dF (NULL: 0).

   Not collective. Returns the first particle whose volume there is not positive and finite, which gets the stress at F,
   or n.
*/
PetscInt MpmStressAhead(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, PetscReal a,
                        const PetscReal *const L[], const PetscReal *const F[], PetscReal *const T[]);
void     MpmStressAheadTangent(const MpmMaterialNumbers *material, PetscInt dim, PetscInt n, PetscReal a,
                               const PetscReal *const L[], const PetscReal *const F[], const PetscReal *const dL[],
                               const PetscReal *const dF[], PetscReal *const dT[]);
