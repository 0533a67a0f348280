/* Tasks by name. */
#include <mpmstab/errors.h>
#include "base/launch.h"
#include "scene/settings.h"
#include "base/stop.h"
#include "base/suggest.h"
#include "task/task.h"
#include "base/unfinished.h"
#include <signal.h>
#include <string.h>

static PetscErrorCode Dispatch(int argc, char **argv, PetscReal started, int *status)
{
  const char *names[16], *near;
  PetscInt    n = 0;

  PetscFunctionBegin;
  if (argc < 2 || !strcmp(argv[1], "help")) {
    PetscCall(MpmPrintUsage());
    *status = MPM_EXIT_DONE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (; MpmTasks[n].name; n++) {
    names[n] = MpmTasks[n].name;
    if (strcmp(argv[1], MpmTasks[n].name)) continue;
    PetscCall(MpmTasks[n].run(argc - 2, argv + 2, started, status));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  near = MpmSuggest(argv[1], n, names);
  MpmRefuse("unknown task '%s'%s%s%s; 'mpmstab' alone shows what there is", argv[1], near ? "; did you mean '" : "",
            near ? near : "", near ? "'?" : "");
}

int main(int argc, char **argv)
{
  int            status = MPM_EXIT_FAILED;
  PetscErrorCode ierr;
  PetscReal      started;

  for (int i = 1; i < argc; i++) /* PETSc would end the program, with its own version or hundreds of lines of help */
    if (!strcmp(argv[i], "-help") || !strcmp(argv[i], "--help") || !strcmp(argv[i], "-h") ||
        !strcmp(argv[i], "-version") || !strcmp(argv[i], "--version")) {
      static char help[] = "help";

      argv[1] = help;
      argc    = 2;
    }
  MpmLaunchAlone();
  if (MpmErrorsOutside()) return MPM_EXIT_FAILED;
  ierr = PetscInitialize(&argc, &argv, NULL, NULL);
  if (ierr) return MPM_EXIT_REFUSED;
  (void)signal(SIGPIPE, SIG_IGN); /* '| head' ends the reading, not the work; PETSc would print a stack trace */
  MpmStopClean();                 /* nor at an end that was asked for */
  started = MPI_Wtime();
  ierr    = MpmErrorsInstall();
  if (!ierr) ierr = Dispatch(argc, argv, started, &status);
  if (ierr) (void)MpmUnfinishedRemove();
  if (ierr == PETSC_ERR_USER_INPUT)
    status = MPM_EXIT_REFUSED;
  else if (ierr)
    MPI_Abort(PETSC_COMM_WORLD, MPM_EXIT_FAILED);
  (void)PetscPopErrorHandler();
  if (MpmErrorsReportLost()) status = MPM_EXIT_FAILED;
  ierr = PetscFinalize();
  return ierr ? MPM_EXIT_REFUSED : status;
}
