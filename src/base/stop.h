/* Stop: what the program does when SIGTERM, SIGHUP, SIGINT, SIGXCPU or SIGQUIT asks it to end. */
#pragma once
#include <mpmstab/compat.h>

/* Not collective. After this call such a signal removes the files that are not finished, and ends the program. */
void MpmStopClean(void);

/*
   Not collective. After this call the first such signal only sets a flag, which MpmStopAgreed reads; a second one ends
   the program. SIGQUIT ends it at once.
*/
void MpmStopInstall(void);

/* Collective. Sets stop when any rank has received such a signal. */
PetscErrorCode MpmStopAgreed(MPI_Comm comm, PetscBool *stop);

/* Not collective. Returns whether the ranks have agreed to stop. */
PetscBool MpmStopped(void);
