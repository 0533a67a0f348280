/*
   Exact fractions, for drifts and offsets. Whether a particle is exactly at a node, and after how many steps particles
   are back in their places, must not depend on rounding.
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
   Output Parameters:
+  fraction - the number; not set when ok is PETSC_FALSE
-  ok       - whether the whole text is a finite number
@*/
PetscErrorCode MpmFractionParse(const char text[], MpmFraction *fraction, PetscBool *ok);

/*@C
   MpmFractionBetween - point j of n equally spaced points, n > 1: point 0 is from, point n - 1 is to.

   Not collective. The point is a ratio where both ends are and its terms are at most 1e15 in size, else a double.
@*/
MpmFraction MpmFractionBetween(const MpmFraction *from, const MpmFraction *to, PetscInt j, PetscInt n);

/*@C
   MpmFractionMultiple - n times a fraction, as whole + part with part in [0,1).

   Not collective. For a ratio only the division that gives part is rounded. For a double the product is formed with an
   fma, without rounding, so that nothing accumulates over steps.
@*/
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
