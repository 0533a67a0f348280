/*
   The time of all eigenvalues of a random complex matrix of each given order, by MpmSmallQr and by LAPACK's zgeev, and
   the rate of dgemm: a line of JSON an order. Each time is the least of several.
*/
#include "linalg/lapack_names.h"
#include "linalg/small_eigen.h"
#include <petscblaslapack.h>
#include <stdlib.h>
#include <time.h>

#define RUNS 15
#define MULTIPLIED 600 /* order of dgemm's matrices */

static double Now(void)
{
  struct timespec t;

  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void Fill(PetscInt n, double *a)
{
  for (PetscInt i = 0; i < n; i++) a[i] = drand48() - 0.5;
}

static PetscErrorCode Measure(PetscInt order)
{
  const PetscBLASInt m   = MULTIPLIED;
  const PetscInt     all = order * order, square = MULTIPLIED * MULTIPLIED;
  PetscScalar       *a, *b, *c, one = 1, none = 0;
  MpmSmallEigen      eigen;
  double             least[3] = {1e9, 1e9, 1e9}, begin;
  PetscBool          ok;

  PetscFunctionBegin;
  PetscCall(MpmSmallEigenCreate(order, &eigen));
  PetscCall(PetscMalloc3(square, &a, square, &b, square, &c));
  Fill(square, a);
  Fill(square, b);
  for (int run = 0; run < RUNS; run++) {
    Fill(2 * all, (double *)eigen.left);
    PetscCall(PetscArraycpy(eigen.matrix, eigen.left, all));
    begin = Now();
    MpmSmallQr(order, eigen.matrix, eigen.value, &ok);
    least[0] = PetscMin(least[0], Now() - begin);
    PetscCall(PetscArraycpy(eigen.matrix, eigen.left, all));
    begin = Now();
    PetscCall(MpmSmallEigenLapack(&eigen));
    least[1] = PetscMin(least[1], Now() - begin);
    begin    = Now();
    BLASgemm_("N", "N", &m, &m, &m, &one, a, &m, b, &m, &none, c, &m);
    least[2] = PetscMin(least[2], Now() - begin);
  }
  PetscCall(PetscPrintf(
      PETSC_COMM_SELF, "{\"order\": %d, \"own_s\": %.9g, \"lapack_s\": %.9g, \"dgemm_s\": %.9g, \"dgemm_order\": %d}\n",
      (int)order, least[0], least[1], least[2], MULTIPLIED));
  PetscCall(PetscFree3(a, b, c));
  PetscCall(MpmSmallEigenDestroy(&eigen));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  if (PetscInitialize(&argc, &argv, NULL, NULL)) return 2;
  for (int i = 1; i < argc; i++)
    if (Measure(atoi(argv[i]))) return 1;
  return PetscFinalize() ? 1 : 0;
}
