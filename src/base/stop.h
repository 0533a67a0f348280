/* Stop: what the program does when SIGTERM, SIGHUP, SIGINT, SIGXCPU or SIGQUIT asks it to end. */
#pragma once
#include <mpmstab/compat.h>

/* Not collective. From here on such a signal removes the files that are not finished, and ends the program. */
void MpmStopClean(void);

/*
   Not collective. From here on the first such signal only sets a flag, which MpmStopAgreed reads; a second one ends the
   program. SIGQUIT ends it at once.
*/
void MpmStopInstall(void);

/* Collective. Whether any rank has been asked. */
PetscErrorCode MpmStopAgreed(MPI_Comm comm, PetscBool *stop);

/* Not collective. Whether the ranks have agreed to stop. */
PetscBool MpmStopped(void);
