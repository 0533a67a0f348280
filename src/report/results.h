/* The reports of the task critical, and of neighbourhoods: a table for people and JSON for programs; and their CSV. */
#pragma once
#include "analysis/critical_mach.h"
#include "analysis/neighbourhoods.h"
#include "report/report.h"

/* Collective. Report a whole task. wall_s: the time that it has taken. */
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
   MpmNeighbourhoodsReport - a line for each neighbourhood, with its limit or else its growth, the worst of them and the
   verdict. limits: the worst is the one with the least limit, else the one with the largest growth. table: a table of
   steps follows; what stands there is not printed.

   Collective.
*/
void MpmNeighbourhoodsReport(json_t *result, const MpmScene *scene, const MpmRequest *request, PetscBool limits,
                             PetscBool table, const MpmNeighbourhoods *all);
/* Not collective. The neighbourhood as the subject of a sentence. */
const char *MpmNeighbourhoodSubject(MpmNeighbourhoodKind kind);

/* Collective. A table of steps by layout, and the step that is recommended. lattice: the scene's layout in words. */
void MpmStepTableReport(json_t *result, const MpmScene *scene, const MpmRequest *request, const char lattice[],
                        const MpmStepTable *table);

/*
   Not collective. Type, length, direction and phases of a wave in words; assembled: of a mode that has it for the most.
*/
void MpmReportWave(PetscInt dim, PetscBool assembled, MpmWaveType wave, const PetscReal beta[], size_t room,
                   char text[]);

/* Collective. CSV files with a row for each scene, or Courant number. */
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
