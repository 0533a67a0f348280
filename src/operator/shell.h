/* The operator without its matrix: a table applied to vectors, by the sparse maps of its steps. */
#pragma once
#include "operator/assemble.h"

/*
   MpmShellCreate - a MATSHELL whose product with a state is what the steps first .. first + steps - 1 make of it. It can
   be transposed, and MatDiagonalScale scales it.

   Collective. The rows are those of MpmRegistersGather. layout and scheme must outlive it. It holds the maps of every
   step, and MatGetInfo counts their numbers.

   Its infinity norm is a lower bound: the largest number that it makes of a few vectors of ones with random signs.
*/
PetscErrorCode MpmShellCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                              PetscInt first, PetscInt steps, Mat *shell);

/*
   Collective. The norm of a matrix that has products alone: a lower bound of its infinity norm, the largest number that it
   makes of a few vectors of ones with random signs. Other norms are not known.
*/
PetscErrorCode MpmShellNorm(Mat shell, NormType type, PetscReal *norm);

/* Collective. A second shell with the same maps, which may be scaled by itself. */
PetscErrorCode MpmShellCopy(Mat shell, Mat *copy);

/* Not collective. An upper bound of the numbers in the maps of one step, over all ranks. */
PetscReal MpmShellNonzeros(const MpmLayout *layout, const MpmScheme *scheme);
