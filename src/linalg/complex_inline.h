/*
   Complex products, quotients and roots of numbers that are finite and whose squares are, in a few instructions. Those of
   C look for infinite and huge parts first, which takes several times as long.
*/
#pragma once
#include <mpmstab/compat.h>
#include <complex.h>
#include <math.h>

static inline double complex MpmTimes(double complex a, double complex b)
{
  return CMPLX(creal(a) * creal(b) - cimag(a) * cimag(b), creal(a) * cimag(b) + cimag(a) * creal(b));
}

/* conj(a) b */
static inline double complex MpmConjTimes(double complex a, double complex b)
{
  return CMPLX(creal(a) * creal(b) + cimag(a) * cimag(b), creal(a) * cimag(b) - cimag(a) * creal(b));
}

static inline double complex MpmScaled(PetscReal factor, double complex a)
{
  return CMPLX(factor * creal(a), factor * cimag(a));
}

/* The square of the absolute value. */
static inline PetscReal MpmSquare(double complex a)
{
  return creal(a) * creal(a) + cimag(a) * cimag(a);
}

static inline PetscReal MpmAbs(double complex a)
{
  return sqrt(MpmSquare(a));
}

/* a / b */
static inline double complex MpmOver(double complex a, double complex b)
{
  return MpmScaled(1 / MpmSquare(b), MpmConjTimes(b, a));
}

/* The square root whose real part is not negative. */
static inline double complex MpmRoot(double complex a)
{
  const PetscReal big = sqrt((MpmAbs(a) + fabs(creal(a))) / 2);

  if (big == 0) return 0;
  return creal(a) >= 0 ? CMPLX(big, cimag(a) / (2 * big))
                       : CMPLX(fabs(cimag(a)) / (2 * big), cimag(a) < 0 ? -big : big);
}
