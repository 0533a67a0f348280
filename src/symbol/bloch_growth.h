/* The growth of one Bloch mode, which every search over phases and Courant numbers asks for. */
#pragma once
#include "linalg/small_eigen.h"
#include "symbol/bloch.h"

/*
   MpmBlochGrowth - the growth per step of a phase at a Courant number: the largest abs of the amplification factors of a
   turn.

   Not collective. eigen has the order bloch->size and is overwritten.
*/
PetscErrorCode MpmBlochGrowth(MpmBloch *bloch, MpmSmallEigen *eigen, PetscReal courant, const PetscReal beta[],
                              PetscReal *growth);
