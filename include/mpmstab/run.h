/* Run: a scene marched to its end, and what came out of it. */
#pragma once
#include <mpmstab/diagnostics.h>
#include <mpmstab/growth.h>
#include <mpmstab/predict.h>

/*S
   MpmRun - the result of the task run.

   energy is NaN or infinite when out of range. blew_up_at_step is the first sampled step at which the norm of
   the state left the range of doubles, or MPM_NEVER; steps may then be fewer than asked when it could not be
   followed.
*/
#define MPM_NEVER -1
typedef struct {
  const MpmScene *scene;
  PetscMPIInt     ranks;
  PetscInt64      steps, blew_up_at_step;
  PetscInt        migrations;
  PetscReal       loop_s, wall_s, energy_initial, energy_final;
  PetscBool       has_errors;
  MpmError        error[MPM_MAX_FIELDS];
  MpmSeries       series;
  MpmGrowth       growth;
  MpmVerdict      verdict;
  MpmPredictions  predictions;
} MpmRun;

/*
   MpmRunCreate - marches a scene, writes the files it asks for, and measures.

   Collective on PETSC_COMM_WORLD. started is the MPI_Wtime at which the program began.
*/
PetscErrorCode MpmRunCreate(const MpmScene *scene, PetscReal started, MpmRun **run);
PetscErrorCode MpmRunDestroy(MpmRun **run);

/* Collective. The table for people, on standard output; the JSON object, when the scene asks for it. */
PetscErrorCode MpmRunPrint(const MpmRun *run);
PetscErrorCode MpmRunWriteJson(const MpmRun *run);

/* Collective. Compares with the scene's expectations; prints each that is missed and counts them. */
PetscErrorCode MpmRunCheckExpectations(const MpmRun *run, PetscInt *missed);
