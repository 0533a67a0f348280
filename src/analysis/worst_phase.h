/* The phase of largest growth of a source, sought over all phases and not only at equally spaced ones. */
#pragma once
#include "symbol/source.h"

/*
   MpmWorstPhase - finds it by MpmZoomLeast, which begins with about as many phases as a symbol has.

   Collective. phases: of the symbol in each direction. Output: the phase in (-pi, pi], and what is there.
*/
PetscErrorCode MpmWorstPhase(MPI_Comm comm, const MpmSource *source, const PetscInt phases[], PetscReal beta[],
                             MpmSourceGrowth *at);
