/* Results of the tasks: a table for people, JSON for programs, and CSV. */
#pragma once
#include "analysis/damping.h"
#include "analysis/critical_mach.h"
#include "analysis/ensemble.h"
#include "analysis/neighbourhoods.h"
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

/*
   What a theorem says of a scheme under drift: in words, and as keys of 'critical' in JSON.

   The first is collective.
*/
void MpmReportQuiet(const MpmCritical *critical);
void MpmJsonSetQuiet(json_t *object, const MpmCritical *critical);

/* Collective. Print the tangent beside a run (NULL: nothing), and add the key 'tangent' to the run's JSON object. */
void MpmTangentsPrint(const MpmTangents *tangents);
void MpmTangentsJson(const MpmTangents *tangents, json_t *object);

/*
   Collective. Print the table for people, and write the JSON object. spectrum: of the bulk, or NULL. all: of the
   neighbourhoods, or NULL where there is the bulk alone. more: an object whose keys JSON has too, or NULL.
*/
PetscErrorCode MpmSpectrumPrint(const MpmScene *scene, const MpmRequest *request, const MpmSpectrum *spectrum,
                                const MpmNeighbourhoods *all);
PetscErrorCode MpmSpectrumWriteJson(const MpmScene *scene, const MpmRequest *request, const MpmSpectrum *spectrum,
                                    const MpmNeighbourhoods *all, PetscReal wall_s, json_t *more);

/*
   Collective. Print, and add to the JSON object, norm(A^n) and the pseudospectrum of a spectrum where the request asks
   for them.
*/
void MpmTransientPrint(const MpmSpectrum *spectrum);
void MpmTransientJson(const MpmSpectrum *spectrum, json_t *object);

/*
   Print the table of damping for people, make the value of the key 'symbol.damping', and write the CSV with a row for
   each wave and time step, and /symbol/damping_... in an HDF5 file.

   Collective, but MpmDampingJson is not.
*/
void           MpmDampingPrint(const MpmScene *scene, const MpmDamping *damping);
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

/*
   Collective. Print, and write as JSON, the limit, what limits it, and growth at the scene's own Courant number.
   critical: of the bulk, or NULL. all: of the neighbourhoods, or NULL where there is the bulk alone.
*/
PetscErrorCode MpmCriticalPrint(const MpmScene *scene, const MpmRequest *request, const MpmCritical *critical,
                                const MpmNeighbourhoods *all);
PetscErrorCode MpmCriticalWriteJson(const char path[], const MpmScene *scene, const MpmCritical *critical,
                                    const MpmNeighbourhoods *all, PetscReal wall_s);

/*
   MpmNeighbourhoodsPrint - prints a line for each neighbourhood, with its limit or else its growth, the worst of them
   and the verdict. MpmNeighbourhoodsJson - adds each of them, and the name of the worst, to an object.
   limits: the worst is the one with the least limit, else the one with the largest growth.

   Collective.
*/
void MpmNeighbourhoodsPrint(const MpmScene *scene, const MpmRequest *request, PetscBool limits,
                            const MpmNeighbourhoods *all);
void MpmNeighbourhoodsJson(const MpmScene *scene, const MpmNeighbourhoods *all, PetscBool limits, json_t *object);

/* Not collective. Type, length, direction and phases of a wave in words; assembled: of a mode that has it for the most. */
void MpmReportWave(PetscInt dim, PetscBool assembled, MpmWaveType wave, const PetscReal beta[], size_t room,
                   char text[]);

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
