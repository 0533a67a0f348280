/* Diagnostics: the errors of a run, relative to the exact solution. */
#pragma once
#include "march/solution_errors.h"

/*
   MpmDiagnosticsErrors - the errors of the fields of MpmSceneErrorFields at the march's step. At finite strain particles
   have equal weights.

   Collective. The scene must have an exact solution (MpmSceneHasExact). Errors that are out of the range of doubles are
   infinite.
*/
PetscErrorCode MpmDiagnosticsErrors(const MpmMarch *march, MpmError error[]);
