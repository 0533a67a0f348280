/* Carriers: the particles on which an eigenvector of a code that was probed sits. */
#pragma once
#include "analysis/program.h"
#include "analysis/spectrum.h"

#define MPM_CARRIERS 3

/*S
   MpmCarriers - the n particles with the largest shares of the square of an eigenvector, whose numbers are in scales.

   particle, share - of each, the largest first; places are in the program's base state
   most            - the number of particles that together have 90% of the square
S*/
typedef struct {
  PetscInt   n;
  PetscInt64 particle[MPM_CARRIERS], most;
  PetscReal  share[MPM_CARRIERS];
} MpmCarriers;

/* Collective. Of the first listed eigenvalue; n is 0 when there is none. */
PetscErrorCode MpmCarriersFind(const MpmProgram *program, const MpmSpectrum *spectrum, MpmCarriers *carriers);
