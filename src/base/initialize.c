/* Starts and ends MPI, PETSc and SLEPc for a program that uses this library. */
#include "base/errors_private.h"
#include "base/launch.h"
#include "base/textfile.h"
#include "base/unfinished.h"
#include <slepcsys.h>

PetscErrorCode MpmInitialize(int *argc, char ***argv)
{
  PetscErrorCode ierr;

  MpmLaunchAlone();
  if (!MpmLaunchMemory()) return PETSC_ERR_MEM;
  ierr = MpmErrorsOutside();
  if (!ierr) ierr = SlepcInitialize(argc, argv, NULL, NULL);
  return ierr ? ierr : MpmErrorsInstall();
}

int MpmFinalize(PetscErrorCode error, int status)
{
  if (error) {
    MpmUnfinishedRemove();
    MpmTextFileAbandon();
    status = MpmErrorsStatus(error);
  }
  if (error && error != PETSC_ERR_USER_INPUT) MpmErrorsEnd(status); /* the other ranks may be waiting */
  (void)PetscPopErrorHandler();
  if (MpmErrorsReportLost()) status = MPM_EXIT_FAILED;
  return SlepcFinalize() ? MPM_EXIT_REFUSED : status;
}
