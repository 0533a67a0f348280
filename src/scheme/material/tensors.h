/*
   Small tensors. Those of F's kind are dim x dim, row by row; symmetric ones have the order 00 01 02 11 12 22. The
   number of dimensions is a constant where these functions are inlined, so that components are registers.
*/
#pragma once
#include <mpmstab/compat.h>

#define INLINE static inline __attribute__((always_inline))

/*
   UNROLL: a loop over components is written out, or else the loop over particles is not one over vectors. INDEPENDENT:
   the particles of a loop do not depend on one another.
*/
#ifdef __clang__
#define UNROLL _Pragma("clang loop unroll(full)")
#define INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define UNROLL _Pragma("GCC unroll 16")
#define INDEPENDENT _Pragma("GCC ivdep")
#endif
#define EACH(c, n) UNROLL for (PetscInt c = 0; c < (n); c++)
#define FOR_PAIRS(dim, a, b)                                                                                           \
  EACH (a, dim) UNROLL for (PetscInt b = a; b < (dim); b++)

/* The place of component ab of a symmetric tensor, for a <= b. */
INLINE PetscInt Pair(PetscInt dim, PetscInt a, PetscInt b)
{
  return a * dim - a * (a - 1) / 2 + b - a;
}

/* Component ab of a symmetric tensor, for any a and b. */
INLINE PetscReal Of(PetscInt dim, const PetscReal s[], PetscInt a, PetscInt b)
{
  return a <= b ? s[Pair(dim, a, b)] : s[Pair(dim, b, a)];
}

INLINE PetscReal Trace(PetscInt dim, const PetscReal s[])
{
  PetscReal sum = 0;

  EACH (a, dim) sum += s[Pair(dim, a, a)];
  return sum;
}

/* s : t */
INLINE PetscReal Contract(PetscInt dim, const PetscReal s[], const PetscReal t[])
{
  PetscReal sum = 0;

  FOR_PAIRS (dim, a, b) sum += (a == b ? 1 : 2) * s[Pair(dim, a, b)] * t[Pair(dim, a, b)];
  return sum;
}

/* a A + b I for a symmetric A */
INLINE void Shifted(PetscInt dim, PetscReal a, const PetscReal A[], PetscReal b, PetscReal out[])
{
  FOR_PAIRS (dim, i, j) out[Pair(dim, i, j)] = a * A[Pair(dim, i, j)] + (i == j ? b : 0);
}

/* B = F F^T */
INLINE void LeftProduct(PetscInt dim, const PetscReal F[], PetscReal B[])
{
  FOR_PAIRS (dim, a, b) {
    B[Pair(dim, a, b)] = 0;
    EACH (c, dim) B[Pair(dim, a, b)] += F[a * dim + c] * F[b * dim + c];
  }
}

/* dB = dF F^T + F dF^T */
INLINE void LeftDifferential(PetscInt dim, const PetscReal F[], const PetscReal dF[], PetscReal dB[])
{
  FOR_PAIRS (dim, a, b) {
    dB[Pair(dim, a, b)] = 0;
    EACH (c, dim) dB[Pair(dim, a, b)] += dF[a * dim + c] * F[b * dim + c] + F[a * dim + c] * dF[b * dim + c];
  }
}

/* The component ab of the cofactor matrix, d(det F) / dF_ab. */
INLINE PetscReal Cofactor(PetscInt dim, const PetscReal F[], PetscInt a, PetscInt b)
{
  const PetscInt a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;

  if (dim == 1) return 1;
  if (dim == 2) return (a == b ? 1 : -1) * F[(1 - a) * 2 + 1 - b];
  return F[a1 * 3 + b1] * F[a2 * 3 + b2] - F[a1 * 3 + b2] * F[a2 * 3 + b1];
}

INLINE PetscReal Volume(PetscInt dim, const PetscReal F[])
{
  PetscReal J = 0;

  EACH (b, dim) J += F[b] * Cofactor(dim, F, 0, b);
  return J;
}

/* The differential of det F. */
INLINE PetscReal VolumeDifferential(PetscInt dim, const PetscReal F[], const PetscReal dF[])
{
  PetscReal dJ = 0;

  EACH (a, dim)
    EACH (b, dim) dJ += Cofactor(dim, F, a, b) * dF[a * dim + b];
  return dJ;
}

/* det F - 1 from H = F - I, tr H + its second invariant + det H, so that small strains keep their digits. */
INLINE PetscReal VolumeChange(PetscInt dim, const PetscReal F[])
{
  PetscReal H[9], change = 0;

  EACH (c, dim * dim) H[c] = F[c] - (c % (dim + 1) == 0 ? 1 : 0);
  EACH (a, dim) change += H[a * dim + a];
  if (dim > 1)
    EACH (a, dim)
      UNROLL for (PetscInt b = a + 1; b < dim; b++) change +=
          H[a * dim + a] * H[b * dim + b] - H[a * dim + b] * H[b * dim + a];
  return dim > 2 ? change + Volume(dim, H) : change;
}

/* tr B - dim = 2 tr H + H : H with H = F - I, for the same reason. */
INLINE PetscReal LeftTraceChange(PetscInt dim, const PetscReal F[])
{
  PetscReal trace = 0, squares = 0;

  EACH (c, dim * dim) {
    const PetscReal h = F[c] - (c % (dim + 1) == 0 ? 1 : 0);

    if (c % (dim + 1) == 0) trace += h;
    squares += h * h;
  }
  return 2 * (trace + squares / 2);
}
