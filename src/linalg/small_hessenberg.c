/*
   The Hessenberg form of a small complex matrix.

   A reflection I - tau v v^H takes A to A - v w - u v^H, with u = tau A v and w = tau v^H A - tau^2 (v^H A v) v^H. The vector
   of the next reflection needs one more column only. So the loop that takes away both products also multiplies what is left
   by the next vector, from both sides.
*/
#include "linalg/complex_inline.h"
#include "linalg/small_hessenberg.h"
#include "linalg/small_qr.h"
#include <math.h>

#define MOST MPM_SMALL_QR_MOST
#define ROWS 8 /* loops begin at a multiple of it, where they take several rows at a time */

typedef struct {
  PetscReal re[MOST], im[MOST];
} Vector;

/* A reflection: its vector, the products that it takes away, and tau. All are 0 where a column has nothing to take away. */
typedef struct {
  Vector    v, u, w;
  PetscReal tau;
} Reflection;

static inline void Change(const Reflection *r, PetscInt from, PetscInt to, PetscInt j, PetscReal re[restrict],
                          PetscReal im[restrict])
{
  const PetscReal wr = r->w.re[j], wi = r->w.im[j], xr = r->v.re[j], xi = r->v.im[j];

#pragma omp simd
  for (PetscInt i = from; i <= to; i++) {
    re[i] -= r->v.re[i] * wr - r->v.im[i] * wi + r->u.re[i] * xr + r->u.im[i] * xi;
    im[i] -= r->v.re[i] * wi + r->v.im[i] * wr + r->u.im[i] * xr - r->u.re[i] * xi;
  }
}

/* Makes the reflection that takes column k to a multiple of a unit vector below the diagonal, on the side away from it. */
static void Begin(PetscInt n, PetscReal a[], PetscInt k, PetscInt lo, PetscInt hi, Reflection *r)
{
  PetscReal           *re = MpmRe(n, a, k), *im = MpmIm(n, a, k), below = 0, norm;
  const double complex first = CMPLX(re[k + 1], im[k + 1]);
  const PetscReal      abs   = MpmAbs(first);

  for (PetscInt i = k + 2; i <= hi; i++) below += re[i] * re[i] + im[i] * im[i];
  for (PetscInt i = lo; i <= hi; i++) {
    r->v.re[i] = i > k ? re[i] : 0;
    r->v.im[i] = i > k ? im[i] : 0;
    r->u.re[i] = r->u.im[i] = 0;
  }
  for (PetscInt i = k + 2; i <= hi; i++) re[i] = im[i] = 0;
  if (below < MPM_NEXT_TO_0) {
    for (PetscInt i = k + 1; i <= hi; i++) r->v.re[i] = r->v.im[i] = 0;
    r->tau = 0;
    return;
  }
  norm           = sqrt(abs * abs + below);
  r->v.re[k + 1] = abs == 0 ? norm : (1 + norm / abs) * creal(first);
  r->v.im[k + 1] = abs == 0 ? 0 : (1 + norm / abs) * cimag(first);
  re[k + 1]      = abs == 0 ? -norm : -norm / abs * creal(first);
  im[k + 1]      = abs == 0 ? 0 : -norm / abs * cimag(first);
  r->tau         = 1 / (norm * (norm + abs));
}

/* Ends one reflection in column j, and adds to the products of the next one's vector and the matrix: from row 'from' on. */
static inline void EndAndMultiply(const Reflection *last, PetscInt from, PetscInt to, PetscInt j,
                                  PetscReal re[restrict], PetscReal im[restrict], Reflection *restrict next)
{
  const PetscReal wr = last->w.re[j], wi = last->w.im[j], xr = last->v.re[j], xi = last->v.im[j], pr = next->v.re[j],
                  pi = next->v.im[j];
  PetscReal yr = 0, yi = 0;

#pragma omp simd reduction(+ : yr, yi)
  for (PetscInt i = from; i <= to; i++) {
    const PetscReal r = re[i] - (last->v.re[i] * wr - last->v.im[i] * wi) - (last->u.re[i] * xr + last->u.im[i] * xi),
                    m = im[i] - (last->v.re[i] * wi + last->v.im[i] * wr) - (last->u.im[i] * xr - last->u.re[i] * xi);

    re[i] = r;
    im[i] = m;
    yr += next->v.re[i] * r + next->v.im[i] * m;
    yi += next->v.re[i] * m - next->v.im[i] * r;
    next->u.re[i] += r * pr - m * pi;
    next->u.im[i] += r * pi + m * pr;
  }
  next->w.re[j] = yr;
  next->w.im[j] = yi;
}

/* The same where both vectors are 0. */
static inline void EndAbove(const Reflection *last, PetscInt from, PetscInt to, PetscInt j, PetscReal re[restrict],
                            PetscReal im[restrict], Reflection *restrict next)
{
  const PetscReal xr = last->v.re[j], xi = last->v.im[j], pr = next->v.re[j], pi = next->v.im[j];

#pragma omp simd
  for (PetscInt i = from; i <= to; i++) {
    const PetscReal r = re[i] - last->u.re[i] * xr - last->u.im[i] * xi,
                    m = im[i] - last->u.im[i] * xr + last->u.re[i] * xi;

    re[i] = r;
    im[i] = m;
    next->u.re[i] += r * pr - m * pi;
    next->u.im[i] += r * pi + m * pr;
  }
}

/* From u = A v and w = v^H A, of rows lo .. hi and columns k + 1 .. hi, to what the reflection takes away. */
static void Finish(Reflection *r, PetscInt k, PetscInt lo, PetscInt hi)
{
  PetscReal sr = 0, si = 0;

#pragma omp simd reduction(+ : sr, si)
  for (PetscInt j = k + 1; j <= hi; j++) {
    sr += r->w.re[j] * r->v.re[j] - r->w.im[j] * r->v.im[j];
    si += r->w.re[j] * r->v.im[j] + r->w.im[j] * r->v.re[j];
  }
  sr *= r->tau;
  si *= r->tau;
  for (PetscInt j = k + 1; j <= hi; j++) {
    const PetscReal re = r->w.re[j], im = r->w.im[j];

    r->w.re[j] = r->tau * (re - (sr * r->v.re[j] + si * r->v.im[j]));
    r->w.im[j] = r->tau * (im - (si * r->v.re[j] - sr * r->v.im[j]));
  }
  for (PetscInt i = lo; i <= hi; i++) {
    r->u.re[i] *= r->tau;
    r->u.im[i] *= r->tau;
  }
}

void MpmSmallHessenberg(PetscInt n, PetscReal a[], PetscInt lo, PetscInt hi)
{
  Reflection one, other, *last = &one, *next = &other;

  if (hi - lo < 2) return;
  for (PetscInt i = lo; i <= hi; i++) {
    last->v.re[i] = last->v.im[i] = last->u.re[i] = last->u.im[i] = 0;
    last->w.re[i] = last->w.im[i] = 0;
  }
  for (PetscInt k = lo; k < hi - 1; k++) {
    const PetscInt from = PetscMax(lo, k / ROWS * ROWS);
    Reflection    *kept = last;

    Change(last, lo, hi, k, MpmRe(n, a, k), MpmIm(n, a, k));
    Begin(n, a, k, lo, hi, next);
    for (PetscInt j = k + 1; j <= hi; j++) {
      EndAbove(last, lo, from - 1, j, MpmRe(n, a, j), MpmIm(n, a, j), next);
      EndAndMultiply(last, from, hi, j, MpmRe(n, a, j), MpmIm(n, a, j), next);
    }
    Finish(next, k, lo, hi);
    last = next;
    next = kept;
  }
  for (PetscInt j = hi - 1; j <= hi; j++) Change(last, lo, hi, j, MpmRe(n, a, j), MpmIm(n, a, j));
}
