/* SIGTERM sets a flag that ranks agree on. */
#include <mpmstab/stop.h>
#include <signal.h>

static volatile sig_atomic_t asked;
static PetscBool             stopped;

static void Ask(int signal)
{
  (void)signal;
  asked = 1;
}

void MpmStopInstall(void)
{
  (void)signal(SIGTERM, Ask);
}

PetscErrorCode MpmStopAgreed(MPI_Comm comm, PetscBool *stop)
{
  int any = asked;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, comm));
  *stop = stopped = any ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool MpmStopped(void)
{
  return stopped;
}
