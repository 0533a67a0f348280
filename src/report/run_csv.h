/* The time series of a run as CSV: a row for each sampled step. */
#pragma once
#include "march/transfer_diagnostics.h"
#include "base/textfile.h"
#include "analysis/run.h"

/*
   Collective. Writes the header of a new file, or, in a run that resumes, the rows that its checkpoint holds (before;
   NULL or "": none). Refuses rows whose columns are not those of this run.
*/
PetscErrorCode MpmRunCsvBegin(const MpmRun *run, const char before[], MpmTextFile *csv);

/* Collective. Writes a row, with the errors and the diagnostics that the run has; diagnostics may be NULL. */
PetscErrorCode MpmRunCsvRow(const MpmRun *run, const MpmMarch *march, const MpmTransferDiagnostics *diagnostics,
                            PetscReal log_norm, PetscReal energy, const MpmTextFile *csv);
