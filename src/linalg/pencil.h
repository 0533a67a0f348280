/* A matrix that is linear in a number: where it first has the eigenvalue -1. */
#pragma once
#include <mpmstab/compat.h>
#include <petscmat.h>

/*
   MpmPencilLeast - the least x > 0 at which C_0 + x C_1 has the eigenvalue -1; infinite: there is none. NaN: C_0 itself has it,
   or LAPACK failed.

   Not collective. C_0, C_1: n x n by columns; C_0 is overwritten. -1 / x is an eigenvalue of (C_0 + 1)^-1 C_1. With E_R the
   unit vectors of the rows R that are not 0 in C_1, the eigenvalues of this matrix that are not 0 are those of
   C_1[R, :] (C_0 + 1)^-1 E_R, which is smaller: half of the rows of a nodal operator are its stresses, and nodes without
   mass have none.
*/
PetscErrorCode MpmPencilLeast(PetscInt n, PetscReal C0[], const PetscReal C1[], PetscReal *x);

/*
   MpmPencilLeastKrylov - the same of sparse matrices, by a Krylov space. NaN: the solver found no eigenvalue.

   Collective. C_0 is overwritten by C_0 + 1, whose systems GMRES solves: C_0 is what a transfer keeps of nodal velocities, with
   eigenvalues from 0 to 1.
*/
PetscErrorCode MpmPencilLeastKrylov(Mat C0, Mat C1, PetscReal *x);
