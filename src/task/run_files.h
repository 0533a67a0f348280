/* The files of a run: what it starts from, what it writes, and what it resumes from. */
#pragma once
#include "analysis/run.h"

/*
   MpmRunFilesCreate - marches a scene, reads and writes the files that it names, and measures.

   Collective on PETSC_COMM_WORLD. The files that it starts from must have been checked (see tasks.c). A run that a
   signal has stopped (run->stopped) leaves its checkpoint and no other file. started: see MpmRunCreate.
*/
PetscErrorCode MpmRunFilesCreate(const MpmScene *scene, const MpmRequest *request, PetscReal started, MpmRun **run);
