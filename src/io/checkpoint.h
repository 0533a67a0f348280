/* Checkpoint: a file that holds all that a run needs in order to resume; it is whole or not there. */
#pragma once
#include "march/march_private.h"
#include "analysis/run.h"

/*
   MpmCheckpointWrite - writes the state of a run after a step as PATH; a file that was there before stays until the new
   one is whole and on the disk.

   Collective. The file is HDF5 behind a checksum (checksum.h). It holds the scene as text, particle fields in the order
   in which the ranks hold them, node fields with ghosts, the series behind the growth, and csv, the rows of the run's
   CSV so far (on rank 0; NULL: the run writes none). A run that resumes from it on as many ranks is the same to the last
   bit. Refuses when it cannot be written.
*/
PetscErrorCode MpmCheckpointWrite(const char path[], const MpmMarch *march, const MpmRun *run, const char csv[]);

/*
   MpmCheckpointCheck - refuses a file that is not whole, not of this scene, or of a step beyond the scene's last.

   Collective.
*/
PetscErrorCode MpmCheckpointCheck(const char path[], const MpmScene *scene, PetscInt64 steps);

/*
   MpmCheckpointRead - gives march and run the state that was written. csv: the rows so far, on all ranks, empty where
   the run wrote no CSV; to be freed with PetscFree.

   Collective. On another number of ranks particles go to their owners and nodes are summed anew, which changes the last
   bits.
*/
PetscErrorCode MpmCheckpointRead(const char path[], PetscInt64 steps, MpmMarch *march, MpmRun *run, char **csv);
