/* Eigenvectors of a matrix whose nonzeros are near its diagonal, or near that of a ring, by inverse iteration. */
#pragma once
#include <mpmstab/compat.h>

/*S
   MpmBandVectors - the band of such a matrix, and work space.
S*/
typedef struct MpmBandVectors MpmBandVectors;

/*
   MpmBandVectorsCreate - keeps the band of a matrix, n x n by columns. band: NULL where it is so wide that LAPACK's
   vectors cost no more.

   Not collective.
*/
PetscErrorCode MpmBandVectorsCreate(PetscInt n, const PetscReal matrix[], MpmBandVectors **band);
PetscErrorCode MpmBandVectorsDestroy(MpmBandVectors **band);

/*
   MpmBandVectorsFind - a vector of norm 1 for each of the eigenvalues re + i im that LAPACK found.

   Not collective. vectors: room for n x n. Order of eigenvalues and columns is that of MpmDenseEigen.

   For LAPACK's vector x of the eigenvalue z let r = norm(A x - z x). Then A - z is at most r from a singular matrix, so
   the solution of (A - z) y = b has at least the norm abs(u^H b) / r, where u is a singular vector. For random b of norm
   1 this is about 1 / (r sqrt(n)), and y / norm(y) has the residual 1 / norm(y). So the vectors are good wherever
   LAPACK's are, near defective eigenvalues, too. Vectors of equal eigenvalues differ, since b differs.
*/
PetscErrorCode MpmBandVectorsFind(MpmBandVectors *band, const PetscReal re[], const PetscReal im[],
                                  PetscReal vectors[]);
