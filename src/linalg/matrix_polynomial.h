/* Small dense polynomials of complex matrices, C_0 + x C_1 + x^2 C_2 + ... */
#pragma once
#include <mpmstab/compat.h>
#include <complex.h>

/*
   MpmPolynomialSingular - the least x > 0 at which a polynomial of matrices is singular. C_0 must not be.

   Not collective.

   Input Parameters:
+  n, degree   - the order of the matrices, and the degree
-  coefficient - coefficient[j]: n x n by columns

   Output Parameter: x - infinite where there is none; NaN: LAPACK did not converge

   The coefficients but the first may have few rows or few columns that are not 0. With C_j = E R_j, E some columns of
   the identity, the polynomial is singular where I + x R_1 C_0^-1 E + ... is, which is smaller.
*/
PetscErrorCode MpmPolynomialSingular(PetscInt n, PetscInt degree, double complex *const coefficient[], PetscReal *x);

/*
   Not collective. The largest abs of the eigenvalues of a matrix, n x n by columns, which is overwritten. Infinite: a
   number is. NaN: LAPACK did not converge.
*/
PetscErrorCode MpmPolynomialRadius(PetscInt n, double complex matrix[], PetscReal *radius);
