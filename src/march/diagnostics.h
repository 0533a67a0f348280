/* Diagnostics: how far a run is from the exact solution. */
#pragma once
#include "march/march_private.h"

/* Errors of one field over the particles, weighted by volume, relative to the exact amplitude. */
typedef struct {
  PetscReal l1, l2, linf;
} MpmError;

/*
   MpmDiagnosticsErrors - errors of all particle fields at the march's step.

   Collective. The scene must have an exact solution (initial mode or pulse). Infinite when out of range.
*/
PetscErrorCode MpmDiagnosticsErrors(const MpmMarch *march, MpmError error[]);
