/* A code beside a scheme of our own: a table for people, and JSON. */
#pragma once
#include "probe/compare_program.h"
#include "report/report.h"

/* Collective. Prints what goes with what, where the two differ, and a sentence that says whether they are the same. */
void MpmReportCompare(const MpmProgram *program, const MpmCompareProgram *compare);

/* Not collective. A new object with the same. */
json_t *MpmJsonCompare(const MpmCompareProgram *compare);
