/* Stop: a run that is asked to end by SIGTERM ends after the step it is in. */
#pragma once
#include <mpmstab/compat.h>

/* Not collective. From here on SIGTERM asks, instead of ending the program. */
void MpmStopInstall(void);

/* Collective. Whether any rank has been asked. */
PetscErrorCode MpmStopAgreed(MPI_Comm comm, PetscBool *stop);

/* Not collective. Whether the ranks have agreed to stop. */
PetscBool MpmStopped(void);
