/* Polynomials of matrices: where they are singular, and the largest eigenvalue. */
#include "linalg/lapack_names.h"
#include "linalg/dense.h"
#include "linalg/matrix_polynomial.h"
#include "linalg/small_eigen.h"
#include <math.h>

#define REAL 1e-7 /* an eigenvalue is real up to this part of its abs */

/* ---- eigenvalues ---- */

/* failed: LAPACK did not converge */
static PetscErrorCode RealEigenvalues(PetscInt n, const double complex matrix[], double complex value[], int *failed)
{
  PetscReal *a, *re, *im;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n * n, &a, n, &re, n, &im));
  for (PetscInt i = 0; i < n * n; i++) a[i] = creal(matrix[i]);
  PetscCall(MpmDenseEigen(n, a, re, im, NULL, failed));
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

static PetscBool IsReal(PetscInt n, const double complex a[])
{
  for (PetscInt i = 0; i < n; i++)
    if (cimag(a[i]) != 0) return PETSC_FALSE;
  return PETSC_TRUE;
}

/*
   Real matrices, those of particles without a phase, take a quarter of the time. none: 0, or what is known where there
   are no eigenvalues: INFINITY of numbers out of range, NAN where LAPACK did not converge.
*/
static PetscErrorCode Eigenvalues(PetscInt n, double complex matrix[], double complex value[], PetscReal *none)
{
  int failed = 0;

  PetscFunctionBegin;
  *none = 0;
  for (PetscInt i = 0; i < n * n; i++)
    if (!isfinite(creal(matrix[i])) || !isfinite(cimag(matrix[i]))) *none = INFINITY;
  if (*none > 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(IsReal(n * n, matrix) ? RealEigenvalues(n, matrix, value, &failed) : ComplexEigenvalues(n, matrix, value));
  if (failed) *none = NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPolynomialRadius(PetscInt n, double complex matrix[], PetscReal *radius)
{
  double complex *value;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &value));
  PetscCall(Eigenvalues(n, matrix, value, radius));
  for (PetscInt i = 0; *radius < INFINITY && i < n; i++) *radius = PetscMax(*radius, cabs(value[i]));
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

/*
   C_0 ties together only what a step at Courant number 0 does: of a vector each component apart. Numbers the unknowns
   by the block of C_0 that they are in; returns the number of blocks.
*/
static PetscInt FindBlocks(PetscInt n, const double complex c0[], PetscInt block[], PetscInt queue[])
{
  PetscInt blocks = 0;

  for (PetscInt i = 0; i < n; i++) block[i] = n;
  for (PetscInt i = 0; i < n; i++) {
    PetscInt end = 0;

    if (block[i] < n) continue;
    block[i]     = blocks++;
    queue[end++] = i;
    for (PetscInt at = 0; at < end; at++) {
      const PetscInt a = queue[at];

      for (PetscInt b = 0; b < n; b++) {
        if (block[b] < n || (c0[a * n + b] == 0 && c0[b * n + a] == 0)) continue;
        block[b]     = block[a];
        queue[end++] = b;
      }
    }
  }
  return blocks;
}

/* Keeps the real parts of n numbers, side by side at the beginning of their array, and makes numbers of them again. */
static void ToReal(PetscInt n, double complex z[])
{
  PetscReal *x = (PetscReal *)z;

  for (PetscInt i = 0; i < n; i++) x[i] = creal(z[i]);
}

static void FromReal(PetscInt n, double complex z[])
{
  const PetscReal *x = (const PetscReal *)z;

  for (PetscInt i = n - 1; i >= 0; i--) z[i] = x[i];
}

/* b = A^-1 b, for b with count columns. A is overwritten. */
static PetscErrorCode Solve(PetscInt n, double complex A[], PetscInt count, PetscBool real, double complex b[])
{
  PetscBLASInt  order, rhs, info;
  PetscBLASInt *pivot;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCall(PetscBLASIntCast(count, &rhs));
  PetscCall(PetscMalloc1(n, &pivot));
  if (real) {
    ToReal(n * n, A);
    ToReal(n * count, b);
    PetscCallBLAS("LAPACKgesv",
                  LAPACKgesv_(&order, &rhs, (PetscReal *)A, &order, pivot, (PetscReal *)b, &order, &info));
    FromReal(n * count, b);
  } else
    MPM_ZGESV(&order, &rhs, A, &order, pivot, b, &order, &info);
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK gesv failed: %d", (int)info);
  PetscCall(PetscFree(pivot));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* out = a^T b, for a and b with n rows. a is overwritten. */
static PetscErrorCode Product(PetscInt n, PetscInt rows, PetscInt columns, PetscBool real, double complex a[],
                              const double complex b[], double complex out[])
{
  const double complex one = 1, zero = 0;
  const PetscReal      real_one = 1, real_zero = 0;
  PetscBLASInt         order, m, k;
  double complex      *copy;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCall(PetscBLASIntCast(rows, &m));
  PetscCall(PetscBLASIntCast(columns, &k));
  if (real) {
    PetscCall(PetscMalloc1(n * columns, &copy));
    PetscCall(PetscArraycpy(copy, b, n * columns));
    ToReal(n * rows, a);
    ToReal(n * columns, copy);
    PetscCallBLAS("BLASgemm", BLASgemm_("T", "N", &m, &k, &order, &real_one, (PetscReal *)a, &order, (PetscReal *)copy,
                                        &order, &real_zero, (PetscReal *)out, &m));
    FromReal(rows * columns, out);
    PetscCall(PetscFree(copy));
  } else
    MPM_ZGEMM("T", "N", &m, &k, &order, &one, a, &order, b, &order, &zero, out, &m);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The side of the coefficients but the first that has few rows or columns: which, count of them. */
typedef struct {
  PetscInt               n, degree, count;
  double complex *const *c;
  PetscInt              *which;
  PetscBool              rows, real;
} Side;

/* Number (row, column) of a coefficient, or with the columns of its transpose. */
static double complex At(const Side *s, PetscInt j, PetscInt row, PetscInt column)
{
  return s->c[j][s->rows ? column * s->n + row : row * s->n + column];
}

/* The part of Reduce in a block of C_0: order unknowns at[], and the count columns of E that are in it, column[]. */
static PetscErrorCode ReduceBlock(const Side *s, PetscInt order, const PetscInt at[], PetscInt count,
                                  const PetscInt column[], double complex K[])
{
  double complex *A, *side, *part, *out;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(order * order, &A, order * count, &side, order * s->count, &part, s->count * count, &out));
  for (PetscInt i = 0; i < order; i++)
    for (PetscInt k = 0; k < order; k++) A[i * order + k] = At(s, 0, at[k], at[i]);
  for (PetscInt k = 0; k < count; k++)
    for (PetscInt i = 0; i < order; i++) side[k * order + i] = at[i] == s->which[column[k]] ? 1 : 0;
  PetscCall(Solve(order, A, count, s->real, side));
  for (PetscInt j = 1; j <= s->degree; j++) {
    for (PetscInt a = 0; a < s->count; a++)
      for (PetscInt i = 0; i < order; i++) part[a * order + i] = At(s, j, s->which[a], at[i]);
    PetscCall(Product(order, s->count, count, s->real, part, side, out));
    for (PetscInt k = 0; k < count; k++)
      for (PetscInt a = 0; a < s->count; a++)
        K[(j - 1) * s->count * s->count + (s->rows ? column[k] * s->count + a : a * s->count + column[k])] =
            out[k * s->count + a];
  }
  PetscCall(PetscFree4(A, side, part, out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The matrices K_j of which I + x K_1 + x^2 K_2 + ... is singular where the polynomial is, count x count. On rows,
   K_j = R_j C_0^-1 E with C_j = E R_j; on columns, K_j = E' C_0^-1 Q_j with C_j = Q_j E', which is the same of the
   transposes. Each block of C_0 is solved by itself.
*/
static PetscErrorCode Reduce(const Side *s, double complex K[])
{
  PetscInt *block, *at, *column, blocks;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(s->n, &block, s->n, &at, s->count, &column));
  blocks = FindBlocks(s->n, s->c[0], block, at);
  for (PetscInt i = 0; i < blocks; i++) {
    PetscInt order = 0, count = 0;

    for (PetscInt a = 0; a < s->n; a++)
      if (block[a] == i) at[order++] = a;
    for (PetscInt a = 0; a < s->count; a++)
      if (block[s->which[a]] == i) column[count++] = a;
    if (count > 0) PetscCall(ReduceBlock(s, order, at, count, column, K));
  }
  PetscCall(PetscFree3(block, at, column));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With y = 1 / x, the y are the eigenvalues of the companion matrix of y^m + y^(m-1) K_1 + ... + K_m. */
static PetscErrorCode LeastRoot(PetscInt count, PetscInt degree, const double complex K[], PetscReal *x)
{
  const PetscInt  n = count * degree;
  double complex *companion, *value;
  PetscReal       none;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(n * n, &companion, n, &value));
  for (PetscInt j = 0; j < degree; j++)
    for (PetscInt a = 0; a < count; a++) {
      for (PetscInt b = 0; b < count; b++) companion[(j * count + a) * n + b] = -K[(j * count + a) * count + b];
      if (j + 1 < degree) companion[(j * count + a) * n + (j + 1) * count + a] = 1;
    }
  PetscCall(Eigenvalues(n, companion, value, &none));
  *x = isnan(none) ? NAN : INFINITY;
  for (PetscInt i = 0; none == 0 && i < n; i++)
    if (creal(value[i]) > 0 && fabs(cimag(value[i])) <= REAL * creal(value[i])) *x = PetscMin(*x, 1 / creal(value[i]));
  PetscCall(PetscFree2(companion, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPolynomialSingular(PetscInt n, PetscInt degree, double complex *const c[], PetscReal *x)
{
  Side            side = {.n = n, .degree = degree, .c = c, .real = PETSC_TRUE};
  PetscInt       *which[2], count[2];
  double complex *K;

  PetscFunctionBegin;
  *x = INFINITY;
  PetscCall(PetscMalloc2(n, &which[0], n, &which[1]));
  for (int s = 0; s < 2; s++) Support(n, degree, c, s == 0 ? PETSC_TRUE : PETSC_FALSE, which[s], &count[s]);
  side.rows  = count[0] <= count[1] ? PETSC_TRUE : PETSC_FALSE;
  side.which = which[side.rows ? 0 : 1];
  side.count = count[side.rows ? 0 : 1];
  for (PetscInt j = 0; j <= degree && side.real; j++) side.real = IsReal(n * n, c[j]);
  if (side.count > 0) {
    PetscCall(PetscMalloc1(degree * side.count * side.count, &K));
    PetscCall(Reduce(&side, K));
    PetscCall(LeastRoot(side.count, degree, K, x));
    PetscCall(PetscFree(K));
  }
  PetscCall(PetscFree2(which[0], which[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
