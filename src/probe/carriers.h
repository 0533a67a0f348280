/* Carriers: the particles on which an eigenvector of a code that was probed sits. */
#pragma once
#include "probe/program.h"
#include "analysis/spectrum.h"

#define MPM_CARRIERS 3

/*S
   MpmCarriers - the n particles with the largest shares of the square of an eigenvector, whose numbers are in scales.

   particle, share - of each, the largest first; place: in the base state, dim numbers; dim is 0 if no field is the place
   most            - the number of particles that together have 90% of the square; all: of all
S*/
typedef struct {
  PetscInt   n, dim;
  PetscInt64 particle[MPM_CARRIERS], most, all;
  PetscReal  share[MPM_CARRIERS], place[MPM_CARRIERS][MPM_MAX_DIM];
} MpmCarriers;

/* Collective. Of the first listed eigenvalue; n is 0 when there is none. */
PetscErrorCode MpmCarriersFind(const MpmProgram *program, const MpmSpectrum *spectrum, MpmCarriers *carriers);
