/* Polynomials of matrices: where they are singular, and the largest eigenvalue. */
#include "linalg/lapack_names.h"
#include "linalg/matrix_polynomial.h"
#include "linalg/small_eigen.h"
#include <math.h>

#define REAL 1e-7 /* an eigenvalue is real up to this part of its abs */

/* ---- eigenvalues ---- */

static PetscErrorCode Eigenvalues(PetscInt n, const double complex matrix[], double complex value[], PetscBool *finite)
{
  MpmSmallEigen small;

  PetscFunctionBegin;
  PetscCall(MpmSmallEigenCreate(n, &small));
  PetscCall(PetscArraycpy(small.matrix, matrix, n * n));
  PetscCall(MpmSmallEigenSolve(&small, PETSC_FALSE)); /* infinite where the matrix is not finite */
  PetscCall(PetscArraycpy(value, small.value, n));
  *finite = n == 0 || isfinite(creal(value[0])) ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(MpmSmallEigenDestroy(&small));
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

/* b = A^-1 b, for b with count columns. A is overwritten. */
static PetscErrorCode Solve(PetscInt n, double complex A[], PetscInt count, double complex b[])
{
  PetscBLASInt  order, rhs, info;
  PetscBLASInt *pivot;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCall(PetscBLASIntCast(count, &rhs));
  PetscCall(PetscMalloc1(n, &pivot));
  MPM_ZGESV(&order, &rhs, A, &order, pivot, b, &order, &info);
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK zgesv failed: %d", (int)info);
  PetscCall(PetscFree(pivot));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* out = a^T b, for a and b with n rows. */
static PetscErrorCode Product(PetscInt n, PetscInt rows, PetscInt columns, const double complex a[],
                              const double complex b[], double complex out[])
{
  const double complex one = 1, zero = 0;
  PetscBLASInt         order, m, k;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCall(PetscBLASIntCast(rows, &m));
  PetscCall(PetscBLASIntCast(columns, &k));
  MPM_ZGEMM("T", "N", &m, &k, &order, &one, a, &order, b, &order, &zero, out, &m);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The side of the coefficients but the first that has few rows or columns: which, count of them. */
typedef struct {
  PetscInt               n, degree, count;
  double complex *const *c;
  PetscInt              *which;
  PetscBool              rows;
} Side;

/* Number (row, column) of a coefficient, or with the columns of its transpose. */
static double complex At(const Side *s, PetscInt j, PetscInt row, PetscInt column)
{
  return s->c[j][s->rows ? column * s->n + row : row * s->n + column];
}

/*
   The matrices K_j of which I + x K_1 + x^2 K_2 + ... is singular where the polynomial is, count x count. On rows,
   K_j = R_j C_0^-1 E with C_j = E R_j; on columns, K_j = E' C_0^-1 Q_j with C_j = Q_j E', which is the same of the
   transposes.
*/
static PetscErrorCode Reduce(const Side *s, double complex K[])
{
  const PetscInt  n = s->n, m = s->count;
  double complex *A, *side, *part, *out;

  PetscFunctionBegin;
  PetscCall(PetscCalloc4(n * n, &A, n * m, &side, n * m, &part, m * m, &out));
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt k = 0; k < n; k++) A[i * n + k] = At(s, 0, k, i);
  for (PetscInt k = 0; k < m; k++) side[k * n + s->which[k]] = 1;
  PetscCall(Solve(n, A, m, side));
  for (PetscInt j = 1; j <= s->degree; j++) {
    for (PetscInt a = 0; a < m; a++)
      for (PetscInt i = 0; i < n; i++) part[a * n + i] = At(s, j, s->which[a], i);
    PetscCall(Product(n, m, m, part, side, out));
    for (PetscInt k = 0; k < m; k++)
      for (PetscInt a = 0; a < m; a++) K[((j - 1) * m + (s->rows ? k : a)) * m + (s->rows ? a : k)] = out[k * m + a];
  }
  PetscCall(PetscFree4(A, side, part, out));
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
  Side            side = {.n = n, .degree = degree, .c = c};
  PetscInt       *which[2], count[2];
  double complex *K;

  PetscFunctionBegin;
  *x = INFINITY;
  PetscCall(PetscMalloc2(n, &which[0], n, &which[1]));
  for (int s = 0; s < 2; s++) Support(n, degree, c, s == 0 ? PETSC_TRUE : PETSC_FALSE, which[s], &count[s]);
  side.rows  = count[0] <= count[1] ? PETSC_TRUE : PETSC_FALSE;
  side.which = which[side.rows ? 0 : 1];
  side.count = count[side.rows ? 0 : 1];
  if (side.count > 0) {
    PetscCall(PetscMalloc1(degree * side.count * side.count, &K));
    PetscCall(Reduce(&side, K));
    PetscCall(LeastRoot(side.count, degree, K, x));
    PetscCall(PetscFree(K));
  }
  PetscCall(PetscFree2(which[0], which[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
