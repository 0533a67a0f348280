/* Checkpoint: all that a run goes on with, in a file that is whole or not there. */
#pragma once
#include "march/march_private.h"
#include "analysis/run.h"

/*
   MpmCheckpointWrite - the state of a run after a step, as PATH; what was there before stays until the new one is whole
   and on the disk.

   Collective. HDF5 behind a seal (seal.h): scene as text, particle fields in the order in which the ranks hold them,
   node fields with ghosts, the series behind the growth, and csv, what has been written of the run's CSV (rank 0; NULL:
   none). A run that goes on from it on as many ranks is the same to the last bit. Refuses when it cannot be written.
*/
PetscErrorCode MpmCheckpointWrite(const char path[], const MpmMarch *march, const MpmRun *run, const char csv[]);

/*
   MpmCheckpointCheck - refuses a file that is not whole, not of this scene, or that the scene's steps do not go beyond.

   Collective. scene->restart names it.
*/
PetscErrorCode MpmCheckpointCheck(const MpmScene *scene);

/*
   MpmCheckpointRead - takes march and run to where they were. csv: to be freed with PetscFree, empty where there was
   none; on all ranks.

   Collective. On another number of ranks particles go to their owners and nodes are summed anew, which changes the last
   bits.
*/
PetscErrorCode MpmCheckpointRead(const char path[], MpmMarch *march, MpmRun *run, char **csv);
