/* Run: a scene marched to its end, and what came out of it. */
#pragma once
#include "march/diagnostics.h"
#include "march/transfer_diagnostics.h"
#include "analysis/growth.h"
#include "symbol/predict.h"

/*S
   MpmRun - the result of the task run.

   from: the step at which this run began, 0 unless it resumed from a checkpoint. stopped: a signal ended it before its
   last step. eigenmode: growth per step of the eigenvalue that initial eigenmode belongs to, else NaN.
   Energies are NaN when out of range, their ratio is not. blew_up_at_step is the first sampled step at which the norm
   of the state left the range of doubles, or MPM_NEVER. mass_change, momentum_change: of what there was at the start
   of the run (NaN: none to conserve, or the state was lost). lost: one step enlarged the state beyond what rescaling
   can follow, and the run stopped there; growth_above: by how much at least per step. bytes: moved per particle and
   step, if known (traffic.h). exchange_*: of scenes that ask for weights, source term or ringing (see exchange.h).
S*/
#define MPM_NEVER -1
typedef struct {
  const MpmScene   *scene;
  const MpmRequest *request; /* NULL: only marched and measured */
  PetscMPIInt       ranks;
  PetscInt64        from, steps, blew_up_at_step;
  PetscReal         loop_s, wall_s, energy_initial, energy_final, energy_ratio, log_energy_first, eigenmode;
  PetscReal         mass_change, momentum_change, growth_above, bytes;
  PetscBool         has_errors, lost, stopped;
  MpmError          error[MPM_MAX_FIELDS];
  MpmSeries         series;
  MpmGrowth         growth;
  MpmVerdict        verdict;
  MpmPredictions    predictions;

  MpmTransferDiagnosticsSample exchange_first, exchange_last, exchange_most;
} MpmRun;

/*S
   MpmRunCallbacks - what a caller does while a run marches: restarts, files, signals. The march knows nothing of them.

   Each function is collective and gets context; one that is NULL is left out. begin: the march has the scene's initial
   data; it may replace them and the run's series by those of a checkpoint, and fills what an eigenmode starts from.
   sample: norm and energy of a step were recorded; log_norm is the logarithm of the state's norm, and exchange is NULL
   where the scene asks for none. step: after begin, and after each step; run->lost says that the run cannot follow its
   state and ends there; stop asks it to end. end: the march is at its end, or was stopped (run->stopped). The time that
   sample and step take is no part of run->loop_s.
S*/
typedef struct {
  void *context;
  PetscErrorCode (*begin)(void *context, MpmRun *run, MpmMarch *march);
  PetscErrorCode (*sample)(void *context, const MpmRun *run, const MpmMarch *march,
                           const MpmTransferDiagnostics *exchange, PetscReal log_norm, PetscReal energy);
  PetscErrorCode (*step)(void *context, const MpmRun *run, MpmMarch *march, PetscBool *stop);
  PetscErrorCode (*end)(void *context, const MpmRun *run, MpmMarch *march);
} MpmRunCallbacks;

/*
   MpmRunCreate - marches a scene, measures, and lets the callbacks (NULL: none) read and write files.

   Collective on PETSC_COMM_WORLD. started is the MPI_Wtime at which the program began. Of the request it reads steps,
   tolerance and what is to be measured.
*/
PetscErrorCode MpmRunCreate(const MpmScene *scene, const MpmRequest *request, const MpmRunCallbacks *callbacks,
                            PetscReal started, MpmRun **run);

/*
   MpmRunRandom - marches a scene from random data, which excite every mode, for a number of steps, and measures growth.

   Collective on PETSC_COMM_WORLD. It writes no file and predicts nothing.
*/
PetscErrorCode MpmRunRandom(const MpmScene *scene, PetscInt64 steps, PetscReal tolerance, MpmRun **run);
PetscErrorCode MpmRunDestroy(MpmRun **run);
