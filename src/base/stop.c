/* Signals that ask for an end: unlink() and a flag are all that a handler may touch. */
#include "base/stop.h"
#include "base/unfinished.h"
#include <signal.h>

static volatile sig_atomic_t asked;
static PetscBool             stopped;

static void Clean(int signal)
{
  (void)MpmUnfinishedRemove();
  (void)raise(signal); /* its own action is back already */
}

static void Ask(int signal)
{
  (void)signal;
  asked = 1;
}

static void Install(void (*handler)(int))
{
  const int        signals[] = {SIGTERM, SIGHUP, SIGINT, SIGXCPU};
  struct sigaction action    = {.sa_handler = handler, .sa_flags = SA_RESETHAND};

  (void)sigemptyset(&action.sa_mask);
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(signals); i++) (void)sigaction(signals[i], &action, NULL);
}

void MpmStopClean(void)
{
  Install(Clean);
}

void MpmStopInstall(void)
{
  Install(Ask);
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
