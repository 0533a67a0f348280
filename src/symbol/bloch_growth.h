/* The growth of one Bloch mode, which every search over phases and Courant numbers asks for. */
#pragma once
#include "linalg/small_eigen.h"
#include "symbol/bloch.h"

/*
   MpmBlochGrowth - the growth per step of a phase at a Courant number: the largest abs of the amplification factors of the
   nodal operator and of the null space of P2G, where that is known, and else of a turn.

   MpmBlochGrowths - that at n Courant numbers, and growth without the null space; NaN where it is not known.

   Not collective. eigen has the order bloch->turn_size and is overwritten.
*/
PetscErrorCode MpmBlochGrowth(MpmBloch *bloch, MpmSmallEigen *eigen, PetscReal courant, const PetscReal beta[],
                              PetscReal *growth);
PetscErrorCode MpmBlochGrowths(MpmBloch *bloch, MpmSmallEigen *eigen, PetscInt n, const PetscReal courant[],
                               const PetscReal beta[], PetscReal growth[], PetscReal without_null[]);
