/* The time series of a run as CSV: a row for each sampled step. */
#pragma once
#include "march/transfer_diagnostics.h"
#include "base/textfile.h"
#include "analysis/run.h"

/*
   MpmRunCsvBegin - writes the header of a new file. In a run that resumes it writes the rows that the checkpoint holds
   (before; NULL or "" for none), and refuses rows whose columns are not those of this run.

   Collective.
*/
PetscErrorCode MpmRunCsvBegin(const MpmRun *run, const char before[], MpmTextFile *csv);

/*
   Collective. Writes a row with the errors and diagnostics that the run has. diagnostics is NULL for a run without
   them.
*/
PetscErrorCode MpmRunCsvRow(const MpmRun *run, const MpmMarch *march, const MpmTransferDiagnostics *diagnostics,
                            PetscReal log_norm, PetscReal energy, const MpmTextFile *csv);
