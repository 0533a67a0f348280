/*
   Eigenvalues of a small complex matrix by QR steps: LAPACK balances it, reflections make it a Hessenberg matrix, and
   rotations make that triangular. Products of complex numbers are plain here (-fcx-limited-range), since no number is
   near overflow.
*/
#include "linalg/lapack_names.h"
#include "linalg/small_eigen.h"
#include <float.h>
#include <math.h>

#define STEPS 30         /* QR steps that an eigenvalue may take, on average */
#define EXCEPTIONAL 10   /* after so many steps without one a shift of another kind is taken, */
#define OF_BELOW 0.75    /* beside the diagonal by this part of the number below it */
#define NEXT_TO_0 1e-290 /* squares of numbers below this lose digits; the matrix's largest number is about 1 */

#define ZGEBAL MPM_LAPACK(zgebal, ZGEBAL)
#define ZHEEV MPM_LAPACK(zheev, ZHEEV)

extern void ZGEBAL(const char *job, const PetscBLASInt *n, double complex *a, const PetscBLASInt *lda, PetscBLASInt *lo,
                   PetscBLASInt *hi, double *scale, PetscBLASInt *info);
extern void ZHEEV(const char *jobz, const char *uplo, const PetscBLASInt *n, double complex *a, const PetscBLASInt *lda,
                  double *w, double complex *work, const PetscBLASInt *lwork, double *rwork, PetscBLASInt *info);

static inline PetscReal Size(double complex a)
{
  return fabs(creal(a)) + fabs(cimag(a));
}

static inline PetscReal Square(double complex a)
{
  return creal(a) * creal(a) + cimag(a) * cimag(a);
}

/* Takes rows and columns lo .. hi to Hessenberg form by Householder's reflections I - tau v v^H. */
static void Hessenberg(PetscInt n, double complex a[restrict], PetscInt lo, PetscInt hi)
{
  double complex v[MPM_SMALL_QR_MOST], w[MPM_SMALL_QR_MOST];

  for (PetscInt k = lo; k + 2 <= hi; k++) {
    double complex *column = a + n * k, first = column[k + 1];
    PetscReal       below = 0, norm, tau;

    for (PetscInt i = k + 2; i <= hi; i++) below += Square(column[i]);
    if (below < NEXT_TO_0) {
      for (PetscInt i = k + 2; i <= hi; i++) column[i] = 0;
      continue;
    }
    norm = sqrt(below + Square(first));
    for (PetscInt i = k + 1; i <= hi; i++) v[i] = column[i];
    for (PetscInt i = k + 2; i <= hi; i++) column[i] = 0;
    v[k + 1] += first == 0 ? norm : norm / cabs(first) * first;
    column[k + 1] = first - v[k + 1];
    tau           = 1 / (norm * (norm + sqrt(Square(first))));
    for (PetscInt i = lo; i <= hi; i++) w[i] = 0;
    for (PetscInt j = k + 1; j <= hi; j++) {
      double complex *restrict c = a + n * j, sum = 0;
      const double complex vj = v[j];
      PetscReal            re = 0, im = 0;

#pragma omp simd reduction(+ : re, im)
      for (PetscInt i = k + 1; i <= hi; i++) {
        re += creal(v[i]) * creal(c[i]) + cimag(v[i]) * cimag(c[i]);
        im += creal(v[i]) * cimag(c[i]) - cimag(v[i]) * creal(c[i]);
      }
      sum = tau * CMPLX(re, im);
#pragma omp simd
      for (PetscInt i = k + 1; i <= hi; i++) c[i] -= v[i] * sum;
#pragma omp simd
      for (PetscInt i = lo; i <= hi; i++) w[i] += c[i] * vj;
    }
    for (PetscInt j = k + 1; j <= hi; j++) {
      double complex *restrict c = a + n * j;
      const double complex z     = tau * conj(v[j]);

#pragma omp simd
      for (PetscInt i = lo; i <= hi; i++) c[i] -= w[i] * z;
    }
  }
}

/* Whether the number below the diagonal in row k counts as 0. */
static PetscBool IsSmall(PetscInt n, const double complex h[], PetscInt k)
{
  const double complex here = h[n * k + k], before = h[n * (k - 1) + k - 1];
  const PetscReal      below = Size(h[n * (k - 1) + k]);
  PetscReal            ab, ba, aa, bb, above;

  if (below <= NEXT_TO_0) return PETSC_TRUE;
  if (below > DBL_EPSILON * (Size(here) + Size(before))) return PETSC_FALSE;
  above = Size(h[n * k + k - 1]);
  ab    = fmax(below, above);
  ba    = fmin(below, above);
  aa    = fmax(Size(here), Size(before - here));
  bb    = fmin(Size(here), Size(before - here));
  return ba * (ab / (aa + ab)) <= fmax(NEXT_TO_0, DBL_EPSILON * (bb * (aa / (aa + ab)))) ? PETSC_TRUE : PETSC_FALSE;
}

/* Both eigenvalues of [a b; c d]; the first is the one nearer to d. */
static void Both(double complex a, double complex b, double complex c, double complex d, double complex value[2])
{
  const double complex half = (a - d) / 2, product = b * c;
  double complex       root = csqrt(half * half + product);

  if (creal(half) * creal(root) + cimag(half) * cimag(root) < 0) root = -root;
  value[1] = d + half + root;
  value[0] = half + root == 0 ? d : d - product / (half + root);
}

/* The rotation [c s; -conj(s) c] that takes (f, g) to (r, 0). Returns r. */
static inline double complex Rotation(double complex f, double complex g, PetscReal *c, double complex *s)
{
  const PetscReal ff = Square(f), both = ff + Square(g);
  PetscReal       u;

  if (ff < NEXT_TO_0) {
    *c = 0;
    *s = both < NEXT_TO_0 ? 1 : conj(g) / sqrt(both);
    return sqrt(both);
  }
  u  = 1 / sqrt(ff * both);
  *c = ff * u;
  *s = u * conj(g) * f;
  return both * u * f;
}

/* A QR step with a shift on rows and columns lo .. hi: a rotation after another chases what the first makes below. */
static void Step(PetscInt n, double complex h[], PetscInt lo, PetscInt hi, double complex shift)
{
  double complex f = h[n * lo + lo] - shift, g = h[n * lo + lo + 1];

  for (PetscInt k = lo; k < hi; k++) {
    double complex *restrict left = h + n * k, *restrict right = left + n, s, r;
    const PetscInt last = PetscMin(k + 2, hi);
    PetscReal      c;

    if (k > lo) {
      f = left[k - n];
      g = left[k - n + 1];
    }
    r = Rotation(f, g, &c, &s);
    if (k > lo) {
      left[k - n]     = r;
      left[k - n + 1] = 0;
    }
    for (double complex *x = left + k; x <= h + n * hi + k; x += n) {
      const double complex up = x[0], down = x[1];

      x[0] = c * up + s * down;
      x[1] = c * down - conj(s) * up;
    }
#pragma omp simd
    for (PetscInt i = lo; i <= last; i++) {
      const double complex x = left[i], y = right[i];

      left[i]  = c * x + conj(s) * y;
      right[i] = c * y - s * x;
    }
  }
}

static double complex Shift(PetscInt n, const double complex h[], PetscInt lo, PetscInt hi, PetscInt steps)
{
  double complex both[2];

  if (steps % EXCEPTIONAL == EXCEPTIONAL - 1)
    return steps % (2 * EXCEPTIONAL) < EXCEPTIONAL ? h[n * lo + lo] + OF_BELOW * Size(h[n * lo + lo + 1])
                                                   : h[n * hi + hi] + OF_BELOW * Size(h[n * (hi - 1) + hi]);
  Both(h[n * (hi - 1) + hi - 1], h[n * hi + hi - 1], h[n * (hi - 1) + hi], h[n * hi + hi], both);
  return both[0];
}

/* Divides by the power of two that makes the largest number of the matrix about 1. */
static int TakeOut(PetscInt n, PetscReal a[])
{
  PetscReal largest = 0, factor, other;
  int       power;

#pragma omp simd reduction(max : largest)
  for (PetscInt i = 0; i < n; i++) largest = fabs(a[i]) > largest ? fabs(a[i]) : largest;
  (void)frexp(largest, &power);
  factor = scalbn(1, -power / 2); /* in two parts, since the whole may be no double */
  other  = scalbn(1, power / 2 - power);
  for (PetscInt i = 0; i < n && power; i++) a[i] = a[i] * factor * other;
  return power;
}

void MpmSmallQr(PetscInt n, double complex a[], double complex value[], PetscBool *ok)
{
  const int          power = TakeOut(2 * n * n, (PetscReal *)a);
  const PetscBLASInt order = (PetscBLASInt)n;
  PetscBLASInt       low, high, info;
  PetscReal          scale[MPM_SMALL_QR_MOST];
  PetscInt           lo, hi, steps = 0;

  ZGEBAL("B", &order, a, &order, &low, &high, scale, &info);
  Hessenberg(n, a, low - 1, high - 1);
  for (lo = hi = high - 1; hi >= low - 1;) {
    lo = hi;
    while (lo > low - 1 && !IsSmall(n, a, lo)) lo--;
    if (lo > low - 1) a[n * (lo - 1) + lo] = 0;
    if (hi - lo < 2) {
      if (lo < hi) {
        Both(a[n * lo + lo], a[n * hi + lo], a[n * lo + hi], a[n * hi + hi], value);
        a[n * lo + lo] = value[1];
        a[n * hi + hi] = value[0];
      }
      hi    = lo - 1;
      steps = 0;
    } else if (steps++ == STEPS * n) {
      *ok = PETSC_FALSE;
      return;
    } else
      Step(n, a, lo, hi, Shift(n, a, lo, hi, steps - 1));
  }
  for (PetscInt i = 0; i < n; i++)
    value[i] = CMPLX(scalbn(creal(a[n * i + i]), power), scalbn(cimag(a[n * i + i]), power));
  *ok = PETSC_TRUE;
}

/* ---- LAPACK, which is asked for vectors and for what QR steps leave open ---- */

#define ZGEEV MPM_LAPACK(zgeev, ZGEEV)

extern void ZGEEV(const char *jobvl, const char *jobvr, const PetscBLASInt *n, double complex *a,
                  const PetscBLASInt *lda, double complex *w, double complex *vl, const PetscBLASInt *ldvl,
                  double complex *vr, const PetscBLASInt *ldvr, double complex *work, const PetscBLASInt *lwork,
                  double *rwork, PetscBLASInt *info);

static PetscErrorCode Call(MpmSmallEigen *s, PetscBool vectors, PetscBLASInt lwork, double complex work[])
{
  const char  *job = vectors ? "V" : "N";
  PetscBLASInt n, info;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(s->n, &n));
  ZGEEV(job, job, &n, s->matrix, &n, s->value, s->left, &n, s->right, &n, work, &lwork, s->rwork, &info);
  PetscCheck(info == 0, PETSC_COMM_SELF, PETSC_ERR_LIB, "zgeev failed: %d", (int)info);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSmallEigenCreate(PetscInt n, MpmSmallEigen *s)
{
  double complex size;

  PetscFunctionBegin;
  *s = (MpmSmallEigen){.n = n};
  PetscCall(PetscMalloc5(n * n, &s->matrix, n, &s->value, n * n, &s->right, n * n, &s->left, 2 * n, &s->rwork));
  PetscCall(Call(s, PETSC_TRUE, -1, &size)); /* asks for the size of the work space */
  s->lwork = (PetscInt)creal(size);
  PetscCall(PetscMalloc1(s->lwork, &s->work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSmallEigenDestroy(MpmSmallEigen *s)
{
  PetscFunctionBegin;
  PetscCall(PetscFree5(s->matrix, s->value, s->right, s->left, s->rwork));
  PetscCall(PetscFree(s->work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSmallEigenLapack(MpmSmallEigen *s)
{
  PetscFunctionBegin;
  PetscCall(Call(s, PETSC_FALSE, (PetscBLASInt)s->lwork, s->work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSmallEigenSolve(MpmSmallEigen *s, PetscBool vectors)
{
  PetscBool ok;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < s->n * s->n; i++) {
    if (isfinite(creal(s->matrix[i])) && isfinite(cimag(s->matrix[i]))) continue;
    for (PetscInt j = 0; j < s->n; j++) s->value[j] = INFINITY;
    PetscCall(PetscArrayzero(s->right, s->n * s->n));
    PetscCall(PetscArrayzero(s->left, s->n * s->n));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!vectors && s->n <= MPM_SMALL_QR_MOST) {
    PetscCall(PetscArraycpy(s->left, s->matrix, s->n * s->n));
    MpmSmallQr(s->n, s->matrix, s->value, &ok);
    if (ok) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(PetscArraycpy(s->matrix, s->left, s->n * s->n));
  }
  PetscCall(Call(s, vectors, (PetscBLASInt)s->lwork, s->work));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- Hermitian matrices ---- */

void MpmHermitianSolve(PetscInt n, double complex A[MPM_MOST_HERMITIAN][MPM_MOST_HERMITIAN],
                       PetscReal      value[MPM_MOST_HERMITIAN],
                       double complex vector[MPM_MOST_HERMITIAN][MPM_MOST_HERMITIAN])
{
  const PetscBLASInt order = (PetscBLASInt)n, rows = MPM_MOST_HERMITIAN, room = 2 * MPM_MOST_HERMITIAN;
  PetscReal          ascending[MPM_MOST_HERMITIAN], rwork[3 * MPM_MOST_HERMITIAN];
  double complex     work[2 * MPM_MOST_HERMITIAN];
  PetscBLASInt       info;

  ZHEEV("V", "U", &order, A[0], &rows, ascending, work, &room, rwork, &info); /* by columns, this is the conjugate */
  for (PetscInt i = 0; i < n; i++) {
    value[i] = info ? NAN : ascending[n - 1 - i];
    for (PetscInt a = 0; a < n; a++) vector[i][a] = conj(A[n - 1 - i][a]);
  }
}
