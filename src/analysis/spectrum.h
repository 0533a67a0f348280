/* Spectrum: published, corrected, symbol, spectrum and measured growth of a scene, side by side. */
#pragma once
#include "analysis/modes.h"
#include "symbol/predict.h"
#include "analysis/pseudospectrum.h"
#include "analysis/run.h"
#include "analysis/transient.h"

/*S
   MpmSpectrum - the result of the task spectrum. NaN: not computed.

   radius: largest abs of the listed eigenvalues of the operator, growth: per step. symbol is NULL on layouts that are
   not uniform; mismatch from it is the largest distance of a listed eigenvalue from the symbol's set. at_one: listed
   eigenvalues within 1e-6 of 1; nullity: states that no node sees (see MpmModesNullity); both MPM_UNCOUNTED
   unless all eigenvalues are listed, nullity also under drift. condition: of the eigenvalue that the verdict rests
   on; NaN for a stable one. memory: bytes that the task took at its peak, on all ranks. run: random data marched,
   NULL when that was not asked for or would take too long. transient, pseudospectrum: NULL when not asked for, or
   when the operator's numbers leave the range of doubles.
*/
#define MPM_UNCOUNTED -1
typedef struct {
  const MpmScene    *scene;
  const MpmRequest  *request;
  PetscMPIInt        ranks;
  MpmOperator       *op;
  MpmEigen          *eigen;
  MpmSymbol         *symbol;
  MpmRun            *run;
  MpmTransient      *transient;
  MpmPseudospectrum *pseudospectrum;
  MpmPredictor       predictor;
  MpmPredictions     predictions;
  MpmComparison      comparison;
  PetscReal          target[2], radius, growth, max_residual, step_mismatch, symbol_mismatch, condition;
  PetscReal          memory, wall_s;
  PetscInt           at_one, nullity;
  MpmFinding         finding;
} MpmSpectrum;

/*
   MpmSpectrumCreate - assembles a scene's operator, proves it against the march, solves it, and sets it beside the
   rest.

   Collective on PETSC_COMM_WORLD, with SLEPc initialized. started is the MPI_Wtime at which the program began.
*/
PetscErrorCode MpmSpectrumCreate(const MpmScene *scene, const MpmRequest *request, PetscReal started,
                                 MpmSpectrum **spectrum);
PetscErrorCode MpmSpectrumDestroy(MpmSpectrum **spectrum);
