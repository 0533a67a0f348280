/* Memory: a task that would not fit is refused before it starts, since Linux grants memory first and kills later. */
#pragma once
#include <mpmstab/compat.h>

/*
   MpmMemoryCheck - refuses work that needs more memory than there is.

   Collective. bytes: of all ranks, who share them evenly. The message is 'size: what needs so many GB', so size names
   the options that decide, and what names the work.
*/
PetscErrorCode MpmMemoryCheck(MPI_Comm comm, const char size[], PetscReal bytes, const char what[]);

/*
   Collective. Finds how many bytes a rank may use if the ranks of a machine share it evenly, the least of all ranks;
   INFINITY: not known.
*/
PetscErrorCode MpmMemoryOfRank(MPI_Comm comm, PetscReal *bytes);

/*
   MpmMemoryCheckLapack - refuses when the shell grants less address space (ulimit -v) than the buffer that OpenBLAS asks
   for at its first call: it would ask for it for ever.

   Collective on PETSC_COMM_WORLD.
*/
PetscErrorCode MpmMemoryCheckLapack(void);
