/*
   The eigenvalues of A near a + ib are those of T = (A - a I)^2 + b^2 I near 0. An eigenvector x of T need not be one
   of A: where T's eigenvalue is real, x mixes the eigenvectors for a + iw and a - iw. But the span of x and A x is
   invariant under A, since (A - a I)^2 x is a multiple of x. So Rayleigh-Ritz on this span gives eigenpairs of A.
*/
#include "linalg/small_eigen.h"
#include "linalg/eigen_parts.h"
#include <math.h>

#define NEAR 1       /* eigenvalues sought near a target */
#define NEAR_BASIS 8 /* vectors of the Krylov space: the inverse has one eigenvalue far beyond others */
#define REAL 1e-6    /* a target is real when im is below this part of re */

PetscErrorCode MpmRitzMatrix(Mat A, const PetscReal target[2], Mat *T)
{
  Mat shifted;

  PetscFunctionBegin;
  PetscCall(MatDuplicate(A, MAT_COPY_VALUES, &shifted));
  PetscCall(MatShift(shifted, -target[0]));
  if (fabs(target[1]) <= REAL * fabs(target[0])) { /* T would be a square, with all its eigenvalues double */
    *T = shifted;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatMatMult(shifted, shifted, MAT_INITIAL_MATRIX, PETSC_DETERMINE, T));
  PetscCall(MatShift(*T, target[1] * target[1]));
  PetscCall(MatDestroy(&shifted));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Appends to the basis the part of x that is orthogonal to it, unless that is negligible. */
static PetscErrorCode Append(BV basis, PetscInt *n, Vec x)
{
  PetscReal norm;
  PetscBool dependent;

  PetscFunctionBegin;
  PetscCall(VecNorm(x, NORM_2, &norm));
  if (norm == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecScale(x, 1 / norm));
  PetscCall(BVInsertVec(basis, *n, x));
  PetscCall(BVSetActiveColumns(basis, 0, *n + 1));
  PetscCall(BVOrthogonalizeColumn(basis, *n, NULL, &norm, &dependent));
  if (dependent || norm < 1e-6) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BVScaleColumn(basis, *n, 1 / norm));
  (*n)++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An orthonormal basis of the given vectors and their images. The vectors are scaled. */
static PetscErrorCode Span(Mat A, PetscInt given, Vec x[], BV basis, PetscInt *n)
{
  Vec y;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(A, NULL, &y));
  *n = 0;
  for (PetscInt i = 0; i < given; i++) {
    PetscCall(MatMult(A, x[i], y));
    PetscCall(Append(basis, n, x[i]));
    PetscCall(Append(basis, n, y));
  }
  PetscCall(VecDestroy(&y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes eigenvalues and vectors of H = basis^T A basis. */
static PetscErrorCode SolveProjected(Mat H, PetscInt n, PetscReal re[], PetscReal im[], PetscReal coefficients[])
{
  MpmSmallEigen      small;
  const PetscScalar *h;
  PetscInt           rows;

  PetscFunctionBegin;
  PetscCall(MpmSmallEigenCreate(n, &small));
  PetscCall(MatDenseGetLDA(H, &rows));
  PetscCall(MatDenseGetArrayRead(H, &h));
  for (PetscInt c = 0; c < n; c++)
    for (PetscInt r = 0; r < n; r++) small.matrix[c * n + r] = h[c * rows + r];
  PetscCall(MatDenseRestoreArrayRead(H, &h));
  PetscCall(MpmSmallEigenSolve(&small, PETSC_TRUE));
  for (PetscInt j = 0; j < n; j++) {
    re[j] = creal(small.value[j]);
    im[j] = cimag(small.value[j]);
    for (PetscInt r = 0; r < n; r++) {
      coefficients[2 * n * j + r]     = creal(small.right[j * n + r]);
      coefficients[2 * n * j + n + r] = cimag(small.right[j * n + r]);
    }
  }
  PetscCall(MpmSmallEigenDestroy(&small));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRitzExtract(Mat A, PetscInt given, Vec vectors[], BV *basis, PetscInt *n, PetscReal **re,
                              PetscReal **im, PetscReal **coefficients)
{
  PetscInt order;
  Vec      x;
  Mat      H;

  PetscFunctionBegin;
  PetscCall(MatGetSize(A, &order, NULL));
  PetscCall(MatCreateVecs(A, &x, NULL));
  PetscCall(BVCreate(PetscObjectComm((PetscObject)A), basis));
  PetscCall(BVSetSizesFromVec(*basis, x, PetscMin(2 * given, order) + 1));
  PetscCall(BVSetFromOptions(*basis));
  PetscCall(VecDestroy(&x));
  PetscCall(Span(A, given, vectors, *basis, n));
  PetscCall(PetscMalloc2(*n, re, *n, im));
  PetscCall(PetscMalloc1(2 * *n * *n, coefficients));
  if (*n == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(BVSetActiveColumns(*basis, 0, *n));
  PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, *n, *n, NULL, &H));
  PetscCall(BVMatProject(*basis, A, *basis, H));
  PetscCall(SolveProjected(H, *n, *re, *im, *coefficients));
  PetscCall(MatDestroy(&H));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- shift-and-invert ---- */

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
