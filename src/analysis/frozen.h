/* The frozen tangent: the spectrum of the tangent of one step of a nonlinear run. */
#pragma once
#include "analysis/spectrum.h"

/*
   MpmFrozenSpectrum - marches a scene of finite kinematics to the request's step at_step, and finds the eigenvalues of the
   tangent of the step after it, as if the state stayed as it is. mismatch: see MpmTangentMismatch. A verdict is undecided
   where the tangent's step is not the march's. Of a material that flows particles may stand on the yield surface, where a
   step has two derivatives: the spectrum is that of loading or unloading, whichever grows more, and the evidence says which.

   Collective on PETSC_COMM_WORLD, with SLEPc initialized. Errors: refuses (PETSC_ERR_USER_INPUT) a step that the run does
   not reach.
*/
PetscErrorCode MpmFrozenSpectrum(const MpmScene *scene, const MpmRequest *request, PetscReal started,
                                 MpmSpectrum **spectrum, PetscReal *mismatch);
