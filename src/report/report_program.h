/* What the reports of tasks on a code that was probed share. */
#pragma once
#include "probe/critical_program.h"
#include "report/report_certificates.h"

/* Collective. Prints the code, how it is probed and why, and what that costs, before the work. */
void MpmReportProgram(const MpmProgram *program);

/*
   Collective. The code, how it was probed, its certificates, which particles show most what fails, and which unknowns are set
   apart, as 'probing'.
*/
void MpmReportProbed(json_t *result, const MpmProgram *program);

/* Collective. The particles that carry a mode, with their places, as 'carriers'. */
void MpmReportCarriers(json_t *result, const MpmCarriers *carriers);

/* Collective. Print what the search for the limits of the time step will cost; report the limits. */
void           MpmReportCriticalPlan(const MpmCriticalProgram *critical);
PetscErrorCode MpmCriticalProgramReport(const MpmProgram *program, const MpmCriticalProgram *critical,
                                        PetscReal wall_s);
