/*
   Exact fractions, for drifts and offsets. Two questions must not depend on rounding: whether a particle is exactly at
   a node, and after how many steps particles have the same places in cells again.
*/
#pragma once
#include <mpmstab/compat.h>

/*S
   MpmFraction - a number that is kept as a ratio num / den of integers where its text is one ('1/8', '0.3').

   num and den have no common divisor, den > 0, and both are at most 1e15 in size. den is 0 when the number has no such
   form; then value alone holds it. value is always the double nearest to the number.
S*/
typedef struct {
  PetscInt64 num, den;
  PetscReal  value;
} MpmFraction;

/*@C
   MpmFractionParse - reads a number such as '3', '-1/8', '0.25' or '1e-9'.

   Not collective.

   Input Parameter: text - the number
   Output Parameter: fraction - the number; what it has means nothing where the text is none

   Returns whether the whole text is a finite number.
@*/
PetscBool MpmFractionParse(const char text[], MpmFraction *fraction);

/*@C
   MpmFractionBetween - point j of n equally spaced points, n > 1. Point 0 is from, and point n - 1 is to.

   Not collective. The point is a ratio if both ends are and if its terms are at most 1e15 in size. Else it is a double.
@*/
MpmFraction MpmFractionBetween(const MpmFraction *from, const MpmFraction *to, PetscInt j, PetscInt n);

/*@C
   MpmFractionMultiple - n times a fraction, as whole + part with part in [0,1).

   Not collective. For a ratio only the division that gives part is rounded. For a double the product is formed with an
   fma, without rounding, so that nothing accumulates over steps.
@*/
void MpmFractionMultiple(const MpmFraction *fraction, PetscInt64 n, PetscInt64 *whole, PetscReal *part);

/*@C
   MpmFractionProduct - the product of n fractions.

   Not collective. The product is a ratio if all factors are, if the products of their terms fit into 128 bits, and if
   its terms are at most 1e15 in size. Else den is 0, and value is the product of the values.
@*/
MpmFraction MpmFractionProduct(PetscInt n, const MpmFraction factors[]);

/*@C
   MpmFractionNear - the fraction with a denominator up to most whose double is value. If there is none, den is 0.

   Not collective.
@*/
MpmFraction MpmFractionNear(PetscReal value, PetscInt64 most);

/*@C
   MpmFractionNearest - the fraction nearest to value of those with a denominator up to most.

   Not collective. abs(value) may be at most 1e6, and most at most 1e4: then rounding decides nothing but ties.
@*/
MpmFraction MpmFractionNearest(PetscReal value, PetscInt64 most);

/* Not collective. The greatest common divisor of two numbers; of a and 0 it is abs(a). */
PetscInt64 MpmCommonDivisor(PetscInt64 a, PetscInt64 b);
