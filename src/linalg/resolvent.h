/* The resolvent of a matrix: sigma(z), the smallest singular value of z - A, at any number of points z. */
#pragma once
#include <mpmstab/compat.h>
#include <complex.h>
#include <petscmat.h>

/* Order up to which it is taken: a dense complex matrix, and work of its cube. */
#define MPM_RESOLVENT_ORDER 1024

/*S
   MpmResolvent - a complex Schur form of A, and room to solve with z - A.

   eigenvalue are its diagonal's. factor is minus its upper triangle, whose diagonal each point sets.
S*/
typedef struct {
  PetscInt        n;
  double complex *factor, *eigenvalue;
  double complex *basis, *coefficient; /* Lanczos vectors, n x (n + 1) */
  PetscReal      *diagonal, *beside, *vectors, *room;
} MpmResolvent;

/* Collective. A must be finite; the Schur form is rank 0's, so that all ranks have the same. */
PetscErrorCode MpmResolventCreate(Mat A, MpmResolvent *resolvent);
PetscErrorCode MpmResolventDestroy(MpmResolvent *resolvent);

/*
   MpmResolventSigma - the smallest singular value of z - A; 0 where that is below the range of its inverse square.

   Not collective. Relative error 1e-10, beside rounding of A, which moves it by about eps norm(A).
*/
PetscErrorCode MpmResolventSigma(MpmResolvent *resolvent, double complex z, PetscReal *sigma);
