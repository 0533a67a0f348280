/* The parts of MpmCriticalFind. */
#pragma once
#include <mpmstab/critical.h>

/* Collective. The searches through the symbol (at rest, under drift) and through the assembled operator. */
PetscErrorCode MpmCriticalBySymbol(const MpmScene *scene, PetscBool alone, MpmCritical *critical);
PetscErrorCode MpmCriticalUnderDrift(const MpmScene *scene, MpmCritical *critical);
PetscErrorCode MpmCriticalAssembled(const MpmScene *scene, MpmCritical *critical);
