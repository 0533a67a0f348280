/* The states of a march, as tangents take them. */
#pragma once
#include "march/march_private.h"
#include "operator/tangent.h"

/*
   MpmTangentStateOf - copies the present state of a march of the space's scheme, particles in the order of their ids.

   Collective.
*/
PetscErrorCode MpmTangentStateOf(const MpmTangentSpace *space, const MpmMarch *march, MpmTangentState *state);

/*
   MpmTangentMismatch - takes a march through its next step, and compares it with the step that the tangent at the state
   before is made of. The result is the largest difference of a place, in cells, or of a field, over the largest number of
   that field or 1.

   Collective. tangent: that of the step. The result is NaN when the march fails in this step.
*/
PetscErrorCode MpmTangentMismatch(MpmTangentSpace *space, MpmMarch *march, Mat *tangent, PetscReal *mismatch);
