/* A code beside a scheme of our own. */
#pragma once
#include "probe/compare_program.h"
#include "report/report.h"

/* Collective. What goes with what, where the two differ, and a sentence that says whether they are the same. */
void MpmReportCompare(json_t *result, const MpmProgram *program, const MpmCompareProgram *compare);
