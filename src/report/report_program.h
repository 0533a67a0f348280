/* What the reports of tasks on a code that was probed share. */
#pragma once
#include "analysis/critical_program.h"
#include "report/report_certificates.h"

/* Collective. Prints the code, how it is probed and why, and what that costs, before the work. */
PetscErrorCode MpmReportProgram(const MpmProgram *program, PetscMPIInt ranks);

/* Collective. Prints which unknowns are set apart. */
PetscErrorCode MpmReportApart(const MpmProgram *program);

/* Collective. Prints the particles that carry the mode of largest growth, with their places. */
PetscErrorCode MpmReportCarriers(const MpmProgram *program, const MpmCarriers *carriers);
json_t        *MpmJsonCarriers(const MpmProgram *program, const MpmCarriers *carriers);

/* Collective. Print the limits of the time step, and write the JSON object. */
PetscErrorCode MpmReportCriticalProgram(const MpmProgram *program, const MpmCriticalProgram *critical,
                                        PetscMPIInt ranks);
PetscErrorCode MpmCriticalProgramWriteJson(const MpmProgram *program, const MpmCriticalProgram *critical,
                                           PetscMPIInt ranks, PetscReal wall_s);

/* Not collective. A new object with the code, how it was probed, and its certificates. */
json_t *MpmJsonProgram(const MpmProgram *program);
