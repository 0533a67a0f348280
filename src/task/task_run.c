/* The task run: mpmstab run [SCENE.yaml] [-option value]... */
#include <mpmstab/errors.h>
#include "report/results.h"
#include "task/expect.h"
#include "task/run_files.h"
#include "task/task.h"

static void PrintStopped(const MpmRun *run, const MpmRequest *request)
{
  MpmPrint("stopped at step %" PetscInt64_FMT, run->steps);
  if (request->end > 0)
    MpmPrint(", at time %.6g of %.6g", run->time, request->end);
  else
    MpmPrint(" of %" PetscInt64_FMT, request->steps);
  MpmPrint("; to go on: the same command with -restart %s\n", request->checkpoint);
}

PetscErrorCode MpmTaskRun(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmRun *run;

  PetscFunctionBegin;
  PetscCall(MpmRunFilesCreate(scene, request, started, &run));
  *missed = 0;
  if (run->failure[0]) {
    MpmPrintFailure(run->failure);
    *missed = MPM_WORK_FAILED;
  } else if (run->stopped)
    PrintStopped(run, request);
  else {
    PetscCall(MpmRunReport(run));
    PetscCall(MpmExpectRun(run, missed));
  }
  PetscCall(MpmRunDestroy(&run));
  PetscFunctionReturn(PETSC_SUCCESS);
}
