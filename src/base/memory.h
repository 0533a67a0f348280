/* Memory: what would not fit is refused before it is asked for, since Linux grants it first and kills later. */
#pragma once
#include <mpmstab/compat.h>

/*
   MpmMemoryCheck - refuses work that needs more memory than there is.

   Collective. bytes: of all ranks, who share them evenly. The message is 'size: what needs so many GB', so size names
   the options that decide, and what names the work.
*/
PetscErrorCode MpmMemoryCheck(MPI_Comm comm, const char size[], PetscReal bytes, const char what[]);

/* Collective. The least that a rank may have, if those of a machine share it evenly; INFINITY: not known. */
PetscErrorCode MpmMemoryOfRank(MPI_Comm comm, PetscReal *bytes);
