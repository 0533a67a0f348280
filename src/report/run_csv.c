/* Writes the time series of a run: step, time, norm, energy, errors and diagnostics. */
#include <mpmstab/errors.h>
#include "report/run_csv.h"
#include "base/text.h"
#include <math.h>
#include <string.h>

/* Appends a column for each of n fields to the header. */
static PetscErrorCode Columns(PetscInt n, const char *const field[], const char name[], MpmText *header)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < n; f++) PetscCall(MpmTextAdd(header, ",%s%s", name, field[f]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRunCsvBegin(const MpmRun *run, const char before[], MpmTextFile *csv)
{
  const MpmScene   *scene   = run->scene;
  const MpmRequest *request = run->request;
  const MpmTable   *table   = scene->scheme.table;
  MpmText           header  = {NULL, 0};
  const char       *error[MPM_MOST_ERRORS];
  PetscBool         same;

  PetscFunctionBegin;
  PetscCall(MpmTextAdd(&header, "step,time,norm,energy,log10_norm"));
  if (run->has_errors) PetscCall(Columns(MpmSceneErrorFields(scene, error), error, "error_l2_", &header));
  if (run->pace) PetscCall(MpmTextAdd(&header, ",dt,fastest_wave"));
  if (request->weights) PetscCall(MpmTextAdd(&header, ",c1_mean,c1_min,c1_max"));
  if (request->source_term) PetscCall(Columns(table->nstate, table->fields, "source_", &header));
  if (request->ringing) PetscCall(Columns(table->nstate, table->fields, "ringing_", &header));
  if (request->tangent) PetscCall(MpmTextAdd(&header, ",tangent_log10_growth,window_growth,window_waves"));
  PetscCall(MpmTextAdd(&header, "\n"));
  same = !before || !*before || !strncmp(before, header.text, header.length) ? PETSC_TRUE : PETSC_FALSE;
  if (csv->stream && same) fputs(before && *before ? before : header.text, csv->stream);
  MpmTextFree(&header);
  MpmCheckInput(same,
                "restart %s: its CSV has other columns; allowed: weights, source_term, ringing and tangent as before",
                request->restart);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRunCsvRow(const MpmRun *run, const MpmMarch *march, const MpmTransferDiagnostics *diagnostics,
                            PetscReal log_norm, PetscReal energy, const MpmTextFile *csv)
{
  const MpmScene   *scene   = run->scene;
  const MpmRequest *request = run->request;
  const PetscInt    n       = scene->scheme.table->nstate;
  MpmError          error[MPM_MOST_ERRORS];
  const char       *name[MPM_MOST_ERRORS];

  PetscFunctionBegin;
  if (run->has_errors) PetscCall(MpmDiagnosticsErrors(march, error));
  if (!csv->stream) PetscFunctionReturn(PETSC_SUCCESS);
  fprintf(csv->stream, "%" PetscInt64_FMT, march->step);
  MpmTextFileCell(csv, MpmMarchTime(march, march->step));
  MpmTextFileCell(csv, exp(log_norm));
  MpmTextFileCell(csv, energy);
  MpmTextFileCell(csv, log_norm / M_LN10);
  for (PetscInt f = 0; run->has_errors && f < MpmSceneErrorFields(scene, name); f++) MpmTextFileCell(csv, error[f].l2);
  if (run->pace) { /* of the last step */
    MpmTextFileCell(csv, march->step ? MpmSceneTimeStep(scene, march->courant) : NAN);
    MpmTextFileCell(csv, march->step ? run->pace->fastest * scene->wave_speed : NAN);
  }
  if (request->weights) {
    MpmTextFileCell(csv, diagnostics->last.c1_mean);
    MpmTextFileCell(csv, diagnostics->last.c1_min);
    MpmTextFileCell(csv, diagnostics->last.c1_max);
  }
  for (PetscInt f = 0; request->source_term && f < n; f++) MpmTextFileCell(csv, diagnostics->last.source[f]);
  for (PetscInt f = 0; request->ringing && f < n; f++) MpmTextFileCell(csv, diagnostics->last.ringing[f]);
  if (run->tangents) {
    const MpmTangents     *t    = run->tangents;
    const MpmTangentWindow last = t->nwindows ? t->at[t->nwindows - 1] : (MpmTangentWindow){.norm = NAN, .waves = NAN};

    MpmTextFileCell(csv, t->log_growth[0] / M_LN10);
    MpmTextFileCell(csv, last.norm);
    MpmTextFileCell(csv, last.waves);
  }
  fprintf(csv->stream, "\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}
