/* The task symbol for the blocks of a lattice in the place of a scene. */
#pragma once
#include "scene/request.h"

/* Collective. missed: the number of expectations that are not met. */
PetscErrorCode MpmSymbolOfBlocks(const MpmRequest *request, PetscReal started, PetscInt *missed);
