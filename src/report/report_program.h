/* The reports of codes that are probed. */
#pragma once
#include "probe/compare_program.h"
#include "probe/critical_program.h"
#include "probe/motion.h"
#include "report/report.h"

/* Collective. Before the work: print the code, how it is probed, why, and what that costs; what a search costs. */
void MpmReportProgram(const MpmProgram *program);
void MpmReportCriticalPlan(const MpmCriticalProgram *critical);

/* Collective. The certificates that were taken, what fails where one does not hold, and the scales of fields. */
void MpmReportCertificates(json_t *result, const MpmCertificates *certificates);

/*
   Collective. The code, how it was probed, its certificates, which particles show most what fails, and which unknowns
   are set apart, as 'probing'.
*/
void MpmReportProbed(json_t *result, const MpmProgram *program);

/* Collective. The particles that carry a mode, with their places, as 'carriers'. */
void MpmReportCarriers(json_t *result, const MpmCarriers *carriers);

/* Collective. The drift to whose places particles were set, and the steps of its period. */
void MpmReportMotion(json_t *result, PetscInt dim, const MpmMotion *motion);

/* Collective. What lies beside a base state that is on a switch, as 'switch'. */
void MpmReportKinks(json_t *result, const MpmKinks *kinks);

/* Collective. A run of the code, and the growth that was measured, as 'measured'. */
void MpmReportRun(json_t *result, const MpmProgram *program, const MpmProgramRun *run);

/* Collective. Beside a scheme of our own: what goes with what, where the two differ, and whether they are the same. */
void MpmReportCompare(json_t *result, const MpmProgram *program, const MpmCompareProgram *compare);

/* Collective. The limits of the time step: the whole report. */
PetscErrorCode MpmCriticalProgramReport(const MpmProgram *program, const MpmCriticalProgram *critical,
                                        PetscReal wall_s);
