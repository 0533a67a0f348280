/*
   Powers of a matrix A = C + B Z by its smaller matrix M = C' + Z B (linalg/reduced.h). Z A = M Z, and so

     A^n = C^n + sum over j < n of C^(n-1-j) B M^j Z

   With D_c, which selects the rows in which C has the number c, this takes n products with M and one with B for each of
   the few different numbers:

     A^n x = sum over c of D_c (c^n x + B y_c(n)),   y_c(j+1) = c y_c(j) + z(j),   z(j+1) = M z(j),
     y_c(0) = 0,   z(0) = Z x
*/
#pragma once
#include "linalg/reduced.h"

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
   MpmReducedPowersMult - y = W A^n W^-1 x, or with transpose its transpose applied to x, over 2 to the power of the sum of the
   first n numbers of shift.

   Collective. After step j everything is divided by 2^shift[j], so that nothing leaves the range of doubles on the way.
*/
PetscErrorCode MpmReducedPowersMult(const MpmReducedPowers *powers, PetscInt n, const PetscInt shift[],
                                    PetscBool transpose, Vec x, Vec y);
