/* Starts MPI and PETSc, finds the task by its name, and ends in one line whatever has gone wrong. */
#include <mpmstab/errors.h>
#include "base/launch.h"
#include "scene/settings.h"
#include "base/stop.h"
#include "base/suggest.h"
#include "task/task.h"
#include <signal.h>
#include <string.h>

/* A trap would end the program in PETSc's stack trace at the first overflow, which unstable schemes are about. */
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

  MpmLaunchStandardFiles();
  if (!MpmLaunchOptionFiles(argc, argv)) return MPM_EXIT_REFUSED;
  for (int i = 1; i < argc; i++) /* PETSc would end the program, with its own version or hundreds of lines of help */
    if (!strcmp(argv[i], "-help") || !strcmp(argv[i], "--help") || !strcmp(argv[i], "-h") ||
        !strcmp(argv[i], "-version") || !strcmp(argv[i], "--version")) {
      static char help[] = "help";

      argv[1] = help;
      argc    = 2;
    }
  if (MpmInitialize(&argc, &argv)) return MPM_EXIT_REFUSED;
  (void)signal(SIGPIPE, SIG_IGN); /* '| head' ends the reading, not the work; PETSc would print a stack trace */
  (void)signal(SIGXFSZ, SIG_IGN); /* a file that grows beyond 'ulimit -f' is an error of writing like any other */
  MpmStopClean();                 /* nor is there a trace at an end that was asked for */
  ierr = Dispatch(argc, argv, MPI_Wtime(), &status);
  return MpmFinalize(ierr, status);
}
