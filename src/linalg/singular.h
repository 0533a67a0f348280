/*
   Singular values: the largest of a matrix that has products and transposed products, and the smallest of z - A at any
   number of points z.
*/
#pragma once
#include <mpmstab/compat.h>
#include <complex.h>
#include <petscmat.h>

/*
   MpmSingularLargest - finds the largest singular value by SLEPc's thick-restart Lanczos bidiagonalization (Hernandez,
   Roman and Tomas 2008).

   Collective on PETSC_COMM_WORLD. start: a vector with components in every direction. basis: the most vectors of the
   Krylov space, which is begun again when it is full. tolerance: of the relative residual; the error is about its
   square over the gap. sigma: NaN when the solver does not converge.
*/
PetscErrorCode MpmSingularLargest(Mat matrix, Vec start, PetscInt basis, PetscReal tolerance, PetscReal *sigma);

/* Collective. Refuses options -svd_* that SLEPc refuses, before the work. */
PetscErrorCode MpmSingularTryOptions(void);

/* Collective. Fills a start vector with components in every direction, the same on any number of ranks. */
PetscErrorCode MpmSingularStart(PetscInt64 seed, Vec start);

/*
   MpmNormBelow - the infinity norm from below: the largest number that a matrix makes of a few vectors of ones with
   random signs. It is NaN where one of them is.

   Collective. For operators that have products alone: it may be their MATOP_NORM, and refuses other norms.
*/
PetscErrorCode MpmNormBelow(Mat matrix, NormType type, PetscReal *norm);

/* ---- the resolvent of a matrix: sigma(z), the smallest singular value of z - A ---- */

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
