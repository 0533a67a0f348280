/* Checkpoint file: what every rank holds of a checkpoint while it is read, and the checks on it. */
#pragma once
#include "analysis/pace.h"

/*
   The entries of the array 'where': the step, the step to which the particles' places belong, the whole cells of drift
   that the stored cells include, the exponent of the state, and the step of the blow-up.
*/
enum { MPM_AT_STEP, MPM_AT_PLACES, MPM_AT_REBASED, MPM_AT_EXPONENT, MPM_AT_BLEW_UP, MPM_WHERE };

/* The whole cells of drift are those along x. Where there are further directions, theirs follow at the end. */
#define MPM_WHERE_OF(dim) (MPM_WHERE + (dim)-1)
static inline PetscInt MpmAtRebased(PetscInt axis)
{
  return axis == 0 ? MPM_AT_REBASED : MPM_WHERE + axis - 1;
}

/* The entries of the array 'numbers'. */
enum { MPM_ENERGY_FIRST, MPM_ENERGY_LAST, MPM_ENERGY_RATIO, MPM_LOG_ENERGY_FIRST, MPM_NUMBERS };

/*
   The entries of the array 'pace' of a run that chooses its steps: the sum of their Courant numbers, that of the last
   one, and what MpmPace says of them.
*/
enum {
  MPM_PACE_ELAPSED,
  MPM_PACE_COURANT,
  MPM_PACE_LEAST,
  MPM_PACE_LARGEST,
  MPM_PACE_SUM,
  MPM_PACE_TOLD,
  MPM_PACE_HOLDS, /* MpmPaceHeld */
  MPM_PACE_CHANGES = MPM_PACE_HOLDS + MPM_PACE_HELD,
  MPM_PACE_TAKEN,
  MPM_PACE_NUMBERS = MPM_PACE_TAKEN + MPM_PACE_REASONS
};

/*S
   MpmCheckpoint - all of a checkpoint except for particles and nodes.

   scene, csv: text that ends with a zero. The samples are those of MpmSeries. For each rank that wrote: the number of
   its particles, and that of its nodes with ghosts.
S*/
typedef struct {
  const char *path;
  PetscInt64  where[MPM_WHERE_OF(MPM_MAX_DIM)], scene_length, csv_length, samples, ranks;
  PetscInt64 *sample_step, *rank_particles, *rank_nodes;
  PetscReal   numbers[MPM_NUMBERS], pace[MPM_PACE_NUMBERS], watch[MPM_PACE_HELD], *log_state, *log_grid;
  char       *scene, *csv;
  PetscBool   watched; /* watch has been read */
} MpmCheckpoint;

#define MPM_CHECKSUM_BYTES 512

/*
   MpmChecksumWrite - sums up what follows the first MPM_CHECKSUM_BYTES of a file, and writes its kind, size and sum
   there.

   Collective; each rank reads a part of the file. error: the errno of the first rank, on all ranks; it is 0 when all of
   the file is on the disk.
*/
PetscErrorCode MpmChecksumWrite(MPI_Comm comm, const char path[], int *error);

/*
   MpmChecksumCheck - checks that a file begins with a checksum and that its bytes have this sum.

   Collective. why: what is wrong, in words that follow 'checkpoint PATH: '; empty when nothing is wrong. room: the size
   of why in bytes.
*/
PetscErrorCode MpmChecksumCheck(MPI_Comm comm, const char path[], size_t room, char why[]);

/*
   MpmCheckpointCheckRun - refuses a checkpoint of another scene, and numbers that no run can have.

   Not collective; all ranks hold the same data and decide alike.
*/
PetscErrorCode MpmCheckpointCheckRun(const MpmScene *scene, PetscInt64 steps, const MpmCheckpoint *file);

/* Not collective. Refuses numbers that no run has that chooses its steps. */
PetscErrorCode MpmCheckpointCheckPace(const MpmCheckpoint *file);
PetscErrorCode MpmCheckpointCheckWatch(const MpmCheckpoint *file);

/*
   MpmCheckpointCheckState - refuses particles and nodes from which the march could not resume.

   Collective. same: each rank has read what it wrote itself, with particles in the order of their cells and with nodes.
   mass: the sum of the nodal masses before the checkpoint was read.
*/
PetscErrorCode MpmCheckpointCheckState(const MpmMarch *march, PetscBool same, PetscReal mass, const char path[]);
