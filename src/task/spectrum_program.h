/* The task spectrum for a code that is probed, in the place of a scene. */
#pragma once
#include "scene/request.h"

/* Collective. missed: the number of expectations that are not met. */
PetscErrorCode MpmSpectrumOfProgram(const MpmRequest *request, PetscReal started, PetscInt *missed);
