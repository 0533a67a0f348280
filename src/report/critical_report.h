/* What the task critical tells. */
#pragma once
#include <mpmstab/critical.h>

/* Collective. The limit, what limits it, and growth at the scene's own Courant number. */
PetscErrorCode MpmCriticalPrint(const MpmScene *scene, const MpmCritical *critical);
PetscErrorCode MpmCriticalWriteJson(const MpmScene *scene, const MpmCritical *critical, PetscReal wall_s);

/* Collective. A row for each of n scenes, to a file. */
PetscErrorCode MpmCriticalWriteCsv(const char path[], const MpmScene *scene, PetscInt n, const MpmScene *const scenes[],
                                   const MpmCritical critical[]);

/* Collective. The limits of every formulation, transfer and basis at a scene's layout, as a table (and CSV). */
PetscErrorCode MpmCriticalSurvey(const MpmScene *scene);
