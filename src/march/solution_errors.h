/* Errors of a march at finite strain against the exact solution of its scene. */
#pragma once
#include "march/march_private.h"

/* Errors of one field over the particles, weighted by volume, relative to the exact amplitude. */
typedef struct {
  PetscReal l1, l2, linf;
} MpmError;

/*
   MpmSolutionErrors - the errors of the fields that MpmSceneErrorFields names, over all particles, relative to the sizes
   of the solution.

   Collective. The scene must have an exact solution at finite strain.
*/
PetscErrorCode MpmSolutionErrors(const MpmMarch *march, MpmError error[]);
