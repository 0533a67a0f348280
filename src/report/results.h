/* What the tasks tell: a table for people, JSON for programs, CSV. */
#pragma once
#include "analysis/ensemble.h"
#include "analysis/run.h"
#include "analysis/spectrum.h"
#include "analysis/stability_map.h"
#include "symbol/predict.h"
#include <mpmstab/critical.h>
#include <jansson.h>

/* Collective. The table for people, on standard output; the JSON object, when the request asks for it. */
PetscErrorCode MpmRunPrint(const MpmRun *run);
PetscErrorCode MpmRunWriteJson(const MpmRun *run);

/* Collective. The table for people; the JSON object, when the request asks for it. */
PetscErrorCode MpmSpectrumPrint(const MpmSpectrum *spectrum);
PetscErrorCode MpmSpectrumWriteJson(const MpmSpectrum *spectrum);

/* Collective. Of these, what is said of norm(A^n) and of the pseudospectrum; nothing where the request does not ask. */
PetscErrorCode MpmTransientPrint(const MpmSpectrum *spectrum);
void           MpmTransientJson(const MpmSpectrum *spectrum, json_t *object);

/* Collective. The table for people; the JSON object; the CSV with a row for each point; the HDF5 file. */
PetscErrorCode MpmStabilityMapPrint(const MpmStabilityMap *map);
PetscErrorCode MpmStabilityMapWriteJson(MpmStabilityMap *map, PetscReal wall_s);
PetscErrorCode MpmStabilityMapWriteCsv(const MpmStabilityMap *map);
PetscErrorCode MpmStabilityMapWriteOutput(const MpmStabilityMap *map);

/* Collective. The table for people; the JSON object, and the CSV with a row for each layout. */
PetscErrorCode MpmEnsemblePrint(const MpmEnsemble *ensemble);
PetscErrorCode MpmEnsembleWriteJson(const MpmEnsemble *ensemble, PetscReal wall_s);
PetscErrorCode MpmEnsembleWriteCsv(const MpmEnsemble *ensemble);

/* Collective. The limit, what limits it, and growth at the scene's own Courant number. */
PetscErrorCode MpmCriticalPrint(const MpmScene *scene, const MpmRequest *request, const MpmCritical *critical);
PetscErrorCode MpmCriticalWriteJson(const char path[], const MpmScene *scene, const MpmCritical *critical,
                                    PetscReal wall_s);

/* Collective. The row of one scene, to a file. */
PetscErrorCode MpmCriticalWriteCsv(const char path[], const MpmScene *scene, const MpmCritical *critical);

/* Collective. The limits of every formulation, transfer and basis at a scene's layout, as a table and, if asked, CSV. */
PetscErrorCode MpmCriticalPrintSurvey(const MpmScene *scene, const MpmRequest *request);
