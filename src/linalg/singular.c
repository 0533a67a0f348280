/* The largest singular value, by SLEPc, and the smallest of z - A by a Schur form. */
#include "base/hash.h"
#include "linalg/dense.h"
#include "linalg/lapack_names.h"
#include "linalg/singular.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <slepcsvd.h>

#define RESTARTS 500
#define NORM_VECTORS 4

PetscErrorCode MpmSingularStart(PetscInt64 seed, Vec start)
{
  PetscInt   begin, end;
  PetscReal *x;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(start, &begin, &end));
  PetscCall(VecGetArray(start, &x));
  for (PetscInt row = begin; row < end; row++) x[row - begin] = MpmHash(seed, row) - 0.5;
  PetscCall(VecRestoreArray(start, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNormBelow(Mat matrix, NormType type, PetscReal *norm)
{
  Vec x, y;

  PetscFunctionBegin;
  PetscCheck(type == NORM_INFINITY, PETSC_COMM_SELF, PETSC_ERR_SUP, "of an operator without a matrix, no such norm");
  PetscCall(MatCreateVecs(matrix, &x, &y));
  *norm = 0;
  for (PetscInt v = 0; v < NORM_VECTORS; v++) {
    PetscInt   begin, end;
    PetscReal *sign, largest;

    PetscCall(VecGetOwnershipRange(x, &begin, &end));
    PetscCall(VecGetArrayWrite(x, &sign));
    for (PetscInt i = begin; i < end; i++) sign[i - begin] = MpmHash(v, i) < 0.5 ? -1 : 1;
    PetscCall(VecRestoreArrayWrite(x, &sign));
    PetscCall(MatMult(matrix, x, y));
    PetscCall(VecNorm(y, NORM_INFINITY, &largest));
    if (!(largest <= *norm)) *norm = largest; /* NaN is the largest */
  }
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateSolver(PetscInt basis, PetscReal tolerance, SVD *svd)
{
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(SVDCreate(PETSC_COMM_WORLD, svd));
  PetscCall(SVDSetImplicitTranspose(*svd, PETSC_TRUE));
  PetscCall(SVDSetType(*svd, SVDTRLANCZOS));
  PetscCall(SVDSetDimensions(*svd, 1, basis, PETSC_DETERMINE));
  PetscCall(SVDSetTolerances(*svd, tolerance, RESTARTS));
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  error = SVDSetFromOptions(*svd);
  PetscCall(PetscPopErrorHandler());
  MpmCheckInput(!error, "-svd_*: SLEPc refuses one of them; allowed: see its manual pages");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSingularTryOptions(void)
{
  SVD svd;

  PetscFunctionBegin;
  PetscCall(CreateSolver(1, 1, &svd));
  PetscCall(SVDDestroy(&svd));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a matrix is zero: it maps a random vector to 0 exactly. SLEPc breaks down on it. */
static PetscErrorCode IsZero(Mat matrix, Vec start, PetscBool *zero)
{
  Vec       image;
  PetscReal norm;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(start, &image));
  PetscCall(MatMult(matrix, start, image));
  PetscCall(VecNorm(image, NORM_INFINITY, &norm));
  PetscCall(VecDestroy(&image));
  *zero = norm == 0 ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSingularLargest(Mat matrix, Vec start, PetscInt basis, PetscReal tolerance, PetscReal *sigma)
{
  SVD            svd;
  PetscInt       order, found = 0;
  PetscBool      zero = PETSC_FALSE;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(MatGetSize(matrix, &order, NULL));
  PetscCall(CreateSolver(PetscMin(basis, order), tolerance, &svd));
  PetscCall(SVDSetOperators(svd, matrix, NULL));
  PetscCall(SVDSetInitialSpaces(svd, 1, &start, 0, NULL));
  PetscCall(SVDSetWhichSingularTriplets(svd, SVD_LARGEST)); /* overrides the options */
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  error = SVDSolve(svd);
  PetscCall(PetscPopErrorHandler());
  if (!error) PetscCall(SVDGetConverged(svd, &found));
  if (!found) PetscCall(IsZero(matrix, start, &zero));
  *sigma = zero ? 0 : NAN;
  if (found) PetscCall(SVDGetSingularTriplet(svd, 0, sigma, NULL, NULL));
  PetscCall(SVDDestroy(&svd));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   ---- the resolvent ----

   One Schur form A = Q T Q^H serves all points z (Lui 1997; Trefethen 1999, Computation of pseudospectra). The singular
   values of z - A are those of the triangle U = z - T, so

     1 / sigma_min^2 = the largest eigenvalue of U^-1 U^-H

   Applying this matrix is two triangular solves. Lanczos with full orthogonalization finds its largest eigenvalue.
*/

#define CONVERGED 1e-10 /* largest residual, relative to the largest eigenvalue */
#define FIRST_LOOK 4    /* vectors before the first test of convergence; later tests come after an eighth more */

#define ZGEES MPM_LAPACK(zgees, ZGEES)
#define ZTRSV MPM_LAPACK(ztrsv, ZTRSV)
#define ZGEMV MPM_LAPACK(zgemv, ZGEMV)

extern void ZGEES(const char *jobvs, const char *sort, PetscBLASInt (*select)(const double complex *),
                  const PetscBLASInt *n, double complex *a, const PetscBLASInt *lda, PetscBLASInt *sdim,
                  double complex *w, double complex *vs, const PetscBLASInt *ldvs, double complex *work,
                  const PetscBLASInt *lwork, double *rwork, PetscBLASInt *bwork, PetscBLASInt *info);
extern void ZTRSV(const char *uplo, const char *trans, const char *diag, const PetscBLASInt *n, const double complex *a,
                  const PetscBLASInt *lda, double complex *x, const PetscBLASInt *incx);
extern void ZGEMV(const char *trans, const PetscBLASInt *m, const PetscBLASInt *n, const double complex *alpha,
                  const double complex *a, const PetscBLASInt *lda, const double complex *x, const PetscBLASInt *incx,
                  const double complex *beta, double complex *y, const PetscBLASInt *incy);

/* Computes the Schur form. factor holds A by columns on entry, and its Schur form on return. */
static PetscErrorCode Schur(MpmResolvent *r)
{
  PetscBLASInt   n, room = -1, one = 1, sorted, info;
  double complex size, *work;
  PetscReal     *rwork;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(r->n, &n));
  PetscCall(PetscMalloc1(r->n, &rwork));
  ZGEES("N", "N", NULL, &n, r->factor, &n, &sorted, r->eigenvalue, NULL, &one, &size, &room, rwork, NULL, &info);
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "zgees failed: %d", (int)info);
  room = (PetscBLASInt)creal(size);
  PetscCall(PetscMalloc1(room, &work));
  ZGEES("N", "N", NULL, &n, r->factor, &n, &sorted, r->eigenvalue, NULL, &one, work, &room, rwork, NULL, &info);
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "zgees failed: %d", (int)info);
  PetscCall(PetscFree(work));
  PetscCall(PetscFree(rwork));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmResolventCreate(Mat A, MpmResolvent *r)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)A);
  PetscReal     *values;
  PetscMPIInt    rank;
  PetscInt       n;

  PetscFunctionBegin;
  PetscCall(MatGetSize(A, &n, NULL));
  *r = (MpmResolvent){.n = n};
  PetscCall(PetscMalloc4(n * n, &r->factor, n, &r->eigenvalue, n * (n + 1), &r->basis, n + 1, &r->coefficient));
  PetscCall(PetscMalloc4(n, &r->diagonal, n, &r->beside, n * (n + 2), &r->vectors, 2 * n, &r->room));
  PetscCall(PetscMalloc1(n * n, &values));
  PetscCall(MpmDenseCopy(A, values));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  for (PetscInt i = 0; i < n * n; i++) r->factor[i] = values[i];
  PetscCall(PetscFree(values));
  if (rank == 0) PetscCall(Schur(r));
  PetscCallMPI(MPI_Bcast(r->factor, (PetscMPIInt)(n * n), MPI_C_DOUBLE_COMPLEX, 0, comm));
  PetscCallMPI(MPI_Bcast(r->eigenvalue, (PetscMPIInt)n, MPI_C_DOUBLE_COMPLEX, 0, comm));
  for (PetscInt i = 0; i < n * n; i++) r->factor[i] = -r->factor[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmResolventDestroy(MpmResolvent *r)
{
  PetscFunctionBegin;
  PetscCall(PetscFree4(r->factor, r->eigenvalue, r->basis, r->coefficient));
  PetscCall(PetscFree4(r->diagonal, r->beside, r->vectors, r->room));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Norm(PetscInt n, const double complex x[])
{
  PetscReal largest = 0, sum = 0;

  for (PetscInt i = 0; i < n; i++) largest = PetscMax(largest, PetscMax(fabs(creal(x[i])), fabs(cimag(x[i]))));
  if (!isnormal(largest)) return largest;
  for (PetscInt i = 0; i < n; i++) sum += PetscSqr(creal(x[i]) / largest) + PetscSqr(cimag(x[i]) / largest);
  return largest * sqrt(sum);
}

/* Sets w = U^-1 U^-H v_k and makes it orthogonal to v_0 .. v_k, twice. Returns its component along v_k. */
static PetscReal Expand(MpmResolvent *r, PetscBLASInt k)
{
  const PetscBLASInt   n = (PetscBLASInt)r->n, one = 1, vectors = k + 1;
  const double complex plus = 1, minus = -1, none = 0;
  double complex      *w     = r->basis + (size_t)r->n * (k + 1);
  PetscReal            along = 0;

  for (PetscInt i = 0; i < r->n; i++) w[i] = r->basis[(size_t)r->n * k + i];
  ZTRSV("U", "C", "N", &n, r->factor, &n, w, &one);
  ZTRSV("U", "N", "N", &n, r->factor, &n, w, &one);
  for (int pass = 0; pass < 2; pass++) {
    ZGEMV("C", &n, &vectors, &plus, r->basis, &n, w, &one, &none, r->coefficient, &one);
    ZGEMV("N", &n, &vectors, &minus, r->basis, &n, r->coefficient, &one, &plus, w, &one);
    along += creal(r->coefficient[k]);
  }
  return along;
}

/*
   Finds the largest eigenvalue theta of the tridiagonal matrix of k vectors, and its residual. beyond: norm of the next
   vector before it is scaled.
*/
static PetscErrorCode Largest(MpmResolvent *r, PetscBLASInt k, PetscReal beyond, PetscReal *theta, PetscReal *residual)
{
  PetscReal   *diagonal = r->room, *beside = r->room + k, *work = r->vectors + (size_t)k * k;
  PetscBLASInt info;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(diagonal, r->diagonal, k));
  PetscCall(PetscArraycpy(beside, r->beside, k - 1));
  PetscCallBLAS("LAPACKsteqr", LAPACKsteqr_("I", &k, diagonal, beside, r->vectors, &k, work, &info));
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "dsteqr failed: %d", (int)info);
  *theta    = diagonal[k - 1];
  *residual = beyond * fabs(r->vectors[(size_t)k * k - 1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmResolventSigma(MpmResolvent *r, double complex z, PetscReal *sigma)
{
  const PetscInt n    = r->n;
  PetscInt       look = FIRST_LOOK;
  PetscReal      size, theta = 0, residual = INFINITY;

  PetscFunctionBegin;
  *sigma = 0;
  for (PetscInt i = 0; i < n; i++) {
    r->factor[i * (n + 1)] = z - r->eigenvalue[i];
    if (r->factor[i * (n + 1)] == 0) PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt i = 0; i < n; i++) r->basis[i] = MpmHash(0, 2 * i) - 0.5 + I * (MpmHash(0, 2 * i + 1) - 0.5);
  size = Norm(n, r->basis);
  for (PetscInt k = 0; k < n && !(residual <= CONVERGED * theta); k++) {
    double complex *v = r->basis + (size_t)n * k;

    for (PetscInt i = 0; i < n; i++) v[i] /= size;
    r->diagonal[k] = Expand(r, (PetscBLASInt)k);
    size           = Norm(n, v + n);
    r->beside[k]   = size;
    if (!isfinite(r->diagonal[k]) || !isfinite(size)) PetscFunctionReturn(PETSC_SUCCESS);
    if (k + 1 < look && k + 1 < n && size > 0) continue;
    look = k + 1 + PetscMax(2, k / 8);
    PetscCall(Largest(r, (PetscBLASInt)(k + 1), size, &theta, &residual));
  }
  *sigma = 1 / sqrt(theta);
  PetscFunctionReturn(PETSC_SUCCESS);
}
