/*
   Eigenvalues of a small complex matrix by QR steps.

   A step on many rows takes three rotations at a time. They are found on a window of five rows and four columns. The rows of
   the window further to the right are then multiplied by one matrix of order 4, and the columns further up are rotated three
   times in one loop.
*/
#include "linalg/complex_inline.h"
#include "linalg/small_balance.h"
#include "linalg/small_hessenberg.h"
#include "linalg/small_qr.h"
#include <float.h>
#include <math.h>
#include <string.h>

#define STEPS 30       /* QR steps that an eigenvalue may take, on average */
#define EXCEPTIONAL 10 /* after so many steps without one a shift of another kind is taken, */
#define OF_BELOW 0.75  /* beside the diagonal by this part of the number below it */
#define WIDE 3         /* rotations at a time, */
#define FEW 60         /* and one at a time where rows and columns are fewer */

/* Numbers of 4 rows, or of 2 where vector registers hold no more: GCC splits a longer product at a high price. */
#ifdef __AVX__
#define PART 4
#else
#define PART 2
#endif
#define PARTS ((WIDE + 1) / PART)
typedef PetscReal Part __attribute__((vector_size(PART * sizeof(PetscReal))));

static inline PetscReal Size(double complex a)
{
  return fabs(creal(a)) + fabs(cimag(a));
}

/* Whether the number below the diagonal in row k counts as 0. */
static PetscBool IsSmall(PetscInt n, const PetscReal h[], PetscInt k)
{
  const double complex here = MpmEntry(n, h, k, k), before = MpmEntry(n, h, k - 1, k - 1);
  const PetscReal      below = Size(MpmEntry(n, h, k, k - 1));
  PetscReal            ab, ba, aa, bb, above;

  if (below <= MPM_NEXT_TO_0) return PETSC_TRUE;
  if (below > DBL_EPSILON * (Size(here) + Size(before))) return PETSC_FALSE;
  above = Size(MpmEntry(n, h, k - 1, k));
  ab    = fmax(below, above);
  ba    = fmin(below, above);
  aa    = fmax(Size(here), Size(before - here));
  bb    = fmin(Size(here), Size(before - here));
  return ba * (ab / (aa + ab)) <= fmax(MPM_NEXT_TO_0, DBL_EPSILON * (bb * (aa / (aa + ab)))) ? PETSC_TRUE : PETSC_FALSE;
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

/* A rotation: c, and s = re + i im. */
typedef struct {
  PetscReal c, re, im;
} Turn;

/* The rotation of rows [c s; -conj(s) c] that takes (f, g) to (r, 0). Returns r. */
static inline double complex Rotation(double complex f, double complex g, Turn *t)
{
  const PetscReal ff = MpmSquare(f), both = ff + MpmSquare(g);
  double complex  s;
  PetscReal       u;

  if (ff < MPM_NEXT_TO_0) {
    s  = both < MPM_NEXT_TO_0 ? 1 : MpmScaled(1 / sqrt(both), conj(g));
    *t = (Turn){0, creal(s), cimag(s)};
    return sqrt(both);
  }
  u  = 1 / sqrt(ff * both);
  s  = MpmScaled(u, MpmConjTimes(g, f));
  *t = (Turn){ff * u, creal(s), cimag(s)};
  return MpmScaled(both * u, f);
}

/* Rotates two columns in rows from .. to. */
static inline void TurnColumns(const Turn *t, PetscInt n, PetscReal *restrict left, PetscInt from, PetscInt to)
{
  PetscReal *restrict right = left + 2 * n;

#pragma omp simd
  for (PetscInt i = from; i <= to; i++) {
    const PetscReal xr = left[i], xi = left[n + i], yr = right[i], yi = right[n + i];

    left[i]      = t->c * xr + t->re * yr + t->im * yi;
    left[n + i]  = t->c * xi + t->re * yi - t->im * yr;
    right[i]     = t->c * yr - t->re * xr + t->im * xi;
    right[n + i] = t->c * yi - t->re * xi - t->im * xr;
  }
}

/* Rotates four columns three times in rows from .. to. */
static void TurnFour(const Turn t[WIDE], PetscInt n, PetscReal *restrict h, PetscInt from, PetscInt to)
{
#pragma omp simd
  for (PetscInt i = from; i <= to; i++) {
    PetscReal xr = h[i], xi = h[n + i];

    for (PetscInt r = 0; r < WIDE; r++) {
      const PetscReal yr = h[2 * n * (r + 1) + i], yi = h[2 * n * (r + 1) + n + i],
                      zr = t[r].c * yr - t[r].re * xr + t[r].im * xi, zi = t[r].c * yi - t[r].re * xi - t[r].im * xr;

      h[2 * n * r + i]     = t[r].c * xr + t[r].re * yr + t[r].im * yi;
      h[2 * n * r + n + i] = t[r].c * xi + t[r].re * yi - t[r].im * yr;
      xr                   = zr;
      xi                   = zi;
    }
    h[2 * n * WIDE + i]     = xr;
    h[2 * n * WIDE + n + i] = xi;
  }
}

/* The matrix of three rotations of rows, one after another, by columns. */
typedef struct {
  Part re[WIDE + 1][PARTS], im[WIDE + 1][PARTS];
} Product;

static void Set(Product *q, PetscInt row, PetscInt column, double complex z)
{
  q->re[column][row / PART][row % PART] = creal(z);
  q->im[column][row / PART][row % PART] = cimag(z);
}

static void Multiply(const Turn t[WIDE], Product *q)
{
  double complex row[WIDE + 1] = {1};

  for (PetscInt r = 0; r < WIDE; r++) {
    const double complex s = CMPLX(t[r].re, t[r].im);

    for (PetscInt l = 0; l <= r; l++) {
      Set(q, r, l, MpmScaled(t[r].c, row[l]));
      row[l] = -MpmConjTimes(s, row[l]);
    }
    Set(q, r, r + 1, s);
    for (PetscInt l = r + 2; l <= WIDE; l++) Set(q, r, l, 0);
    row[r + 1] = t[r].c;
  }
  for (PetscInt l = 0; l <= WIDE; l++) Set(q, WIDE, l, row[l]);
}

/* Multiplies four rows, of columns from .. to; h is where the first of them begins in column 0. */
static void TurnRows(const Product *q, PetscInt n, PetscReal h[], PetscInt from, PetscInt to)
{
  for (PetscInt j = from; j <= to; j++) {
    PetscReal *at = h + 2 * n * j;
    Part       re[PARTS], im[PARTS];

    for (PetscInt p = 0; p < PARTS; p++) {
      re[p] = q->re[0][p] * at[0] - q->im[0][p] * at[n];
      im[p] = q->re[0][p] * at[n] + q->im[0][p] * at[0];
      for (PetscInt l = 1; l <= WIDE; l++) {
        re[p] += q->re[l][p] * at[l];
        im[p] += q->re[l][p] * at[n + l];
        re[p] -= q->im[l][p] * at[n + l];
        im[p] += q->im[l][p] * at[l];
      }
    }
    memcpy(at, re, sizeof re);
    memcpy(at + n, im, sizeof im);
  }
}

/* Rotates (x, y), two numbers of a column. */
static inline void TurnDown(const Turn *t, double complex *x, double complex *y)
{
  const double complex s = CMPLX(t->re, t->im), z = MpmScaled(t->c, *y) - MpmConjTimes(s, *x);

  *x = MpmScaled(t->c, *x) + MpmTimes(s, *y);
  *y = z;
}

/* Rotates (x, y), two numbers of a row. */
static inline void TurnAcross(const Turn *t, double complex *x, double complex *y)
{
  const double complex s = CMPLX(t->re, t->im), z = MpmScaled(t->c, *y) - MpmTimes(s, *x);

  *x = MpmScaled(t->c, *x) + MpmConjTimes(s, *y);
  *y = z;
}

/*
   Finds three rotations of rows and columns k .. k + 3, beginning with (f, g), and applies them to the matrix. First they are
   applied to rows k .. k + 4 of these columns, whose numbers stay in registers. Returns what f becomes; g becomes 0.
*/
static double complex TurnWindow(PetscInt n, PetscReal h[], PetscInt k, PetscInt lo, PetscInt hi, double complex f,
                                 double complex g)
{
  const PetscInt rows = k + WIDE < hi ? WIDE + 2 : WIDE + 1;
  double complex z[WIDE + 1][WIDE + 2], r = 0;
  Turn           turn[WIDE];
  Product        q;

  for (PetscInt j = 0; j <= WIDE; j++)
    for (PetscInt i = 0; i < WIDE + 2; i++) z[j][i] = i <= j + 1 && i < rows ? MpmEntry(n, h, k + i, k + j) : 0;
  for (PetscInt t = 0; t < WIDE; t++) {
    const double complex made = Rotation(t > 0 ? z[t - 1][t] : f, t > 0 ? z[t - 1][t + 1] : g, &turn[t]);

    if (t > 0) {
      z[t - 1][t]     = made;
      z[t - 1][t + 1] = 0;
    } else
      r = made;
    for (PetscInt j = t; j <= WIDE; j++) TurnDown(&turn[t], &z[j][t], &z[j][t + 1]);
    for (PetscInt i = 0; i <= t + 2; i++) TurnAcross(&turn[t], &z[t][i], &z[t + 1][i]);
  }
  for (PetscInt j = 0; j <= WIDE; j++)
    for (PetscInt i = 0; i < WIDE + 2; i++)
      if (i <= j + 2 && i < rows) MpmSetEntry(n, h, k + i, k + j, z[j][i]);
  TurnFour(turn, n, MpmRe(n, h, k), lo, k - 1);
  if (k + WIDE < hi) {
    Multiply(turn, &q);
    TurnRows(&q, n, h + k, k + WIDE + 1, hi);
  }
  return r;
}

/* The same for one rotation of rows and columns k and k + 1. */
static inline double complex TurnNext(PetscInt n, PetscReal h[], PetscInt k, PetscInt lo, PetscInt hi, double complex f,
                                      double complex g)
{
  Turn                 t;
  const double complex r = Rotation(f, g, &t);

  for (PetscInt j = k; j <= hi; j++) {
    double complex x = MpmEntry(n, h, k, j), y = MpmEntry(n, h, k + 1, j);

    TurnDown(&t, &x, &y);
    MpmSetEntry(n, h, k, j, x);
    MpmSetEntry(n, h, k + 1, j, y);
  }
  TurnColumns(&t, n, MpmRe(n, h, k), lo, PetscMin(k + 2, hi));
  return r;
}

/* A QR step with a shift on rows and columns lo .. hi: a rotation after another chases what the first makes below. */
static void Step(PetscInt n, PetscReal h[], PetscInt lo, PetscInt hi, double complex shift)
{
  const PetscBool windows = hi - lo >= FEW ? PETSC_TRUE : PETSC_FALSE;
  double complex  f = MpmEntry(n, h, lo, lo) - shift, g = MpmEntry(n, h, lo + 1, lo);

  for (PetscInt k = lo, wide; k < hi; k += wide) {
    double complex r;

    if (k > lo) {
      f = MpmEntry(n, h, k, k - 1);
      g = MpmEntry(n, h, k + 1, k - 1);
    }
    wide = windows && k + WIDE <= hi ? WIDE : 1;
    r    = wide == WIDE ? TurnWindow(n, h, k, lo, hi, f, g) : TurnNext(n, h, k, lo, hi, f, g);
    if (k == lo) continue;
    MpmSetEntry(n, h, k, k - 1, r);
    MpmSetEntry(n, h, k + 1, k - 1, 0);
  }
}

static double complex Shift(PetscInt n, const PetscReal h[], PetscInt lo, PetscInt hi, PetscInt steps)
{
  double complex both[2];

  if (steps % EXCEPTIONAL == EXCEPTIONAL - 1)
    return steps % (2 * EXCEPTIONAL) < EXCEPTIONAL
               ? MpmEntry(n, h, lo, lo) + OF_BELOW * Size(MpmEntry(n, h, lo + 1, lo))
               : MpmEntry(n, h, hi, hi) + OF_BELOW * Size(MpmEntry(n, h, hi, hi - 1));
  Both(MpmEntry(n, h, hi - 1, hi - 1), MpmEntry(n, h, hi - 1, hi), MpmEntry(n, h, hi, hi - 1), MpmEntry(n, h, hi, hi),
       both);
  return both[0];
}

/* ---- the whole ---- */

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

/* Takes each column's real and imaginary parts apart. */
static void Split(PetscInt n, PetscReal a[])
{
  PetscReal im[MPM_SMALL_QR_MOST];

  for (PetscInt j = 0; j < n; j++) {
    PetscReal *column = MpmRe(n, a, j);

    for (PetscInt i = 0; i < n; i++) im[i] = column[2 * i + 1];
    for (PetscInt i = 1; i < n; i++) column[i] = column[2 * i];
    for (PetscInt i = 0; i < n; i++) column[n + i] = im[i];
  }
}

void MpmSmallQr(PetscInt n, double complex matrix[], double complex value[], PetscBool *ok)
{
  PetscReal *a     = (PetscReal *)matrix;
  const int  power = TakeOut(2 * n * n, a);
  PetscInt   lo, hi, first, steps = 0;

  Split(n, a);
  MpmSmallBalance(n, a, &lo, &hi);
  MpmSmallHessenberg(n, a, lo, hi);
  first = lo;
  while (hi >= first) {
    lo = hi;
    while (lo > first && !IsSmall(n, a, lo)) lo--;
    if (lo > first) MpmSetEntry(n, a, lo, lo - 1, 0);
    if (lo == hi) {
      hi--;
      steps = 0;
    } else if (lo == hi - 1) {
      Both(MpmEntry(n, a, lo, lo), MpmEntry(n, a, lo, hi), MpmEntry(n, a, hi, lo), MpmEntry(n, a, hi, hi), value);
      MpmSetEntry(n, a, lo, lo, value[1]);
      MpmSetEntry(n, a, hi, hi, value[0]);
      hi -= 2;
      steps = 0;
    } else if (steps++ == STEPS * n) {
      *ok = PETSC_FALSE;
      return;
    } else
      Step(n, a, lo, hi, Shift(n, a, lo, hi, steps - 1));
  }
  for (PetscInt i = 0; i < n; i++) {
    const double complex z = MpmEntry(n, a, i, i);

    value[i] = CMPLX(scalbn(creal(z), power), scalbn(cimag(z), power));
  }
  *ok = PETSC_TRUE;
}
