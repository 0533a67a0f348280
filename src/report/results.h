/* Results of the tasks: a table for people, JSON for programs, and CSV. */
#pragma once
#include "analysis/critical_mach.h"
#include "analysis/ensemble.h"
#include "analysis/run.h"
#include "analysis/spectrum.h"
#include "analysis/stability_map.h"
#include "symbol/predict.h"
#include <mpmstab/critical.h>
#include <jansson.h>

/* Collective. Print the table for people on standard output, and write the JSON object when the request asks for it. */
PetscErrorCode MpmRunPrint(const MpmRun *run);
PetscErrorCode MpmRunWriteJson(const MpmRun *run);

/*
   Collective. Print the table for people, and write the JSON object when the request asks for it. more: an object whose
   keys are added, or NULL.
*/
PetscErrorCode MpmSpectrumPrint(const MpmSpectrum *spectrum);
PetscErrorCode MpmSpectrumWriteJson(const MpmSpectrum *spectrum, json_t *more);

/*
   Collective. Print, and add to the JSON object, norm(A^n) and the pseudospectrum of a spectrum where the request asks
   for them.
*/
PetscErrorCode MpmTransientPrint(const MpmSpectrum *spectrum);
void           MpmTransientJson(const MpmSpectrum *spectrum, json_t *object);

/*
   Collective. Print the table for people; write the JSON object, the CSV with a row for each point, and the HDF5 file.
*/
PetscErrorCode MpmStabilityMapPrint(const MpmStabilityMap *map);
PetscErrorCode MpmStabilityMapWriteJson(MpmStabilityMap *map, PetscReal wall_s);
PetscErrorCode MpmStabilityMapWriteCsv(const MpmStabilityMap *map);
PetscErrorCode MpmStabilityMapWriteOutput(const MpmStabilityMap *map);

/* Collective. Print the table for people; write the JSON object, and the CSV with a row for each layout. */
PetscErrorCode MpmEnsemblePrint(const MpmEnsemble *ensemble);
PetscErrorCode MpmEnsembleWriteJson(const MpmEnsemble *ensemble, PetscReal wall_s);
PetscErrorCode MpmEnsembleWriteCsv(const MpmEnsemble *ensemble);

/* Collective. Print, and write as JSON, the limit, what limits it, and growth at the scene's own Courant number. */
PetscErrorCode MpmCriticalPrint(const MpmScene *scene, const MpmRequest *request, const MpmCritical *critical);
PetscErrorCode MpmCriticalWriteJson(const char path[], const MpmScene *scene, const MpmCritical *critical,
                                    PetscReal wall_s);

/* Collective. Writes the row of one scene to a CSV file. */
PetscErrorCode MpmCriticalWriteCsv(const char path[], const MpmScene *scene, const MpmCritical *critical);

/* Collective. Print what was searched at a fixed Mach number; write the JSON object, and the CSV with a row for each Courant number. */
PetscErrorCode MpmCriticalMachPrint(const MpmScene *scene, const MpmRequest *request, const MpmCriticalMach *found);
PetscErrorCode MpmCriticalMachWriteJson(const MpmScene *scene, const MpmRequest *request, const MpmCriticalMach *found,
                                        PetscReal wall_s);
PetscErrorCode MpmCriticalMachWriteCsv(const MpmScene *scene, const MpmRequest *request, const MpmCriticalMach *found);

/*
   Collective. Prints the limits of every formulation, transfer and basis at a scene's layout as a table, and writes
   them as CSV when the request asks for it.
*/
PetscErrorCode MpmCriticalPrintSurvey(const MpmScene *scene, const MpmRequest *request);
