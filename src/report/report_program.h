/* What the reports of tasks on a code that was probed share. */
#pragma once
#include "probe/critical_program.h"
#include "report/report_certificates.h"

/* Collective. Prints the code, how it is probed and why, and what that costs, before the work. */
void MpmReportProgram(const MpmProgram *program);

/* Collective. Prints which particles show most what fails, and which unknowns are set apart. */
void MpmReportApart(const MpmProgram *program);

/* Collective. Print the particles that carry a mode, with their places, and make a JSON list of them. */
void    MpmReportCarriers(const MpmCarriers *carriers);
json_t *MpmJsonCarriers(const MpmCarriers *carriers);

/* Collective. Print what the search will cost, print the limits of the time step, and write the JSON object. */
void           MpmReportCriticalPlan(const MpmCriticalProgram *critical);
void           MpmReportCriticalProgram(const MpmProgram *program, const MpmCriticalProgram *critical);
PetscErrorCode MpmCriticalProgramWriteJson(const MpmProgram *program, const MpmCriticalProgram *critical,
                                           PetscReal wall_s);

/* Not collective. A new object with the code, how it was probed, and its certificates. */
json_t *MpmJsonProgram(const MpmProgram *program);
