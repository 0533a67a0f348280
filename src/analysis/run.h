/* Run: a scene marched to its end, and the results. */
#pragma once
#include "march/diagnostics.h"
#include "march/transfer_diagnostics.h"
#include "analysis/growth.h"
#include "analysis/pace.h"
#include "analysis/tangents.h"
#include "symbol/predict.h"

/*S
   MpmRun - the result of the task run.

   from: the step at which this run began, 0 unless it resumed from a checkpoint. steps, time: those at its end. last:
   the number of its last step; of a run that ends at a time it is known when this step begins, and larger before.
   stopped: a signal ended it before its last step. pace: how a run has chosen its steps, or NULL where they are all
   alike; watch: the bound that these were compared with, or NULL. eigenmode: growth per step of the eigenvalue of the
   mode that initial eigenmode starts from, else NaN.

   Energies are NaN when out of range; their ratio is still known then. blew_up_at_step: the first sampled step at which
   the norm of the state left the range of doubles, or MPM_NEVER. mass_change, momentum_change: relative to the start of
   the run; NaN when there was none to conserve, or when the state was lost. lost: one step enlarged the state beyond
   what rescaling can follow, and the run stopped there. growth_above: a lower bound of that step's growth. bytes: moved
   per particle and step, if known (march/passes.h). load: the largest number of particles that a rank had, over the
   mean. relaxed: the number of steps whose increments had a factor below 1 (march/adapt.h), and least_factor the least
   of these factors. transfer_first, transfer_last, transfer_most: the transfer diagnostics, in scenes that ask for
   weights, source term or ringing (transfer_diagnostics.h). tangents: of a run that was asked for its tangent, else
   NULL. iterations, newton, solve_s: of the systems of an implicit step, of all steps of this run. halved: the steps
   that were taken in parts, and parts the most that one of them had.
S*/
#define MPM_NEVER -1
typedef struct {
  const MpmScene   *scene;
  const MpmRequest *request; /* NULL when the run was only marched and measured */
  PetscMPIInt       ranks;
  PetscInt64        from, steps, last, blew_up_at_step;
  PetscReal         time, loop_s, wall_s, energy_initial, energy_final, energy_ratio, log_energy_first, eigenmode;
  PetscReal         mass_change, momentum_change, growth_above, bytes, load, least_factor, solve_s;
  PetscInt64        relaxed, iterations, newton, halved, parts;
  PetscBool         has_errors, lost, stopped;
  char              failure[512]; /* which particle ended a run at finite deformation, and why; empty: none */
  MpmError          error[MPM_MOST_ERRORS];
  MpmSeries         series;
  MpmGrowth         growth;
  MpmVerdict        verdict;
  MpmPredictions    predictions;
  MpmTangents      *tangents;
  MpmPace          *pace, *watch;

  MpmTransferDiagnosticsSample transfer_first, transfer_last, transfer_most;
} MpmRun;

/*S
   MpmRunCallbacks - what a caller does while a run marches: restarts, files, signals. The march itself does none of
   that.

   Each function is collective and gets context. A function that is NULL is not called. The time that sample and step
   take does not count in run->loop_s.

   begin: called when the march has the scene's initial data. It may replace them and the run's series by those of a
   checkpoint; it fills the initial data of an eigenmode. sample: called when norm and energy of a step have been
   recorded. log_norm is the logarithm of the state's norm; diagnostics is NULL where the scene asks for none. step:
   called after begin and after each step. run->lost says that the run cannot follow its state and ends there; setting
   stop ends the run. end: called when the march is at its end or was stopped (run->stopped). silent: the run prints
   nothing while it marches.
S*/
typedef struct {
  void *context;
  PetscErrorCode (*begin)(void *context, MpmRun *run, MpmMarch *march);
  PetscErrorCode (*sample)(void *context, const MpmRun *run, const MpmMarch *march,
                           const MpmTransferDiagnostics *diagnostics, PetscReal log_norm, PetscReal energy);
  PetscErrorCode (*step)(void *context, const MpmRun *run, MpmMarch *march, PetscBool *stop);
  PetscErrorCode (*end)(void *context, const MpmRun *run, MpmMarch *march);
  PetscBool silent;
} MpmRunCallbacks;

/*
   MpmRunCreate - marches a scene, measures, and calls the callbacks (NULL: none), which read and write files.

   Collective on PETSC_COMM_WORLD. started is the MPI_Wtime at which the program began. Of the request it reads steps,
   tolerance and what is to be measured.
*/
PetscErrorCode MpmRunCreate(const MpmScene *scene, const MpmRequest *request, const MpmRunCallbacks *callbacks,
                            PetscReal started, MpmRun **run);

/*
   MpmRunRandom - marches a scene for some steps from random data, which excite every mode, and measures growth.

   Collective on PETSC_COMM_WORLD. It writes no file and computes no prediction.
*/
PetscErrorCode MpmRunRandom(const MpmScene *scene, PetscInt64 steps, PetscReal tolerance, MpmRun **run);
PetscErrorCode MpmRunDestroy(MpmRun **run);
