/* Results of the tasks: a table for people, JSON for programs, and CSV. */
#pragma once
#include "analysis/damping.h"
#include "analysis/ensemble.h"
#include "analysis/run.h"
#include "analysis/spectrum.h"
#include "analysis/stability_map.h"
#include "io/datafile.h"
#include "symbol/predict.h"
#include <mpmstab/critical.h>
#include <jansson.h>

/* Collective. Print the table for people on standard output, and write the JSON object when the request asks for it. */
PetscErrorCode MpmRunPrint(const MpmRun *run);
PetscErrorCode MpmRunWriteJson(const MpmRun *run);

/* Collective. Print the table for people, and write the JSON object when the request asks for it. */
PetscErrorCode MpmSpectrumPrint(const MpmSpectrum *spectrum);
PetscErrorCode MpmSpectrumWriteJson(const MpmSpectrum *spectrum);

/*
   Collective. Print, and add to the JSON object, norm(A^n) and the pseudospectrum of a spectrum where the request asks
   for them.
*/
PetscErrorCode MpmTransientPrint(const MpmSpectrum *spectrum);
void           MpmTransientJson(const MpmSpectrum *spectrum, json_t *object);

/*
   Print the table of damping for people, make the value of the key 'symbol.damping', and write the CSV with a row for
   each wave and time step, and /symbol/damping_... in an HDF5 file.

   Collective, but MpmDampingJson is not.
*/
PetscErrorCode MpmDampingPrint(const MpmScene *scene, const MpmDamping *damping);
json_t        *MpmDampingJson(const MpmScene *scene, const MpmDamping *damping);
PetscErrorCode MpmDampingWriteCsv(const MpmDamping *damping, const char path[]);
PetscErrorCode MpmDampingWrite(const MpmDamping *damping, MpmDataFile *file);

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

/*
   Collective. Prints the limits of every formulation, transfer and basis at a scene's layout as a table, and writes
   them as CSV when the request asks for it.
*/
PetscErrorCode MpmCriticalPrintSurvey(const MpmScene *scene, const MpmRequest *request);
