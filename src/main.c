/* Starts MPI and PETSc, finds the task by its name, runs it, and ends the program with its exit status. */
#include <mpmstab/errors.h>
#include "base/launch.h"
#include "probe/plugin_host.h"
#include "scene/settings.h"
#include "base/stop.h"
#include "base/suggest.h"
#include "task/task.h"
#include <signal.h>
#include <stdlib.h>
#include <string.h>

/*
   Refuses -fp_trap: with a trap PETSc would end the program with its stack trace at the first overflow, and an unstable
   scheme overflows as a matter of course.
*/
static PetscErrorCode CheckTrap(void)
{
  PetscBool given;

  PetscFunctionBegin;
  PetscCall(PetscOptionsHasName(NULL, NULL, "-fp_trap", &given));
  if (given) PetscCall(PetscSetFPTrap(PETSC_FP_TRAP_OFF));
  MpmCheckInput(!given, "-fp_trap: a run may leave the range of numbers, and says so; allowed: without it");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Dispatch(int argc, char **argv, PetscReal started, int *status)
{
  const char *names[16], *near;
  PetscInt    n = 0;

  PetscFunctionBegin;
  PetscCall(CheckTrap());
  *status = MPM_EXIT_DONE;
  if (argc > 1 && !strcmp(argv[1], "version")) {
    MpmPrintVersion();
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (argc > 2 && !strcmp(argv[1], "help")) {
    PetscCall(MpmPrintHelp(argv[2]));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (argc < 2 || !strcmp(argv[1], "help")) {
    MpmPrintUsage();
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  *status = MPM_EXIT_FAILED;
  for (; MpmTasks[n].name; n++) {
    names[n] = MpmTasks[n].name;
    if (strcmp(argv[1], MpmTasks[n].name)) continue;
    if (MpmTasks[n].work)
      PetscCall(MpmTaskOnScene(&MpmTasks[n], argc - 2, argv + 2, started, status));
    else
      PetscCall(MpmTasks[n].words(argc - 2, argv + 2));
    if (!MpmTasks[n].work) *status = MPM_EXIT_DONE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  near = MpmSuggest(argv[1], n, names);
  PetscCall(MpmSuggestRefuse(NULL, n, names, "unknown task '%s'%s%s%s; allowed: ", argv[1],
                             near ? "; did you mean '" : "", near ? near : "", near ? "'?" : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  int            status = MPM_EXIT_FAILED;
  char         **words;
  PetscErrorCode ierr;

  MpmLaunchStandardFiles();
  if (argc == 3 && !strcmp(argv[1], MPM_PLUGIN_HOST)) return MpmPluginHost(argv[2]);
  if (!MpmLaunchOptionFiles(argc, argv)) return MPM_EXIT_REFUSED;
  if (MpmWordsRead(&argc, &argv)) return MPM_EXIT_FAILED; /* PETSc would answer -help and -version by itself */
  words = argv;
  if (!MpmWordsCheckViewers(argc, argv)) return MPM_EXIT_REFUSED;
  if (MpmInitialize(&argc, &argv)) return MPM_EXIT_REFUSED;
  (void)signal(SIGPIPE, SIG_IGN); /* '| head' ends the reader, not the work; PETSc would print a stack trace */
  (void)signal(SIGXFSZ, SIG_IGN); /* writing beyond 'ulimit -f' then fails like any other write */
  MpmStopClean();                 /* a signal that asks for an end leaves no stack trace either */
  ierr   = Dispatch(argc, argv, MPI_Wtime(), &status);
  status = MpmFinalize(ierr, status);
  free(words);
  return status;
}
