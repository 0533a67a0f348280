/* Checkpoint: a file that holds all that a run needs in order to resume. It appears whole or not at all. */
#pragma once
#include "march/march_private.h"
#include "analysis/run.h"

/*
   MpmCheckpointWrite - writes the state of a run after a step to the file PATH. An earlier file of this name stays
   until the new one is whole and on the disk.

   Collective. Refuses when it cannot be written. The file is HDF5 behind a checksum. It holds the scene as
   text, particle fields in the order in which the ranks hold them, node fields with ghosts, the series for the fit of
   growth, and csv: the rows of the run's CSV so far (on rank 0; NULL when the run writes none). A run that resumes on
   as many ranks has the same results to the last bit.
*/
PetscErrorCode MpmCheckpointWrite(const char path[], const MpmMarch *march, const MpmRun *run, const char csv[]);

/*
   MpmCheckpointCheck - refuses a file that is not whole, belongs to another scene, or is of a step beyond the scene's
   last.

   Collective.
*/
PetscErrorCode MpmCheckpointCheck(const char path[], const MpmScene *scene, PetscInt64 steps);

/*
   MpmCheckpointRead - gives march and run the state that was written. csv: the rows so far, on all ranks, empty where
   the run wrote no CSV. Free it with PetscFree.

   Collective. On another number of ranks particles move to their owners and node values are summed again, which changes
   the last bits.
*/
PetscErrorCode MpmCheckpointRead(const char path[], PetscInt64 steps, MpmMarch *march, MpmRun *run, char **csv);
