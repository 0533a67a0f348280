/*
   The eigenvalues of small matrices by QR steps are those of LAPACK, and those of matrices that are known: triangular in
   some order, cyclic, badly scaled, huge.
*/
#include "check.h"
#include "base/hash.h"
#include "linalg/small_eigen.h"

static double complex Random(PetscInt seed, PetscInt i)
{
  return CMPLX(2 * MpmHash(seed, 2 * i) - 1, 2 * MpmHash(seed, 2 * i + 1) - 1);
}

/* The largest distance from one of n numbers to the nearest that is left of the others; takes these apart. */
static PetscReal Apart(PetscInt n, const double complex one[], double complex other[])
{
  PetscReal most = 0;

  for (PetscInt i = 0; i < n; i++) {
    PetscInt nearest = i;

    for (PetscInt j = i; j < n; j++)
      if (cabs(other[j] - one[i]) < cabs(other[nearest] - one[i])) nearest = j;
    most           = fmax(most, cabs(other[nearest] - one[i]));
    other[nearest] = other[i];
  }
  return most;
}

/* Fills a matrix of a kind; all of them have norms of about 1. */
static void Fill(PetscInt kind, PetscInt n, double complex a[])
{
  const PetscInt rank = n / 3 + 1;

  for (PetscInt j = 0; j < n; j++)
    for (PetscInt i = 0; i < n; i++) {
      double complex z = Random(kind, n * j + i) / sqrt((double)n);

      if (kind == 1) { /* many eigenvalues at 1, as those of a symbol */
        z = i == j ? 1 : 0;
        for (PetscInt k = 0; k < rank; k++) z += Random(2, n * i + k) * Random(3, n * j + k) / (double)n;
      }
      if (kind == 2) z *= exp2(i % 5 - j % 5) * exp2(20 * (i % 2) - 20 * (j % 2)); /* badly scaled */
      if (kind == 3) z = i == (j + 1) % n ? 1 : 0;                                 /* all roots of 1 */
      a[n * j + i] = z;
    }
}

static PetscErrorCode CheckOne(PetscInt kind, PetscInt n, PetscReal scale)
{
  MpmSmallEigen   e;
  double complex *value;
  PetscBool       ok;
  PetscReal       apart;

  PetscFunctionBegin;
  PetscCall(MpmSmallEigenCreate(n, &e));
  PetscCall(PetscMalloc1(n, &value));
  Fill(kind, n, e.matrix);
  PetscCall(MpmSmallEigenLapack(&e));
  PetscCall(PetscArraycpy(value, e.value, n));
  Fill(kind, n, e.matrix);
  for (PetscInt i = 0; i < n * n; i++) e.matrix[i] *= scale;
  MpmSmallQr(n, e.matrix, e.value, &ok);
  for (PetscInt i = 0; i < n; i++) e.value[i] /= scale;
  apart = Apart(n, value, e.value);
  CHECK(ok && apart <= 1e-12, "kind %d, order %d, scale %g: %.3g apart", (int)kind, (int)n, scale, apart);
  PetscCall(PetscFree(value));
  PetscCall(MpmSmallEigenDestroy(&e));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A matrix that is triangular when its rows and columns are sorted has its diagonal's numbers for eigenvalues, exactly. */
static void CheckTriangular(PetscInt n)
{
  double complex a[144], value[12], exact[12];
  PetscBool      ok;

  for (PetscInt j = 0; j < n; j++)
    for (PetscInt i = 0; i < n; i++) {
      const PetscInt row = 5 * i % n, column = 5 * j % n;

      if (i == j) exact[i] = Random(7, i);
      a[n * j + i] = i == j ? exact[i] : row < column ? Random(8, n * j + i) : 0;
    }
  MpmSmallQr(n, a, value, &ok);
  CHECK(ok && Apart(n, exact, value) == 0, "triangular of order %d", (int)n);
}

/* A defective pair splits by the root of rounding, and no more. */
static void CheckDefective(void)
{
  double complex a[4] = {0.7, 0.3 * I, 0.3 * I, 1.3}, value[2];
  PetscBool      ok;

  MpmSmallQr(2, a, value, &ok);
  CHECK(ok && cabs(value[0] - 1) < 3e-8 && cabs(value[1] - 1) < 3e-8, "%.17g and %.17g", creal(value[0]),
        creal(value[1]));
}

static PetscErrorCode Test(int argc, char **argv)
{
  const PetscInt orders[] = {1, 2, 3, 4, 5, 8, 20, 51, 62, 72, 144};

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (PetscInt kind = 0; kind < 4; kind++)
    for (size_t i = 0; i < sizeof orders / sizeof *orders; i++) PetscCall(CheckOne(kind, orders[i], 1));
  PetscCall(CheckOne(0, MPM_SMALL_QR_MOST, 1));
  PetscCall(CheckOne(0, 6, 1e300));
  PetscCall(CheckOne(0, 6, 1e-290));
  CheckTriangular(3);
  CheckTriangular(12);
  CheckDefective();
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
