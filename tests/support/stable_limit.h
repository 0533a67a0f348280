/* The largest stable Courant number of a scene, as tests ask for it. */
#pragma once
#include "check.h"
#include <mpmstab/critical.h>

/* The limit, by MpmCriticalFind. alone: see there. */
static inline PetscErrorCode FindLimit(const char options[], PetscBool alone, MpmCritical *limit)
{
  MpmScene       *scene;
  MpmCriticalCase of;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  of = MpmCriticalCaseOf(scene, check_request.tolerance);
  PetscCall(MpmCriticalFind(&of, alone, limit));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
