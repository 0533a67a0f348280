/* The resolvent of a matrix: sigma(z), the smallest singular value of z - A, at any number of points z. */
#pragma once
#include <mpmstab/compat.h>
#include <complex.h>
#include <petscmat.h>

/* The largest order for which it is computed; it takes a dense complex matrix, and work like the cube of the order. */
#define MPM_RESOLVENT_ORDER 1024

/*S
   MpmResolvent - a complex Schur form of A, and work space to solve with z - A.

   eigenvalue is the diagonal of the Schur form. factor is the negative of its upper triangle; each point z sets the
   diagonal.
S*/
typedef struct {
  PetscInt        n;
  double complex *factor, *eigenvalue;
  double complex *basis, *coefficient; /* Lanczos vectors, n x (n + 1) */
  PetscReal      *diagonal, *beside, *vectors, *room;
} MpmResolvent;

/* Collective. A must be finite. All ranks get the Schur form of rank 0, so that they have the same numbers. */
PetscErrorCode MpmResolventCreate(Mat A, MpmResolvent *resolvent);
PetscErrorCode MpmResolventDestroy(MpmResolvent *resolvent);

/*
   MpmResolventSigma - the smallest singular value of z - A. It is 0 where its inverse square leaves the range of
   doubles.

   Not collective. The relative error is 1e-10. Rounding of A moves sigma by about eps norm(A) besides.
*/
PetscErrorCode MpmResolventSigma(MpmResolvent *resolvent, double complex z, PetscReal *sigma);
