/* Errors of a march at finite strain against the exact solution of its scene. */
#pragma once
#include "march/diagnostics.h"

/*
   MpmSolutionErrors - the errors of the fields that MpmSceneErrorFields names, over all particles, relative to the sizes
   of the solution.

   Collective. The scene must have an exact solution at finite strain.
*/
PetscErrorCode MpmSolutionErrors(const MpmMarch *march, MpmError error[]);
