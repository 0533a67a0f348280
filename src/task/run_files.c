/*
   What the task run does beside the march: it reads a checkpoint or an eigenmode at the start, writes rows of CSV,
   output steps and checkpoints, and gives all files their names at the end. The last checkpoint comes after the other
   files, so that a checkpoint of the last step says that they are there.
*/
#include "task/run_files.h"
#include "base/stop.h"
#include "io/checkpoint.h"
#include "io/mode_file.h"
#include "io/output.h"
#include <mpmstab/errors.h>
#include "report/run_csv.h"

typedef struct {
  const MpmScene *scene;
  PetscInt64      from;   /* the step at which this run began */
  MpmOutput      *output; /* NULL: none is written */
  MpmTextFile     csv;
} Files;

static PetscErrorCode OpenOutput(Files *files, const MpmMarch *march)
{
  PetscBool there = PETSC_FALSE;

  PetscFunctionBegin;
  /* a run of no steps has nothing to add to an output that ends with this step */
  if (march->step == files->scene->steps) PetscCall(MpmOutputHasStep(files->scene, march->step, &there));
  if (there)
    MpmPrint("%s has step %" PetscInt64_FMT " already and is left as it is\n", files->scene->output, march->step);
  else
    PetscCall(MpmOutputCreate(march, &files->output));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* before: rows in the checkpoint that the run resumes from; NULL: it does not resume. */
static PetscErrorCode OpenCsv(Files *files, const MpmRun *run, const char before[])
{
  PetscFunctionBegin;
  if (before && !*before)
    MpmPrint("%s begins after step %" PetscInt64_FMT ": the checkpoint holds no earlier rows\n", files->scene->csv,
             files->from);
  PetscCall(MpmTextFileOpen(files->scene->csv, &files->csv));
  PetscCall(MpmRunCsvBegin(run, before, &files->csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Every file was tried when the scene was read, and has its name only when the work is done. */
static PetscErrorCode Begin(void *context, MpmRun *run, MpmMarch *march)
{
  Files          *files  = context;
  const MpmScene *scene  = files->scene;
  char           *before = NULL;

  PetscFunctionBegin;
  if (scene->initial == MPM_INITIAL_EIGENMODE) {
    PetscCall(MpmModeFileGrowth(scene, &run->eigenmode));
    if (!scene->restart[0]) PetscCall(MpmModeFileFill(march));
  }
  if (scene->restart[0]) PetscCall(MpmCheckpointRead(scene->restart, march, run, &before));
  files->from = march->step;
  if (scene->restart[0] && files->from == scene->steps)
    MpmPrint("the checkpoint %s is of the last step, %" PetscInt64_FMT ": nothing is left to march\n", scene->restart,
             files->from);
  if (scene->checkpoint[0]) MpmStopInstall();
  if (scene->output[0]) PetscCall(OpenOutput(files, march));
  if (scene->csv[0]) PetscCall(OpenCsv(files, run, before));
  PetscCall(PetscFree(before));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Sample(void *context, const MpmRun *run, const MpmMarch *march,
                             const MpmTransferDiagnostics *exchange, PetscReal log_norm, PetscReal energy)
{
  Files *files = context;

  PetscFunctionBegin;
  if (files->scene->csv[0]) PetscCall(MpmRunCsvRow(run, march, exchange, log_norm, energy, &files->csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Asks for signals only where there is a checkpoint to write. The checkpoint of the last step is written at the end. */
static PetscErrorCode Keep(Files *files, const MpmRun *run, const MpmMarch *march, PetscBool *stop)
{
  const MpmScene *scene = files->scene;
  char           *csv   = NULL;

  PetscFunctionBegin;
  if (!scene->checkpoint[0] || march->step == files->from || march->step == scene->steps)
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmStopAgreed(PETSC_COMM_WORLD, stop));
  if (!*stop && march->step % scene->checkpoint_every) PetscFunctionReturn(PETSC_SUCCESS);
  if (scene->csv[0]) PetscCall(MpmTextFileSoFar(&files->csv, &csv));
  PetscCall(MpmCheckpointWrite(scene->checkpoint, march, run, csv));
  PetscCall(PetscFree(csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Step(void *context, const MpmRun *run, MpmMarch *march, PetscBool *stop)
{
  Files          *files = context;
  const MpmScene *scene = files->scene;

  PetscFunctionBegin;
  if (files->output &&
      (march->step == files->from || march->step % scene->output_every == 0 || march->step == scene->steps))
    PetscCall(MpmOutputStep(files->output, march));
  if (!run->lost) PetscCall(Keep(files, run, march, stop));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A run that was stopped leaves its checkpoint alone. */
static PetscErrorCode End(void *context, const MpmRun *run, MpmMarch *march)
{
  Files          *files = context;
  const MpmScene *scene = files->scene;
  const PetscBool keep  = run->stopped ? PETSC_FALSE : PETSC_TRUE;
  const PetscBool last  = keep && scene->checkpoint[0] && !run->lost ? PETSC_TRUE : PETSC_FALSE;
  char           *csv   = NULL;

  PetscFunctionBegin;
  if (last && scene->csv[0]) PetscCall(MpmTextFileSoFar(&files->csv, &csv));
  if (files->output) PetscCall(MpmOutputDestroy(keep, &files->output));
  if (scene->csv[0] && keep) PetscCall(MpmTextFileClose(&files->csv));
  if (scene->csv[0] && !keep) MpmTextFileDrop(&files->csv);
  if (last) PetscCall(MpmCheckpointWrite(scene->checkpoint, march, run, csv));
  PetscCall(PetscFree(csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRunFilesCreate(const MpmScene *scene, PetscReal started, MpmRun **run)
{
  Files                 files     = {.scene = scene};
  const MpmRunCallbacks callbacks = {.context = &files, .begin = Begin, .sample = Sample, .step = Step, .end = End};

  PetscFunctionBegin;
  if (scene->initial == MPM_INITIAL_EIGENMODE) PetscCall(MpmModeFileCheck(scene));
  if (scene->restart[0]) PetscCall(MpmCheckpointCheck(scene));
  PetscCall(MpmRunCreateWith(scene, &callbacks, started, run));
  PetscFunctionReturn(PETSC_SUCCESS);
}
