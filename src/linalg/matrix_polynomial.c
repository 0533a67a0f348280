/* Polynomials of matrices: where they are singular, and the largest eigenvalue. */
#include "linalg/lapack_names.h"
#include "linalg/dense.h"
#include "linalg/matrix_polynomial.h"
#include "linalg/small_eigen.h"
#include <math.h>

#define ZGESV MPM_LAPACK(zgesv, ZGESV)
#define ZGEMM MPM_LAPACK(zgemm, ZGEMM)
#define REAL 1e-7 /* an eigenvalue is real up to this part of its abs */

extern void ZGESV(const PetscBLASInt *n, const PetscBLASInt *nrhs, double complex *a, const PetscBLASInt *lda,
                  PetscBLASInt *ipiv, double complex *b, const PetscBLASInt *ldb, PetscBLASInt *info);
extern void ZGEMM(const char *transa, const char *transb, const PetscBLASInt *m, const PetscBLASInt *n,
                  const PetscBLASInt *k, const double complex *alpha, const double complex *a, const PetscBLASInt *lda,
                  const double complex *b, const PetscBLASInt *ldb, const double complex *beta, double complex *c,
                  const PetscBLASInt *ldc);

/* ---- eigenvalues ---- */

static PetscErrorCode RealEigenvalues(PetscInt n, const double complex matrix[], double complex value[])
{
  PetscReal *a, *re, *im;
  int        failed;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n * n, &a, n, &re, n, &im));
  for (PetscInt i = 0; i < n * n; i++) a[i] = creal(matrix[i]);
  PetscCall(MpmDenseEigen(n, a, re, im, NULL, &failed));
  PetscCheck(!failed, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK dgeev did not converge");
  for (PetscInt i = 0; i < n; i++) value[i] = CMPLX(re[i], im[i]);
  PetscCall(PetscFree3(a, re, im));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ComplexEigenvalues(PetscInt n, const double complex matrix[], double complex value[])
{
  MpmSmallEigen small;

  PetscFunctionBegin;
  PetscCall(MpmSmallEigenCreate(n, &small));
  PetscCall(PetscArraycpy(small.matrix, matrix, n * n));
  PetscCall(MpmSmallEigenSolve(&small, PETSC_FALSE));
  PetscCall(PetscArraycpy(value, small.value, n));
  PetscCall(MpmSmallEigenDestroy(&small));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Real matrices, those of patches without a phase, take a quarter of the time. */
static PetscErrorCode Eigenvalues(PetscInt n, double complex matrix[], double complex value[], PetscBool *finite)
{
  PetscBool real = PETSC_TRUE;

  PetscFunctionBegin;
  *finite = PETSC_TRUE;
  for (PetscInt i = 0; i < n * n; i++) {
    if (!isfinite(creal(matrix[i])) || !isfinite(cimag(matrix[i]))) *finite = PETSC_FALSE;
    if (cimag(matrix[i]) != 0) real = PETSC_FALSE;
  }
  if (*finite) PetscCall(real ? RealEigenvalues(n, matrix, value) : ComplexEigenvalues(n, matrix, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPolynomialRadius(PetscInt n, double complex matrix[], PetscReal *radius)
{
  double complex *value;
  PetscBool       finite;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &value));
  PetscCall(Eigenvalues(n, matrix, value, &finite));
  *radius = finite ? 0 : INFINITY;
  for (PetscInt i = 0; finite && i < n; i++) *radius = PetscMax(*radius, cabs(value[i]));
  PetscCall(PetscFree(value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- where a polynomial is singular ---- */

/* The rows, or the columns, of C_1, C_2 ... that are not all 0: which[0 .. count). */
static void Support(PetscInt n, PetscInt degree, double complex *const c[], PetscBool rows, PetscInt which[],
                    PetscInt *count)
{
  *count = 0;
  for (PetscInt a = 0; a < n; a++) {
    PetscBool any = PETSC_FALSE;

    for (PetscInt j = 1; j <= degree && !any; j++)
      for (PetscInt b = 0; b < n && !any; b++) any = c[j][rows ? b * n + a : a * n + b] != 0 ? PETSC_TRUE : PETSC_FALSE;
    if (any) which[(*count)++] = a;
  }
}

/* b = C_0^-1 b, for b with count columns. */
static PetscErrorCode Solve(PetscInt n, double complex c0[], PetscInt count, double complex b[])
{
  PetscBLASInt  order, rhs, info;
  PetscBLASInt *pivot;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCall(PetscBLASIntCast(count, &rhs));
  PetscCall(PetscMalloc1(n, &pivot));
  ZGESV(&order, &rhs, c0, &order, pivot, b, &order, &info);
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "zgesv failed: %d", (int)info);
  PetscCall(PetscFree(pivot));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The matrices K_j of which I + x K_1 + x^2 K_2 + ... is singular where the polynomial is, count x count. On rows,
   K_j = R_j C_0^-1 E with C_j = E R_j; on columns, K_j = E' C_0^-1 Q_j with C_j = Q_j E'. side: C_0^-1 E, or its
   transpose.
*/
static PetscErrorCode Reduce(PetscInt n, PetscInt degree, double complex *const c[], PetscBool rows,
                             const PetscInt which[], PetscInt count, double complex K[])
{
  const double complex one = 1, zero = 0;
  double complex      *side, *part;
  PetscBLASInt         order, small;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCall(PetscBLASIntCast(count, &small));
  PetscCall(PetscCalloc2(n * count, &side, n * count, &part));
  for (PetscInt a = 0; a < count; a++) side[a * n + which[a]] = 1;
  if (!rows) /* C_0 is transposed in place */
    for (PetscInt a = 0; a < n; a++)
      for (PetscInt b = 0; b < a; b++) {
        const double complex kept = c[0][a * n + b];

        c[0][a * n + b] = c[0][b * n + a];
        c[0][b * n + a] = kept;
      }
  PetscCall(Solve(n, c[0], count, side));
  for (PetscInt j = 1; j <= degree; j++) {
    double complex *out = K + (j - 1) * count * count;

    for (PetscInt a = 0; a < count; a++)
      for (PetscInt b = 0; b < n; b++) part[a * n + b] = c[j][rows ? b * n + which[a] : which[a] * n + b];
    if (rows)
      ZGEMM("T", "N", &small, &small, &order, &one, part, &order, side, &order, &zero, out, &small);
    else
      ZGEMM("T", "N", &small, &small, &order, &one, side, &order, part, &order, &zero, out, &small);
  }
  PetscCall(PetscFree2(side, part));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With y = 1 / x, the y are the eigenvalues of the companion matrix of y^m + y^(m-1) K_1 + ... + K_m. */
static PetscErrorCode LeastRoot(PetscInt count, PetscInt degree, const double complex K[], PetscReal *x)
{
  const PetscInt  n = count * degree;
  double complex *companion, *value;
  PetscBool       finite;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(n * n, &companion, n, &value));
  for (PetscInt j = 0; j < degree; j++)
    for (PetscInt a = 0; a < count; a++) {
      for (PetscInt b = 0; b < count; b++) companion[(j * count + a) * n + b] = -K[(j * count + a) * count + b];
      if (j + 1 < degree) companion[(j * count + a) * n + (j + 1) * count + a] = 1;
    }
  PetscCall(Eigenvalues(n, companion, value, &finite));
  *x = INFINITY;
  for (PetscInt i = 0; finite && i < n; i++)
    if (creal(value[i]) > 0 && fabs(cimag(value[i])) <= REAL * creal(value[i])) *x = PetscMin(*x, 1 / creal(value[i]));
  PetscCall(PetscFree2(companion, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPolynomialSingular(PetscInt n, PetscInt degree, double complex *const c[], PetscReal *x)
{
  PetscInt       *which[2], count[2];
  double complex *K;
  PetscInt        side;

  PetscFunctionBegin;
  *x = INFINITY;
  PetscCall(PetscMalloc2(n, &which[0], n, &which[1]));
  for (int s = 0; s < 2; s++) Support(n, degree, c, s == 0 ? PETSC_TRUE : PETSC_FALSE, which[s], &count[s]);
  side = count[0] <= count[1] ? 0 : 1;
  if (count[side] > 0) {
    PetscCall(PetscMalloc1(degree * count[side] * count[side], &K));
    PetscCall(Reduce(n, degree, c, side == 0 ? PETSC_TRUE : PETSC_FALSE, which[side], count[side], K));
    PetscCall(LeastRoot(count[side], degree, K, x));
    PetscCall(PetscFree(K));
  }
  PetscCall(PetscFree2(which[0], which[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
