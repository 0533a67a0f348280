/* Powers of two that are taken out of numbers: dividing by one changes no digit. */
#pragma once
#include <mpmstab/compat.h>
#include <math.h>

/*
   MpmPowerToTakeOut - the power of two by which numbers are to be divided so that their largest is of order 1 again, if
   that has left the range from 2^-limit to 2^limit; else 0. It is 0 too where nothing can be done: for 0, infinity, NaN.

   Not collective.
*/
static inline PetscInt MpmPowerToTakeOut(PetscReal largest, PetscInt limit)
{
  return isnormal(largest) && PetscAbsInt(ilogb(largest)) >= limit ? ilogb(largest) : 0;
}
