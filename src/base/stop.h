/* Stop: what the program does when it is asked to end by SIGTERM, SIGHUP, SIGINT or SIGXCPU. */
#pragma once
#include <mpmstab/compat.h>

/* Not collective. From here on such a signal removes the files that are not finished, and ends the program. */
void MpmStopClean(void);

/* Not collective. From here on the first such signal asks; a second one ends the program. */
void MpmStopInstall(void);

/* Collective. Whether any rank has been asked. */
PetscErrorCode MpmStopAgreed(MPI_Comm comm, PetscBool *stop);

/* Not collective. Whether the ranks have agreed to stop. */
PetscBool MpmStopped(void);
