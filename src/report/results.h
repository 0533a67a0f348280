/* The reports of the tasks: a table for people and JSON for programs; and their CSV. */
#pragma once
#include "analysis/damping.h"
#include "analysis/critical_mach.h"
#include "analysis/ensemble.h"
#include "analysis/neighbourhoods.h"
#include "analysis/run.h"
#include "analysis/spectrum.h"
#include "analysis/stability_map.h"
#include "io/datafile.h"
#include "report/report.h"

/* Collective. Report a whole task. wall_s: the time that it has taken. */
PetscErrorCode MpmRunReport(const MpmRun *run);
PetscErrorCode MpmStabilityMapReport(MpmStabilityMap *map, PetscReal wall_s);
PetscErrorCode MpmEnsembleReport(const MpmEnsemble *ensemble, PetscReal wall_s);
PetscErrorCode MpmCriticalMachReport(const MpmScene *scene, const MpmRequest *request, const MpmCriticalMach *found,
                                     PetscReal wall_s);

/*
   Collective. The limit, what limits it, and growth at the scene's own Courant number. critical: of the bulk, or NULL.
   all: of the neighbourhoods, or NULL where there is the bulk alone. table: of steps by layout, or NULL.
*/
PetscErrorCode MpmCriticalReport(const MpmScene *scene, const MpmRequest *request, const MpmCritical *critical,
                                 const MpmNeighbourhoods *all, const MpmStepTable *table, PetscReal wall_s);

/* Collective. What a theorem says of a scheme under drift. result: the object 'critical'. */
void MpmReportQuiet(json_t *result, const MpmCritical *critical);

/*
   Collective. The part of a report on a spectrum that comes after its heading. spectrum: of the bulk, or NULL. all: of
   the neighbourhoods, or NULL where there is the bulk alone.
*/
void MpmSpectrumReport(json_t *result, const MpmScene *scene, const MpmRequest *request, const MpmSpectrum *spectrum,
                       const MpmNeighbourhoods *all);

/* Collective. Parts of reports: a tangent beside a run (NULL: nothing); norm(A^n) and the pseudospectrum; damping. */
void MpmTangentsReport(json_t *run, const MpmTangents *tangents);
void MpmTransientReport(json_t *result, const MpmSpectrum *spectrum);
void MpmDampingReport(json_t *result, const MpmScene *scene, const MpmDamping *damping);

/*
   MpmNeighbourhoodsReport - a line for each neighbourhood, with its limit or else its growth, the worst of them and the
   verdict. limits: the worst is the one with the least limit, else the one with the largest growth.

   Collective.
*/
void MpmNeighbourhoodsReport(json_t *result, const MpmScene *scene, const MpmRequest *request, PetscBool limits,
                             const MpmNeighbourhoods *all);

/* Collective. A table of steps by layout, and the step that is recommended. lattice: the scene's layout in words. */
void MpmStepTableReport(json_t *result, const MpmScene *scene, const MpmRequest *request, const char lattice[],
                        const MpmStepTable *table);

/* Not collective. Type, length, direction and phases of a wave in words; assembled: of a mode that has it for the most. */
void MpmReportWave(PetscInt dim, PetscBool assembled, MpmWaveType wave, const PetscReal beta[], size_t room,
                   char text[]);

/*
   Collective. CSV files with a row for each wave and time step, point, layout, scene, or Courant number; HDF5 files of a
   map, and of /symbol/damping_...
*/
PetscErrorCode MpmDampingWriteCsv(const MpmDamping *damping, const char path[]);
PetscErrorCode MpmDampingWrite(const MpmDamping *damping, MpmDataFile *file);
PetscErrorCode MpmStabilityMapWriteCsv(const MpmStabilityMap *map);
PetscErrorCode MpmStabilityMapWriteOutput(const MpmStabilityMap *map);
PetscErrorCode MpmEnsembleWriteCsv(const MpmEnsemble *ensemble);
PetscErrorCode MpmCriticalWriteCsv(const char path[], const MpmScene *scene, const MpmCritical *critical,
                                   const MpmStepTable *table);
PetscErrorCode MpmCriticalMachWriteCsv(const MpmScene *scene, const MpmRequest *request, const MpmCriticalMach *found);
/* Collective. Writes the particles of a layout, and the numbers of each that critical has. */
PetscErrorCode MpmCriticalWriteLayout(const char path[], const MpmScene *scene, const MpmCritical *critical);

/*
   Collective. Prints the limits of every formulation, transfer and basis at a scene's layout as a table, and writes
   them as CSV when the request asks for it.
*/
PetscErrorCode MpmCriticalPrintSurvey(const MpmScene *scene, const MpmRequest *request);
