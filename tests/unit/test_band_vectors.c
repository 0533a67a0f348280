/*
   Inverse iteration on a band gives a vector for each of LAPACK's eigenvalues: of rings, bars, defective, equal and many
   eigenvalues at one place, and of matrices whose solution would overflow.
*/
#include "check.h"
#include "base/hash.h"
#include "linalg/eigen_parts.h"
#include "linalg/dense.h"

#define N 300
#define ALLOWED 1e-13 /* residual, over the norm */

typedef enum { RING, BAR, EQUAL, DEFECTIVE, CHAIN, ZERO } Kind;

static PetscReal Random(PetscInt seed, PetscInt i)
{
  return 2 * MpmHash(seed, i) - 1;
}

static PetscReal Entry(Kind kind, PetscInt i, PetscInt j)
{
  const PetscInt apart = abs((int)(i - j)), around = PetscMin(apart, N - apart);

  switch (kind) {
  case RING:
    return around <= 2 ? Random(1, N * i + j) : 0;
  case BAR:
    return apart <= 5 ? Random(2, N * i + j) : 0;
  case EQUAL:
    return around == 0 ? 2 : around == 1 ? -1 : 0; /* 2 - 2 cos of n phases, all but two in pairs */
  case DEFECTIVE:
    return i == j ? 1 : i % 2 == 0 && j == i + 1; /* blocks [1 1; 0 1] */
  case CHAIN:
    return i == j ? 1 : j == i + 1 ? 2 : 0; /* one Jordan block */
  case ZERO:
    return 0;
  }
  return 0;
}

/* Returns norm(A x - (re + i im) x), of parts of the vector x; the imaginary part may be NULL. */
static PetscReal Residual(Kind kind, PetscReal re, PetscReal im, const PetscReal x[], const PetscReal y[])
{
  PetscReal sum = 0;

  for (PetscInt i = 0; i < N; i++) {
    PetscReal r = -re * x[i] + (y ? im * y[i] : 0), s = y ? -re * y[i] - im * x[i] : 0;

    for (PetscInt j = 0; j < N; j++) {
      r += Entry(kind, i, j) * x[j];
      s += y ? Entry(kind, i, j) * y[j] : 0;
    }
    sum += r * r + s * s;
  }
  return sqrt(sum);
}

static PetscReal Dot(const PetscReal x[], const PetscReal y[])
{
  PetscReal sum = 0;

  for (PetscInt i = 0; i < N; i++) sum += x[i] * y[i];
  return sum;
}

/* fmax takes NaN for no number. */
static PetscReal Larger(PetscReal a, PetscReal b)
{
  return a >= b ? a : b;
}

/* Finds eigenvalues and vectors, for the caller to free. */
static PetscErrorCode Solve(Kind kind, PetscReal **re, PetscReal **im, PetscReal **a, PetscReal *norm)
{
  MpmBandVectors *band;
  int             failed;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(N, re, N, im, N * N, a));
  *norm = 0;
  for (PetscInt i = 0; i < N; i++) {
    PetscReal sum = 0;

    for (PetscInt j = 0; j < N; j++) {
      (*a)[N * j + i] = Entry(kind, i, j);
      sum += fabs(Entry(kind, i, j));
    }
    *norm = PetscMax(*norm, sum);
  }
  PetscCall(MpmBandVectorsCreate(N, *a, &band));
  PetscCheck(band, PETSC_COMM_SELF, PETSC_ERR_PLIB, "kind %d is taken for no band", (int)kind);
  PetscCall(MpmDenseEigen(N, *a, *re, *im, NULL, &failed));
  CHECK(!failed, "LAPACK failed");
  PetscCall(MpmBandVectorsFind(band, *re, *im, *a));
  PetscCall(MpmBandVectorsDestroy(&band));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckKind(Kind kind)
{
  PetscReal *re, *im, *vectors, norm = 0, most = 0, length = 0;
  PetscInt   pairs = 0, parallel = 0;

  PetscFunctionBegin;
  PetscCall(Solve(kind, &re, &im, &vectors, &norm));
  for (PetscInt j = 0; j < N; j++) {
    const PetscReal *x = vectors + N * j, *y = im[j] == 0 ? NULL : x + N;

    if (im[j] < 0) continue;
    most   = Larger(most, Residual(kind, re[j], im[j], x, y));
    length = Larger(length, fabs(Dot(x, x) + (y ? Dot(y, y) : 0) - 1));
    for (PetscInt k = 0; k < j; k++)
      if (kind == EQUAL && fabs(re[j] - re[k]) < 1e-10) {
        pairs++;
        parallel += fabs(Dot(x, vectors + N * k)) > 0.99;
      }
  }
  CHECK(most <= ALLOWED * norm, "kind %d: residual %.3g, norm %.3g", (int)kind, most, norm);
  CHECK(length <= 1e-12, "kind %d: a vector's norm^2 is %.3g from 1", (int)kind, length);
  CHECK(parallel <= pairs / 4, "of %d pairs of vectors %d are parallel", (int)pairs, (int)parallel);
  PetscCall(PetscFree3(re, im, vectors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* LAPACK's vectors are cheaper for a band this wide. */
static PetscErrorCode CheckWide(void)
{
  PetscReal      *a;
  MpmBandVectors *band;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(N * N, &a));
  for (PetscInt i = 0; i < N * N; i++) a[i] = Random(3, i);
  PetscCall(MpmBandVectorsCreate(N, a, &band));
  CHECK(!band, "a full matrix is taken for a band");
  PetscCall(MpmBandVectorsDestroy(&band));
  PetscCall(PetscFree(a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (Kind kind = RING; kind <= ZERO; kind++) PetscCall(CheckKind(kind));
  PetscCall(CheckWide());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
