/*
   Spectrum: eigenvalues and growth of an operator; of a scene the published, corrected, symbol's, operator's and
   measured growth, compared.
*/
#pragma once
#include "analysis/modes.h"
#include "symbol/predict.h"
#include "analysis/run.h"
#include "analysis/transient.h"

typedef struct MpmCertificates_ MpmCertificates; /* probe/certificates.h */

/*S
   MpmSpectrum - the result of the task spectrum. A number that was not computed is NaN.

   certificates: NULL, or what shows that a matrix of a file is that of a step. scene: NULL for a matrix that was given.
   It then has no symbol, run, predictor, predictions, comparison, step_mismatch, nullity or leading modes. cells: a
   lattice of such a matrix, whose symbol is then taken; else NULL.

   radius: the largest abs of the listed eigenvalues of the operator. growth: the same per step. symbol: NULL on layouts
   that are not uniform. symbol_mismatch: the largest distance of a listed eigenvalue from the symbol's set. at_one: the
   number of listed eigenvalues within 1e-6 of 1. nullity: the dimension of the null space (see MpmModesNullity). Both
   are MPM_UNCOUNTED unless all eigenvalues are listed, and nullity also under drift. condition: that of the eigenvalue
   on which the verdict rests; NaN when the verdict is stable. memory: bytes that the task took at its peak, on all
   ranks, beyond those that it had before.
   nodal: the operator of the nodes, which the eigenvalues were sought of; NULL where they are of the particles'.
   run: a march of random data; NULL when it was not asked for or would take too long. transient, pseudospectrum:
   NULL when not asked for, or when the operator's numbers leave the range of doubles. leading: the modes of the first
   listed eigenvalues, in two and three dimensions; none in one.
S*/
#define MPM_UNCOUNTED -1
typedef struct {
  const MpmScene      *scene;
  const MpmRequest    *request;
  const MpmBlochCells *cells;
  MpmCertificates     *certificates;
  PetscMPIInt          ranks;
  MpmOperator         *op;
  MpmReduced          *nodal;
  MpmEigen            *eigen;
  MpmSymbol           *symbol;
  MpmRun              *run;
  MpmTransient        *transient;
  MpmPseudospectrum   *pseudospectrum;
  MpmPredictor         predictor;
  MpmPredictions       predictions;
  MpmComparison        comparison;
  PetscReal            target[2], radius, growth, max_residual, step_mismatch, symbol_mismatch, condition;
  PetscReal            before, memory, wall_s;
  PetscInt             at_one, nullity;
  MpmFinding           finding;
  MpmModes             leading;
} MpmSpectrum;

/*
   MpmNodalChoiceCheck - refuses the option nodal, true or false, where the task takes no eigenvalues that the nodes'
   own operator could have: of particles that move, of tables and layouts without such an operator, and of critical
   where the symbol has the answer.

   Collective. Errors: PETSC_ERR_USER_INPUT.
*/
PetscErrorCode MpmNodalChoiceCheck(const MpmScene *scene, const MpmRequest *request);

/*
   MpmSpectrumCreate - assembles a scene's operator, checks it against the march, solves for its eigenvalues, and
   compares them with symbol and closed forms.

   Collective on PETSC_COMM_WORLD, with SLEPc initialized. started is the MPI_Wtime at which the program began.
*/
PetscErrorCode MpmSpectrumCreate(const MpmScene *scene, const MpmRequest *request, PetscReal started,
                                 MpmSpectrum **spectrum);

/*
   MpmSpectrumOfMatrix - solves for the eigenvalues of a matrix that covers so many steps, wherever it comes from.

   Collective on PETSC_COMM_WORLD, with SLEPc initialized. what: the matrix, for messages. cells: NULL, or its lattice:
   then the symbol says which eigenvalues are sought, and decides.
*/
PetscErrorCode MpmSpectrumOfMatrix(const char what[], Mat A, PetscInt period, const MpmBlochCells *cells,
                                   const MpmRequest *request, PetscReal started, MpmSpectrum **spectrum);
PetscErrorCode MpmSpectrumDestroy(MpmSpectrum **spectrum);

/*
   MpmFrozenSpectrum - marches a scene of finite kinematics to the request's step at_step, and finds the eigenvalues of
   the tangent of the step after it, as if the state stayed as it is. mismatch: see MpmTangentMismatch. A verdict is
   undecided where the tangent's step is not the march's. Of a material that flows particles may stand on the yield
   surface, where a step has two derivatives: the spectrum is that of loading or unloading, whichever grows more, and
   the evidence says which.

   Collective on PETSC_COMM_WORLD, with SLEPc initialized. Errors: refuses (PETSC_ERR_USER_INPUT) a step that the run
   does not reach.
*/
PetscErrorCode MpmFrozenSpectrum(const MpmScene *scene, const MpmRequest *request, PetscReal started,
                                 MpmSpectrum **spectrum, PetscReal *mismatch);
