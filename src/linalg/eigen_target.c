/* Shift-and-invert near a target: the solver for T of ritz.h, and how T is factored. */
#include "linalg/band_lu.h"
#include "linalg/eigen_target.h"
#include "base/memory.h"

#define NEAR 1       /* eigenvalues sought near a target */
#define NEAR_BASIS 8 /* vectors of the Krylov space near a target: the inverse has one eigenvalue far beyond others */
#define BAND_FILL 16 /* numbers in a band's factors per nonzero, above which it is no band */

/*
   Band LU where T is a band, MUMPS for what is none, for what is too large for one of several ranks, and for solves with
   the transposed, which two-sided solvers take.
*/
static PetscErrorCode SetFactorization(Mat T, const char prefix[], PC pc)
{
  MatInfo     info;
  PetscReal   bytes, available;
  PetscMPIInt ranks;
  PetscBool   two_sided;
  Mat         factor;

  PetscFunctionBegin;
  PetscCall(PCSetOperators(pc, T, T));
  PetscCall(MpmBandLURegister());
  PetscCall(MpmBandLUBytes(T, &bytes));
  PetscCall(MatGetInfo(T, MAT_GLOBAL_SUM, &info));
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)T), &ranks));
  PetscCall(MpmMemoryOfRank(PetscObjectComm((PetscObject)T), &available));
  PetscCall(PetscOptionsHasName(NULL, prefix, "-eps_two_sided", &two_sided));
  if (!two_sided && bytes <= BAND_FILL * info.nz_used * sizeof(PetscScalar) && (ranks == 1 || bytes <= available)) {
    PetscCall(PCFactorSetMatSolverType(pc, MPM_SOLVER_BAND));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  PetscCall(PCFactorSetUpMatSolverType(pc));
  PetscCall(PCFactorGetMatrix(pc, &factor));
  PetscCall(MatMumpsSetIcntl(factor, 14, 100)); /* room for pivots that are put off: T is nearly singular */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The convergence test is SLEPc's own: relative to the eigenvalue of the inverse, not to that of T, which is near 0. */
PetscErrorCode MpmEigenTargetSet(EPS eps, PetscInt restarts)
{
  ST          st;
  KSP         ksp;
  PC          pc;
  Mat         T;
  const char *prefix;

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
  PetscCall(EPSGetOptionsPrefix(eps, &prefix));
  PetscCall(SetFactorization(T, prefix, pc));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A small Krylov space where options have not asked for more eigenvalues or another one. */
PetscErrorCode MpmEigenTargetBasis(EPS eps)
{
  PetscInt wanted, vectors, projected;

  PetscFunctionBegin;
  PetscCall(EPSGetDimensions(eps, &wanted, &vectors, &projected));
  if (wanted == NEAR && vectors <= 0 && projected <= 0)
    PetscCall(EPSSetDimensions(eps, wanted, NEAR_BASIS, PETSC_DETERMINE));
  PetscFunctionReturn(PETSC_SUCCESS);
}
