/* Shift-and-invert near a target: sets up the solver for the matrix T of ritz.h, and chooses how T is factored. */
#include "linalg/band_lu.h"
#include "linalg/eigen_target.h"
#include "base/memory.h"

#define NEAR 1       /* eigenvalues sought near a target */
#define NEAR_BASIS 8 /* vectors of the Krylov space: the inverse has one eigenvalue far beyond others */
#define BAND_FILL 16 /* numbers in the factors per nonzero of T; with more, T is not treated as a band */

/*
   Takes band LU where T is a band. Takes MUMPS where T is no band, where the factors are too large for one of several
   ranks, and for two-sided solvers, which also solve with the transposed matrix.
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
  PetscCall(MatMumpsSetIcntl(factor, 14, 100)); /* percent more room for delayed pivots, as T is nearly singular */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The convergence test stays SLEPc's own. It is relative to the eigenvalue of the inverse, not to that of T, which is
   near 0.
*/
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
