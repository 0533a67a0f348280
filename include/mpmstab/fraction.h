/* Exact fractions: drifts and offsets whose positions repeat, and ties at nodes, must not depend on rounding. */
#pragma once
#include <mpmstab/compat.h>

/*S
   MpmFraction - a number that is a ratio of integers where its text says so ('1/8', '0.3'), else a double.

   den is 0 when the number has no short exact form; value is always the nearest double.
S*/
typedef struct {
  PetscInt64 num, den;
  PetscReal  value;
} MpmFraction;

/* Not collective. Reads '3', '-1/8', '0.25' or '1e-9'; *ok says whether the whole text is a finite number. */
PetscErrorCode MpmFractionParse(const char text[], MpmFraction *fraction, PetscBool *ok);

/*
   Not collective. Point j of n equally spaced ones, n > 1, from one fraction to another: exact where its terms are
   short.
*/
MpmFraction MpmFractionBetween(const MpmFraction *from, const MpmFraction *to, PetscInt j, PetscInt n);

/*
   MpmFractionMultiple - n times a fraction, as whole + part with part in [0,1).

   Not collective. Exact up to the final rounding of part for ratios; for doubles the product is formed
   without rounding (an fma), so that nothing accumulates over steps.
*/
void MpmFractionMultiple(const MpmFraction *fraction, PetscInt64 n, PetscInt64 *whole, PetscReal *part);

/*
   MpmFractionProduct - the product of n fractions, exact where its terms are short.

   Not collective. A factor with den 0 is no ratio, and then neither is the product; its value is the product of the
   values. n is at most 8.
*/
MpmFraction MpmFractionProduct(PetscInt n, const MpmFraction factors[]);

/*
   MpmFractionNear - a double as the fraction of a denominator up to most that is the same double, if there is one.

   Not collective.
*/
MpmFraction MpmFractionNear(PetscReal value, PetscInt64 most);
