/*
   What the task run does beside the march: it reads a checkpoint or an eigenmode at the start, writes rows of CSV,
   output steps and checkpoints, and gives all files their names at the end. The checkpoint of the last step is written
   after the other files; if it exists, so do they.
*/
#include "base/stop.h"
#include "base/text.h"
#include "base/textfile.h"
#include "io/checkpoint.h"
#include "io/mode_file.h"
#include "io/output.h"
#include "task/task.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <string.h>

#define SAME_TIME 1e-12 /* relative: an output interval that is over but for rounding is over */

/* Appends a column for each of n fields to the header. */
static PetscErrorCode Columns(PetscInt n, const char *const field[], const char name[], MpmText *header)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < n; f++) PetscCall(MpmTextAdd(header, ",%s%s", name, field[f]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode BeginCsv(const MpmRun *run, const char before[], MpmTextFile *csv)
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

static PetscErrorCode WriteRow(const MpmRun *run, const MpmMarch *march, const MpmTransferDiagnostics *diagnostics,
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

/* ---- all files ---- */

typedef struct {
  const MpmScene   *scene;
  const MpmRequest *request;
  PetscInt64        from;   /* the step at which this run began */
  PetscReal         passed; /* whole output intervals until the last step */
  MpmOutput        *output; /* NULL: none is written */
  MpmTextFile       csv;
  PetscInt64        kept;  /* the step of the last checkpoint that this run has written, or MPM_NEVER */
  PetscBool         again; /* the run goes once more to where it has been */
} Files;

#define LARGE_STRAIN 0.5
#define SMALL_STRAIN 1e-2

/* Velocities of a wave over c are its strains. The default amplitude, 1, is then that of a material without volume. */
static void NoteAmplitude(const MpmScene *s)
{
  const PetscReal strain = s->amplitude / s->wave_speed;

  if (!s->scheme.space.finite || strain < LARGE_STRAIN) return;
  if (s->initial != MPM_INITIAL_MODE && s->initial != MPM_INITIAL_RANDOM) return;
  MpmPrint("note: amplitude %.6g is %.3g of the wave speed, so that strains come near %.3g and particles may be "
           "compressed to nothing; for small strains give -amplitude %.6g or less\n",
           s->amplitude, strain, strain, SMALL_STRAIN * s->wave_speed);
}

/* Opens the files. Each was tried when the scene was read, and gets its own name only when the work is done. */
static PetscErrorCode Begin(void *context, MpmRun *run, MpmMarch *march)
{
  Files            *files   = context;
  const MpmScene   *scene   = files->scene;
  const MpmRequest *request = files->request;
  char             *before  = NULL; /* rows in the checkpoint from which the run resumes; NULL: it does not resume */
  PetscBool         there   = PETSC_FALSE;

  PetscFunctionBegin;
  if (scene->initial == MPM_INITIAL_EIGENMODE) {
    PetscCall(MpmModeFileGrowth(scene, request->mode_file, &run->eigenmode));
    if (!request->restart[0]) PetscCall(MpmModeFileFill(request->mode_file, march));
  }
  if (request->restart[0]) PetscCall(MpmCheckpointRead(request->restart, request->steps, march, run, &before));
  files->from = march->step;
  if (run->pace && MpmPaceIsOver(run->pace, march)) run->last = march->step;
  if (request->restart[0] && files->from == run->last && !files->again)
    MpmPrint("the checkpoint %s is of the last step, %" PetscInt64_FMT ": nothing is left to march\n", request->restart,
             files->from);
  if (!request->restart[0] && !files->again) NoteAmplitude(scene);
  if (request->checkpoint[0]) MpmStopInstall();
  if (request->output[0]) {
    /* a run of no steps adds nothing to an output that ends with this step */
    if (march->step == run->last) PetscCall(MpmOutputHasStep(request, march->step, &there));
    if (there)
      MpmPrint("%s has step %" PetscInt64_FMT " already and is left as it is\n", request->output, march->step);
    else
      PetscCall(MpmOutputCreate(march, request, &files->output));
  }
  if (request->csv[0]) {
    if (before && !*before)
      MpmPrint("%s begins after step %" PetscInt64_FMT ": the checkpoint holds no earlier rows\n", request->csv,
               files->from);
    PetscCall(MpmTextFileOpen(request->csv, &files->csv));
    PetscCall(BeginCsv(run, before, &files->csv));
  }
  PetscCall(PetscFree(before));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Sample(void *context, const MpmRun *run, const MpmMarch *march,
                             const MpmTransferDiagnostics *diagnostics, PetscReal log_norm, PetscReal energy)
{
  Files *files = context;

  PetscFunctionBegin;
  if (files->request->csv[0]) PetscCall(WriteRow(run, march, diagnostics, log_norm, energy, &files->csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Writes a checkpoint when it is due or when a signal asks the run to stop. A run without checkpoints does not look for
   signals. The checkpoint of the last step is written at the end.
*/
static PetscErrorCode Keep(Files *files, const MpmRun *run, const MpmMarch *march, PetscBool *stop)
{
  const MpmRequest *request = files->request;
  char             *csv     = NULL;

  PetscFunctionBegin;
  if (!request->checkpoint[0] || march->step == files->from || march->step == run->last)
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmStopAgreed(PETSC_COMM_WORLD, stop));
  if (!*stop && march->step % request->checkpoint_every) PetscFunctionReturn(PETSC_SUCCESS);
  if (request->csv[0]) PetscCall(MpmTextFileSoFar(&files->csv, &csv));
  PetscCall(MpmCheckpointWrite(request->checkpoint, march, run, csv));
  files->kept = march->step;
  PetscCall(PetscFree(csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Whether output is due: at the first step and the last, and every so many steps, or when an interval of time is over.
*/
static PetscBool IsDue(Files *files, const MpmRun *run, const MpmMarch *march)
{
  const MpmRequest *request = files->request;
  const PetscReal   before  = files->passed;
  PetscBool         due     = march->step % request->output_every == 0 ? PETSC_TRUE : PETSC_FALSE;

  if (request->output_interval > 0) {
    files->passed = floor(MpmMarchTime(march, march->step) / request->output_interval * (1 + SAME_TIME));
    due           = files->passed > before ? PETSC_TRUE : PETSC_FALSE;
  }
  return due || march->step == files->from || march->step == run->last ? PETSC_TRUE : PETSC_FALSE;
}

static PetscErrorCode Step(void *context, const MpmRun *run, MpmMarch *march, PetscBool *stop)
{
  Files *files = context;

  PetscFunctionBegin;
  if (files->output && IsDue(files, run, march)) PetscCall(MpmOutputStep(files->output, march));
  if (!run->lost) PetscCall(Keep(files, run, march, stop));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finishes the files. A run that was stopped keeps its checkpoint alone. */
static PetscErrorCode End(void *context, const MpmRun *run, MpmMarch *march)
{
  Files            *files   = context;
  const MpmRequest *request = files->request;
  const PetscBool   keep    = run->stopped ? PETSC_FALSE : PETSC_TRUE;
  const PetscBool   last    = keep && request->checkpoint[0] && !run->lost ? PETSC_TRUE : PETSC_FALSE;
  char             *csv     = NULL;

  PetscFunctionBegin;
  if (last && request->csv[0]) PetscCall(MpmTextFileSoFar(&files->csv, &csv));
  if (files->output) PetscCall(MpmOutputDestroy(keep, &files->output));
  if (request->csv[0] && keep) PetscCall(MpmTextFileClose(&files->csv));
  if (request->csv[0] && !keep) MpmTextFileDrop(&files->csv);
  if (last) PetscCall(MpmCheckpointWrite(request->checkpoint, march, run, csv));
  PetscCall(PetscFree(csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Writes the state of the last whole step before a particle failed. That step is marched once more, from the last
   checkpoint or from the start, so that a run keeps nothing for the case that it fails. Perturbations have been
   followed already.
*/
static PetscErrorCode KeepLastWhole(const Files *files, PetscReal started, MpmRun *failed)
{
  MpmRequest            request = *files->request;
  Files                 again   = {.scene = files->scene, .request = &request, .kept = MPM_NEVER, .again = PETSC_TRUE};
  const MpmRunCallbacks callbacks = {
      .context = &again, .begin = Begin, .sample = Sample, .step = Step, .end = End, .silent = PETSC_TRUE};
  char    more[128];
  MpmRun *run;

  PetscFunctionBegin;
  request.steps     = failed->steps;
  request.tangent   = MPM_TANGENT_NONE;
  request.output[0] = request.xmf[0] = request.csv[0] = request.json[0] = '\0';
  if (files->kept != MPM_NEVER) (void)snprintf(request.restart, sizeof request.restart, "%s", request.checkpoint);
  if (files->kept != failed->steps) {
    PetscCall(MpmRunCreate(files->scene, &request, &callbacks, started, &run));
    PetscCall(MpmRunDestroy(&run));
  }
  (void)snprintf(more, sizeof more, "; the checkpoint has the state of step %" PetscInt64_FMT, failed->steps);
  MpmTextJoin(failed->failure, more, sizeof failed->failure);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRunFilesCreate(const MpmScene *scene, const MpmRequest *request, PetscReal started, MpmRun **run)
{
  Files                 files     = {.scene = scene, .request = request, .kept = MPM_NEVER};
  const MpmRunCallbacks callbacks = {.context = &files, .begin = Begin, .sample = Sample, .step = Step, .end = End};

  PetscFunctionBegin;
  PetscCall(MpmRunCreate(scene, request, &callbacks, started, run));
  if ((*run)->failure[0] && request->checkpoint[0]) PetscCall(KeepLastWhole(&files, started, *run));
  PetscFunctionReturn(PETSC_SUCCESS);
}
