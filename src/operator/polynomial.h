/* The operator as a function of the Courant number: each step's matrix is a polynomial, made once for many numbers. */
#pragma once
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>

/*S
   MpmPolynomial - the operator of a period, A(k) = A_(period-1)(k) ... A_0(k), at any Courant number k.

   An operation is multiplied with a factor times a power of k, so that A_t(k) = sum_j C_tj k^j. coefficients holds the
   C_tj, matrices of order x order by columns, numbered t (degree + 1) + j. They are in the variables of the operator's
   balanced. scale: the Courant number at which the first power of k counts as much as what is without k, about the
   least over the particles of h / (wave speed) in units of the reference's. step, product and next are room.
S*/
typedef struct {
  PetscInt   order, period, degree;
  PetscReal  scale;
  PetscReal *coefficients, *step, *product, *next;
} MpmPolynomial;

/*
   MpmPolynomialCreate - the coefficients of a scheme's operator on a layout, with the drift of step.

   Not collective: the calling rank holds everything. Takes about as long as MpmOperatorCreate on one rank.
*/
PetscErrorCode MpmPolynomialCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                   MpmPolynomial *polynomial);
PetscErrorCode MpmPolynomialDestroy(MpmPolynomial *polynomial);

/*
   MpmPolynomialMatrix - the operator at a Courant number, order x order by columns, divided by 2^exponent.

   Not collective.
*/
PetscErrorCode MpmPolynomialMatrix(MpmPolynomial *polynomial, PetscReal courant, PetscReal matrix[],
                                   PetscInt *exponent);
