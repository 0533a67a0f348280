/* The files of a run: where it starts from, what it writes, and how it is resumed. */
#pragma once
#include "analysis/run.h"

/*
   MpmRunFilesCreate - marches a scene, reads and writes the files that it names, and measures.

   Collective on PETSC_COMM_WORLD. Refuses a checkpoint to resume from, or a mode file, that is not of this scene,
   before it marches. A run that a signal has stopped (run->stopped) leaves its checkpoint and no other
   file. started: see MpmRunCreate.
*/
PetscErrorCode MpmRunFilesCreate(const MpmScene *scene, PetscReal started, MpmRun **run);
