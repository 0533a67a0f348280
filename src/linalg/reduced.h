/*
   A smaller matrix that has the eigenvalues of a large one, but for numbers that are known. Of a matrix A with

     A = C + B Z,   Z C = C' Z,   C and C' diagonal,

   the small one is M = C' + Z B. It has Z A = M Z, and the eigenvalues of A and C' together are those of M and C
   together, multiplicities included, since

     det(x - A) det(x - C') = det(x - M) det(x - C).

   An eigenvector z of M for a value that C does not have is lifted to (value - C)^-1 B z, an eigenvector of A. A left
   one is lifted by Z^T. What Z does not see A multiplies by C.
*/
#pragma once
#include <mpmstab/compat.h>
#include <petscmat.h>

#define MPM_REDUCED_KEPT 8 /* the most different numbers in C */

/*S
   MpmReduced - the smaller matrix of a matrix A.

   M, B, Z  - as above. M is AIJ; B and Z have products with vectors and their transposes
   kept, kept_small - the diagonals of C and C'
   nkept, number, count, count_small - the different numbers in C and C', and how often C and C' have each
   mismatch - see MpmReducedCheck
S*/
typedef struct {
  Mat       M, B, Z;
  Vec       kept, kept_small;
  PetscInt  nkept, count[MPM_REDUCED_KEPT], count_small[MPM_REDUCED_KEPT];
  PetscReal number[MPM_REDUCED_KEPT], mismatch;
} MpmReduced;

PetscErrorCode MpmReducedDestroy(MpmReduced **reduced);

/*
   MpmReducedCheck - the largest relative difference of A q from C q + B Z q and of M z from C' z + Z B z, of a few
   random vectors q and z. All that is said above follows from these two.

   Collective. The result is kept in mismatch.
*/
PetscErrorCode MpmReducedCheck(Mat A, MpmReduced *reduced);

#define MPM_REDUCED_AGREES 1e-11 /* with a larger mismatch the smaller matrix may not be used */

/*
   MpmReducedUnseen - a random vector of norm 1 that Z does not see and that A multiplies by number k, found by least
   squares (LSQR, Paige and Saunders 1982).

   Collective. seed: another one gives another vector.
*/
PetscErrorCode MpmReducedUnseen(const MpmReduced *reduced, PetscInt k, PetscInt seed, Vec q);

/*
   MpmReducedKept - the number of C that an eigenvalue of M is equal to but for rounding, or -1. Such pairs may be
   defective in M and not in A. Rounding splits them by about the square root of norm(M) x 1e-16.

   Not collective. norm: that of M.
*/
PetscInt MpmReducedKept(const MpmReduced *reduced, PetscReal norm, PetscReal re, PetscReal im);

/*
   MpmReducedLargest - the eigenvalue of A of largest abs (real and imaginary part), found among all of M and C by
                       LAPACK.

   Collective. The real part is infinite when M is not finite, and NaN when LAPACK did not converge.
*/
PetscErrorCode MpmReducedLargest(const MpmReduced *reduced, PetscReal value[2]);

/*
   Powers of A. Z A = M Z, and so

     A^n = C^n + sum over j < n of C^(n-1-j) B M^j Z

   With D_c, which selects the rows in which C has the number c, this takes n products with M and one with B for each of
   the few different numbers:

     A^n x = sum over c of D_c (c^n x + B y_c(n)),   y_c(j+1) = c y_c(j) + z(j),   z(j+1) = M z(j),
     y_c(0) = 0,   z(0) = Z x
*/

/*S
   MpmReducedPowers - powers of W A W^-1 applied to vectors, W diagonal.

   weights - the diagonal of W; NULL: W is 1
   z, sum  - z(j) and the y_c(j) of the smaller matrix
   work    - vectors of A
S*/
typedef struct {
  const MpmReduced *reduced;
  Vec               weights, z[2], sum[MPM_REDUCED_KEPT], work[2];
} MpmReducedPowers;

/* Collective. reduced and weights must outlive it. */
PetscErrorCode MpmReducedPowersCreate(const MpmReduced *reduced, Vec weights, MpmReducedPowers *powers);
PetscErrorCode MpmReducedPowersDestroy(MpmReducedPowers *powers);

/*
   MpmReducedPowersMult - y = W A^n W^-1 x, or with transpose its transpose applied to x, over 2 to the power of the sum
   of the first n numbers of shift.

   Collective. After step j everything is divided by 2^shift[j], so that nothing leaves the range of doubles on the way.
*/
PetscErrorCode MpmReducedPowersMult(const MpmReducedPowers *powers, PetscInt n, const PetscInt shift[],
                                    PetscBool transpose, Vec x, Vec y);
