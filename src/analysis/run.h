/* Run: a scene marched to its end, and what came out of it. */
#pragma once
#include "march/diagnostics.h"
#include "march/transfer_diagnostics.h"
#include "analysis/growth.h"
#include "symbol/predict.h"

/*S
   MpmRun - the result of the task run.

   from: the step that a run went on from, 0 without a restart. stopped: SIGTERM ended it, and nothing but the
   checkpoint is of use. eigenmode: growth per step of the eigenvalue that initial eigenmode belongs to, else NaN.
   Energies are NaN when out of range, their ratio is not. blew_up_at_step is the first sampled step at which the norm
   of the state left the range of doubles, or MPM_NEVER. mass_change, momentum_change: of what there was at the start
   of the run (NaN: none to conserve, or the state was lost). lost: one step enlarged the state beyond what rescaling
   can follow, and the run stopped there; growth_above: by how much at least per step. bytes: moved per particle and
   step, if known (traffic.h). exchange_*: of scenes that ask for weights, source term or ringing (see exchange.h).
S*/
#define MPM_NEVER -1
typedef struct {
  const MpmScene *scene;
  PetscMPIInt     ranks;
  PetscInt64      from, steps, blew_up_at_step;
  PetscReal       loop_s, wall_s, energy_initial, energy_final, energy_ratio, log_energy_first, eigenmode;
  PetscReal       mass_change, momentum_change, growth_above, bytes;
  PetscBool       has_errors, lost, stopped;
  MpmError        error[MPM_MAX_FIELDS];
  MpmSeries       series;
  MpmGrowth       growth;
  MpmVerdict      verdict;
  MpmPredictions  predictions;

  MpmTransferDiagnosticsSample exchange_first, exchange_last, exchange_most;
} MpmRun;

/*
   MpmRunCreate - marches a scene, writes the files it asks for, and measures.

   Collective on PETSC_COMM_WORLD. started is the MPI_Wtime at which the program began.
*/
PetscErrorCode MpmRunCreate(const MpmScene *scene, PetscReal started, MpmRun **run);
PetscErrorCode MpmRunDestroy(MpmRun **run);
