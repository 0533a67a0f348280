/* Powers of two by which numbers are scaled: dividing by one of them changes no digit. */
#pragma once
#include <mpmstab/compat.h>
#include <math.h>

/*
   MpmPowerToTakeOut - the exponent of the power of two by which numbers are to be divided so that their largest is of
   order 1 again. It is 0 while the largest lies between 2^-limit and 2^limit, and also for 0, infinity and NaN, which
   no division can bring back.

   Not collective.
*/
static inline PetscInt MpmPowerToTakeOut(PetscReal largest, PetscInt limit)
{
  return isnormal(largest) && PetscAbsInt(ilogb(largest)) >= limit ? ilogb(largest) : 0;
}
