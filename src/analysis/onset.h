/* Onset: the least value of a parameter beyond which growth is more than is tolerated. */
#pragma once
#include <mpmstab/compat.h>

/* excess: growth - 1 at a value of the parameter. A growth that is not known is NaN, and counts as none that is stable. */
typedef PetscErrorCode (*MpmOnsetFunction)(void *context, PetscReal at, PetscReal *excess);

/*S
   MpmOnset - how it is sought.

   start     - where the search begins; it goes on by doubling or halving, up to farthest times it or down to one over that
   tolerance - the excess up to which a value is stable
   below     - values below the onset that are looked at too, equally spaced
S*/
typedef struct {
  MpmOnsetFunction excess;
  void            *context;
  PetscReal        start, farthest, tolerance;
  PetscInt         below;
} MpmOnset;

/*
   MpmOnsetFind - finds the largest value, to 1e-6 of it, up to which no value that was looked at is unstable. 0: all are
   unstable; infinite: none is.

   Just above an onset, growth - 1 is proportional to the distance (an eigenvalue that leaves the unit circle) or to its
   square root (two eigenvalues that meet on it). Values that were found unstable show which, and where the onset should
   be; then values on both sides of that are looked at, until they are next to one another.

   Collective if the function is.
*/
PetscErrorCode MpmOnsetFind(const MpmOnset *onset, PetscReal *limit);
