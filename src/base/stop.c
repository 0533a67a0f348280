/*
   Handlers of signals that ask the program to end. They call nothing but unlink, sigaction and raise, and set a flag.
*/
#include "base/stop.h"
#include "base/textfile.h"
#include <signal.h>

static volatile sig_atomic_t asked;
static PetscBool             stopped;

static const int signals[] = {SIGTERM, SIGHUP, SIGINT, SIGXCPU, SIGQUIT};

/*
   Removes the unfinished files and raises the signal again. Its default action is in place by then, so the program ends
   as if there were no handler.
*/
static void Clean(int signal)
{
  MpmUnfinishedRemove();
  (void)raise(signal);
}

static void Install(int signal, void (*handler)(int))
{
  struct sigaction action = {.sa_handler = handler, .sa_flags = SA_RESETHAND};

  (void)sigemptyset(&action.sa_mask);
  (void)sigaction(signal, &action, NULL);
}

/* Sets the flag. A second signal ends the program at once, and still leaves no unfinished file. */
static void Ask(int signal)
{
  asked = 1;
  Install(signal, Clean);
}

void MpmStopClean(void)
{
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(signals); i++) Install(signals[i], Clean);
}

void MpmStopInstall(void)
{
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(signals); i++)
    if (signals[i] != SIGQUIT) Install(signals[i], Ask);
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
