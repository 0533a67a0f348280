/* Shift-and-invert near a target: sets up the solver for the matrix T of ritz.h. */
#include "linalg/eigen_target.h"

#define NEAR 1       /* eigenvalues sought near a target */
#define NEAR_BASIS 8 /* vectors of the Krylov space: the inverse has one eigenvalue far beyond others */

/*
   The convergence test stays SLEPc's own. It is relative to the eigenvalue of the inverse, not to that of T, which is
   near 0.
*/
PetscErrorCode MpmEigenTargetSet(EPS eps, PetscInt restarts)
{
  ST  st;
  KSP ksp;
  PC  pc;
  Mat T, factor;

  PetscFunctionBegin;
  PetscCall(EPSSetType(eps, EPSKRYLOVSCHUR));
  PetscCall(EPSSetTarget(eps, 0));
  PetscCall(EPSSetWhichEigenpairs(eps, EPS_TARGET_MAGNITUDE));
  PetscCall(EPSSetDimensions(eps, NEAR, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(EPSSetTolerances(eps, 1e-6, restarts));
  PetscCall(EPSGetST(eps, &st));
  PetscCall(STSetType(st, STSINVERT));
  PetscCall(STGetKSP(st, &ksp));
  PetscCall(KSPSetType(ksp, KSPPREONLY));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCLU));
  PetscCall(EPSGetOperators(eps, &T, NULL));
  PetscCall(PCSetOperators(pc, T, T));
  PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  PetscCall(PCFactorSetUpMatSolverType(pc));
  PetscCall(PCFactorGetMatrix(pc, &factor));
  PetscCall(MatMumpsSetIcntl(factor, 14, 100)); /* percent more room for delayed pivots, as T is nearly singular */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets a small Krylov space, unless options have asked for more eigenvalues or another space. */
PetscErrorCode MpmEigenTargetBasis(EPS eps)
{
  PetscInt wanted, vectors, projected;

  PetscFunctionBegin;
  PetscCall(EPSGetDimensions(eps, &wanted, &vectors, &projected));
  if (wanted == NEAR && vectors <= 0 && projected <= 0)
    PetscCall(EPSSetDimensions(eps, wanted, NEAR_BASIS, PETSC_DETERMINE));
  PetscFunctionReturn(PETSC_SUCCESS);
}
