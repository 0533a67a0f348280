/* Writes the time series of a run: step, time, norm, energy, errors and diagnostics. */
#include <mpmstab/errors.h>
#include "report/run_csv.h"
#include <math.h>
#include <string.h>

#define LONGEST_HEADER 1024

/* Appends a column for each field to the header. */
static PetscErrorCode Columns(const MpmTable *table, PetscBool wanted, const char name[], char header[])
{
  PetscFunctionBegin;
  for (PetscInt f = 0; wanted && table->fields[f]; f++) {
    PetscCall(PetscStrlcat(header, ",", LONGEST_HEADER));
    PetscCall(PetscStrlcat(header, name, LONGEST_HEADER));
    PetscCall(PetscStrlcat(header, table->fields[f], LONGEST_HEADER));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRunCsvBegin(const MpmRun *run, const char before[], MpmTextFile *csv)
{
  const MpmScene   *scene                  = run->scene;
  const MpmRequest *request                = run->request;
  char              header[LONGEST_HEADER] = "step,time,norm,energy,log10_norm";
  size_t            length;

  PetscFunctionBegin;
  PetscCall(Columns(scene->scheme.table, run->has_errors, "error_l2_", header));
  if (request->weights) PetscCall(PetscStrlcat(header, ",c1_mean,c1_min,c1_max", LONGEST_HEADER));
  PetscCall(Columns(scene->scheme.table, request->source_term, "source_", header));
  PetscCall(Columns(scene->scheme.table, request->ringing, "ringing_", header));
  length = strlen(header);
  MpmCheckInput(!before || !*before || (!strncmp(before, header, length) && before[length] == '\n'),
                "restart %s: its CSV has other columns; allowed: weights, source_term and ringing as before",
                request->restart);
  if (csv->stream && before && *before)
    fputs(before, csv->stream);
  else if (csv->stream)
    fprintf(csv->stream, "%s\n", header);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRunCsvRow(const MpmRun *run, const MpmMarch *march, const MpmTransferDiagnostics *diagnostics,
                            PetscReal log_norm, PetscReal energy, const MpmTextFile *csv)
{
  const MpmScene   *scene   = run->scene;
  const MpmRequest *request = run->request;
  const PetscInt    n       = scene->scheme.table->nstate;
  MpmError          error[MPM_MAX_FIELDS];

  PetscFunctionBegin;
  if (run->has_errors) PetscCall(MpmDiagnosticsErrors(march, error));
  if (!csv->stream) PetscFunctionReturn(PETSC_SUCCESS);
  fprintf(csv->stream, "%" PetscInt64_FMT, march->step);
  MpmTextFileCell(csv, march->step * scene->dt);
  MpmTextFileCell(csv, exp(log_norm));
  MpmTextFileCell(csv, energy);
  MpmTextFileCell(csv, log_norm / M_LN10);
  for (PetscInt f = 0; run->has_errors && f < n; f++) MpmTextFileCell(csv, error[f].l2);
  if (request->weights) {
    MpmTextFileCell(csv, diagnostics->last.c1_mean);
    MpmTextFileCell(csv, diagnostics->last.c1_min);
    MpmTextFileCell(csv, diagnostics->last.c1_max);
  }
  for (PetscInt f = 0; request->source_term && f < n; f++) MpmTextFileCell(csv, diagnostics->last.source[f]);
  for (PetscInt f = 0; request->ringing && f < n; f++) MpmTextFileCell(csv, diagnostics->last.ringing[f]);
  fprintf(csv->stream, "\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}
