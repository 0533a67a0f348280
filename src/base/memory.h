/* Memory: what would not fit is refused before it is asked for, since Linux grants it first and kills later. */
#pragma once
#include <mpmstab/scene.h>

/*
   MpmMemoryCheck - refuses a scene that needs more memory than there is.

   Collective. bytes: of all ranks, who share them evenly; what: the work that needs them.
*/
PetscErrorCode MpmMemoryCheck(MPI_Comm comm, const MpmScene *scene, PetscReal bytes, const char what[]);

/* Collective. The least that a rank may have, if those of a machine share it evenly; INFINITY: not known. */
PetscErrorCode MpmMemoryOfRank(MPI_Comm comm, PetscReal *bytes);

/* Not collective. Least that particles, nodes and output of a march take, on all ranks. */
PetscReal MpmMemoryOfMarch(const MpmScene *scene);
