/* Diagnostics: the errors of a run, relative to the exact solution. */
#pragma once
#include "march/march_private.h"

/* Errors of one field over the particles, weighted by volume, relative to the exact amplitude. */
typedef struct {
  PetscReal l1, l2, linf;
} MpmError;

/*
   MpmDiagnosticsErrors - the errors of the fields of MpmSceneErrorFields at the march's step. At finite strain particles
   have equal weights.

   Collective. The scene must have an exact solution (MpmSceneHasExact). Errors that are out of the range of doubles are
   infinite.
*/
PetscErrorCode MpmDiagnosticsErrors(const MpmMarch *march, MpmError error[]);
