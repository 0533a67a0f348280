/* Memory: a task that would not fit is refused before it starts, since Linux grants memory first and kills later. */
#pragma once
#include <mpmstab/compat.h>

/*
   MpmMemoryCheck - refuses work that needs more memory than there is.

   Collective. bytes: the sum over all ranks, which share it evenly. The message is 'size: what needs so many GB': size
   names the options that determine the need, and what names the work.
*/
PetscErrorCode MpmMemoryCheck(MPI_Comm comm, const char size[], PetscReal bytes, const char what[]);

/*
   MpmMemoryRoom - says in why that this rank alone has no room for so many bytes of a file, and what is allowed. Else
   why stays as it is.

   Not collective.
*/
void MpmMemoryRoom(PetscReal bytes, size_t room, char why[]);

/*
   MpmMemoryCheckLapack - refuses when the shell grants less address space (ulimit -v) than the buffer that OpenBLAS
   asks for at its first call. OpenBLAS would ask for it again and again, for ever.

   Collective on PETSC_COMM_WORLD.
*/
PetscErrorCode MpmMemoryCheckLapack(void);
