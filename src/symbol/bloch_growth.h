/* The growth of one Bloch mode, which every search over phases and Courant numbers asks for. */
#pragma once
#include "linalg/small_eigen.h"
#include "symbol/bloch.h"

/*
   MpmBlochGrowths - the growth per step of a phase at n Courant numbers: the largest abs of the amplification factors of
   the nodal operator and of the null space of P2G, where that is known, and else of a turn; and growth without the null
   space, NaN where it is not known.

   Not collective. eigen has the order bloch->turn_size and is overwritten.
*/
PetscErrorCode MpmBlochGrowths(MpmBloch *bloch, MpmSmallEigen *eigen, PetscInt n, const PetscReal courant[],
                               const PetscReal beta[], PetscReal growth[], PetscReal without_null[]);
