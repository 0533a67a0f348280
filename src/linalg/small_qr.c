/* Balance, Hessenberg form and QR steps of a small complex matrix, stored by columns. */
#include "linalg/complex_inline.h"
#include "linalg/small_qr.h"
#include <float.h>
#include <math.h>

#define STEPS 30         /* QR steps that an eigenvalue may take, on average */
#define EXCEPTIONAL 10   /* after so many steps without one a shift of another kind is taken, */
#define OF_BELOW 0.75    /* beside the diagonal by this part of the number below it */
#define GAIN 0.95        /* a row and its column are scaled where that shrinks their norm so far */
#define NEXT_TO_0 1e-290 /* squares of numbers below this lose digits; the matrix's largest number is about 1 */

static inline PetscReal Size(double complex a)
{
  return fabs(creal(a)) + fabs(cimag(a));
}

/* ---- balance ---- */

static void Exchange(PetscInt n, double complex a[], PetscInt i, PetscInt j)
{
  for (PetscInt k = 0; k < n && i != j; k++) {
    const double complex kept = a[n * i + k];

    a[n * i + k] = a[n * j + k];
    a[n * j + k] = kept;
  }
  for (PetscInt k = 0; k < n && i != j; k++) {
    const double complex kept = a[n * k + i];

    a[n * k + i] = a[n * k + j];
    a[n * k + j] = kept;
  }
}

/* Whether row i has only zeros at columns lo .. hi beside the diagonal; column i where columns. */
static PetscBool IsAlone(PetscInt n, const double complex a[], PetscInt i, PetscInt lo, PetscInt hi, PetscBool columns)
{
  for (PetscInt j = lo; j <= hi; j++)
    if (j != i && a[columns ? n * i + j : n * j + i] != 0) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Moves eigenvalues that stand alone in their row to the end and those alone in their column to the front. */
static void Permute(PetscInt n, double complex a[], PetscInt *lo, PetscInt *hi)
{
  *lo = 0;
  *hi = n - 1;
  for (PetscInt i = *hi; i >= 0; i--) {
    if (!IsAlone(n, a, i, 0, *hi, PETSC_FALSE)) continue;
    Exchange(n, a, i, *hi);
    if (--*hi < 0) return;
    i = *hi + 1;
  }
  for (PetscInt j = *lo; j <= *hi; j++) {
    if (!IsAlone(n, a, j, *lo, *hi, PETSC_TRUE)) continue;
    Exchange(n, a, j, *lo);
    ++*lo;
    j = *lo - 1;
  }
}

/* Multiplies column i by a power of two and divides row i by it, where that makes them shorter. */
static PetscBool ScaleOne(PetscInt n, double complex a[], PetscInt lo, PetscInt hi, PetscInt i)
{
  PetscReal column = 0, row = 0, f;
  int       power;

  for (PetscInt j = lo; j <= hi; j++) {
    if (j == i) continue;
    column += Size(a[n * i + j]);
    row += Size(a[n * j + i]);
  }
  if (column == 0 || row == 0 || (row <= 2 * column && column <= 2 * row)) return PETSC_FALSE;
  power = (int)lrint(log2(row / column) / 2);
  f     = scalbn(1, power);
  if (!(f * column + row / f < GAIN * (column + row))) return PETSC_FALSE;
  for (PetscInt j = 0; j < n; j++) {
    a[n * i + j] = MpmScaled(f, a[n * i + j]);
    a[n * j + i] = MpmScaled(1 / f, a[n * j + i]);
  }
  return PETSC_TRUE;
}

static void Balance(PetscInt n, double complex a[], PetscInt *lo, PetscInt *hi)
{
  PetscBool again = PETSC_TRUE;

  Permute(n, a, lo, hi);
  for (PetscInt round = 0; again && round < STEPS; round++) {
    again = PETSC_FALSE;
    for (PetscInt i = *lo; i <= *hi; i++)
      if (ScaleOne(n, a, *lo, *hi, i)) again = PETSC_TRUE;
  }
}

/* ---- Hessenberg form of rows and columns lo .. hi ---- */

/* a -= v (tau v^H a) for one column, rows lo .. hi. */
static void Reflect(PetscInt lo, PetscInt hi, PetscReal tau, const double complex v[], double complex a[])
{
  PetscReal re = 0, im = 0;

  for (PetscInt i = lo; i <= hi; i++) {
    re += creal(v[i]) * creal(a[i]) + cimag(v[i]) * cimag(a[i]);
    im += creal(v[i]) * cimag(a[i]) - cimag(v[i]) * creal(a[i]);
  }
  re *= tau;
  im *= tau;
  for (PetscInt i = lo; i <= hi; i++)
    a[i] -= CMPLX(re * creal(v[i]) - im * cimag(v[i]), re * cimag(v[i]) + im * creal(v[i]));
}

static void Hessenberg(PetscInt n, double complex a[], PetscInt lo, PetscInt hi)
{
  double complex v[MPM_SMALL_QR_MOST], sum[MPM_SMALL_QR_MOST];

  for (PetscInt k = lo; k < hi - 1; k++) {
    double complex *column = a + n * k, first = column[k + 1];
    PetscReal       below = 0, norm, abs = MpmAbs(first), tau;

    for (PetscInt i = k + 2; i <= hi; i++) below += MpmSquare(column[i]);
    if (below < NEXT_TO_0) {
      for (PetscInt i = k + 2; i <= hi; i++) column[i] = 0;
      continue;
    }
    norm = sqrt(abs * abs + below);
    for (PetscInt i = k + 1; i <= hi; i++) v[i] = column[i];
    /* I - tau v v^H takes the column to a multiple of the first unit vector, on the side away from it */
    v[k + 1]      = abs == 0 ? norm : MpmScaled(1 + norm / abs, first);
    column[k + 1] = abs == 0 ? -norm : MpmScaled(-norm / abs, first);
    tau           = 1 / (norm * (norm + abs));
    for (PetscInt i = k + 2; i <= hi; i++) column[i] = 0;
    for (PetscInt j = k + 1; j <= hi; j++) Reflect(k + 1, hi, tau, v, a + n * j);
    for (PetscInt i = lo; i <= hi; i++) sum[i] = 0;
    for (PetscInt j = k + 1; j <= hi; j++)
      for (PetscInt i = lo; i <= hi; i++) sum[i] += MpmTimes(v[j], a[n * j + i]);
    for (PetscInt j = k + 1; j <= hi; j++) {
      const double complex w = MpmScaled(-tau, v[j]);

      for (PetscInt i = lo; i <= hi; i++) a[n * j + i] += MpmConjTimes(w, sum[i]);
    }
  }
}

/* ---- QR steps ---- */

/* Whether the number below the diagonal in row k counts as 0. */
static PetscBool IsSmall(PetscInt n, const double complex h[], PetscInt k)
{
  const double complex here = h[n * k + k], before = h[n * (k - 1) + k - 1];
  const PetscReal      below = Size(h[n * (k - 1) + k]), above = Size(h[n * k + k - 1]);
  PetscReal            ab, ba, aa, bb;

  if (below <= NEXT_TO_0) return PETSC_TRUE;
  if (below > DBL_EPSILON * (Size(here) + Size(before))) return PETSC_FALSE;
  ab = fmax(below, above);
  ba = fmin(below, above);
  aa = fmax(Size(here), Size(before - here));
  bb = fmin(Size(here), Size(before - here));
  return ba * (ab / (aa + ab)) <= fmax(NEXT_TO_0, DBL_EPSILON * (bb * (aa / (aa + ab)))) ? PETSC_TRUE : PETSC_FALSE;
}

/* Both eigenvalues of [a b; c d]; the first is the one nearer to d. */
static void Both(double complex a, double complex b, double complex c, double complex d, double complex value[2])
{
  const double complex half = MpmScaled(0.5, a - d), product = MpmTimes(b, c);
  double complex       root = MpmRoot(MpmTimes(half, half) + product);

  if (creal(half) * creal(root) + cimag(half) * cimag(root) < 0) root = -root;
  value[1] = d + half + root;
  value[0] = half + root == 0 ? d : d - MpmOver(product, half + root);
}

/* Rotates rows: [c s; -conj(s) c] takes (f, g) to (r, 0). */
static double complex Rotation(double complex f, double complex g, PetscReal *c, double complex *s)
{
  const PetscReal ff = MpmSquare(f), both = ff + MpmSquare(g);
  PetscReal       u;

  if (ff < NEXT_TO_0) {
    *c = 0;
    *s = both < NEXT_TO_0 ? 1 : MpmScaled(1 / sqrt(both), conj(g));
    return sqrt(both);
  }
  u  = 1 / sqrt(ff * both);
  *c = ff * u;
  *s = MpmScaled(u, MpmConjTimes(g, f));
  return MpmScaled(both * u, f);
}

/* A QR step with a shift on rows and columns lo .. hi: a rotation after another chases what the first makes below. */
static void Step(PetscInt n, double complex h[], PetscInt lo, PetscInt hi, double complex shift)
{
  for (PetscInt k = lo; k < hi; k++) {
    double complex *left = h + n * k, *right = left + n, s, r;
    const PetscInt  end = PetscMin(k + 2, hi);
    PetscReal       c;

    if (k == lo)
      (void)Rotation(left[lo] - shift, left[lo + 1], &c, &s);
    else {
      r                      = Rotation(h[n * (k - 1) + k], h[n * (k - 1) + k + 1], &c, &s);
      h[n * (k - 1) + k]     = r;
      h[n * (k - 1) + k + 1] = 0;
    }
    for (PetscInt j = k; j <= hi; j++) {
      double complex *at = h + n * j + k, x = at[0], y = at[1];

      at[0] = MpmScaled(c, x) + MpmTimes(s, y);
      at[1] = MpmScaled(c, y) - MpmConjTimes(s, x);
    }
    for (PetscInt i = lo; i <= end; i++) {
      const double complex x = left[i], y = right[i];

      left[i]  = MpmScaled(c, x) + MpmConjTimes(s, y);
      right[i] = MpmScaled(c, y) - MpmTimes(s, x);
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

/* The power of two that makes the largest number of the matrix about 1. */
static int PowerOf(PetscInt n, const double complex a[])
{
  PetscReal largest = 0;
  int       power;

  for (PetscInt i = 0; i < n * n; i++) largest = fmax(largest, fmax(fabs(creal(a[i])), fabs(cimag(a[i]))));
  (void)frexp(largest, &power);
  return power;
}

void MpmSmallQr(PetscInt n, double complex a[], double complex value[], PetscBool *ok)
{
  const int power = PowerOf(n, a);
  PetscInt  lo, hi, first, steps = 0;

  for (PetscInt i = 0; i < n * n && power; i++) a[i] = CMPLX(scalbn(creal(a[i]), -power), scalbn(cimag(a[i]), -power));
  Balance(n, a, &lo, &hi);
  Hessenberg(n, a, lo, hi);
  first = lo;
  while (hi >= first) {
    lo = hi;
    while (lo > first && !IsSmall(n, a, lo)) lo--;
    if (lo > first) a[n * (lo - 1) + lo] = 0;
    if (lo == hi) {
      hi--;
      steps = 0;
    } else if (lo == hi - 1) {
      Both(a[n * lo + lo], a[n * hi + lo], a[n * lo + hi], a[n * hi + hi], value);
      a[n * lo + lo] = value[1];
      a[n * hi + hi] = value[0];
      hi -= 2;
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
