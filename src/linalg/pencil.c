/* The least x at which C_0 + x C_1 has the eigenvalue -1: one factorisation and the eigenvalues of a small matrix. */
#include "linalg/dense.h"
#include "linalg/lapack_names.h"
#include "linalg/pencil.h"
#include <math.h>
#include <petscblaslapack.h>

#define REAL 1e-9 /* an eigenvalue with a smaller share of imaginary part is real but for rounding */

/* The rows of a matrix that are not 0. Returns how many there are. */
static PetscInt Rows(PetscInt n, const PetscReal C[], PetscInt row[])
{
  PetscInt rows = 0;

  for (PetscInt i = 0; i < n; i++) {
    PetscInt j = 0;

    while (j < n && C[(size_t)j * n + i] == 0) j++;
    if (j < n) row[rows++] = i;
  }
  return rows;
}

PetscErrorCode MpmPencilLeast(PetscInt n, PetscReal C0[], const PetscReal C1[], PetscReal *x)
{
  const PetscReal one = 1, zero = 0;
  PetscReal      *units, *part, *small, *re, *im, least = 0;
  PetscInt       *row, r;
  PetscBLASInt    order, few, info, *pivot;
  int             failed = 0;

  PetscFunctionBegin;
  *x = INFINITY;
  PetscCall(PetscMalloc2(n, &row, n, &pivot));
  r = Rows(n, C1, row);
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCall(PetscBLASIntCast(r, &few));
  PetscCall(PetscCalloc1((size_t)n * r, &units));
  PetscCall(PetscMalloc4((size_t)n * r, &part, (size_t)r * r, &small, r, &re, r, &im));
  for (PetscInt i = 0; i < n; i++) C0[(size_t)i * (n + 1)] += 1;
  for (PetscInt i = 0; i < r; i++) units[(size_t)i * n + row[i]] = 1;
  for (PetscInt j = 0; j < n; j++)
    for (PetscInt i = 0; i < r; i++) part[(size_t)j * r + i] = C1[(size_t)j * n + row[i]];
  PetscCallBLAS("LAPACKgetrf", LAPACKgetrf_(&order, &order, C0, &order, pivot, &info));
  if (!info && r) {
    PetscCallBLAS("LAPACKgetrs", LAPACKgetrs_("N", &order, &few, C0, &order, pivot, units, &order, &info));
    PetscCallBLAS("BLASgemm",
                  BLASgemm_("N", "N", &few, &few, &order, &one, part, &few, units, &order, &zero, small, &few));
    PetscCall(MpmDenseEigen(r, small, re, im, NULL, &failed));
    for (PetscInt i = 0; i < r && !failed; i++)
      if (fabs(im[i]) <= REAL * fabs(re[i])) least = PetscMin(least, re[i]);
  }
  if (info || failed)
    *x = NAN;
  else if (least < 0)
    *x = -1 / least;
  PetscCall(PetscFree4(part, small, re, im));
  PetscCall(PetscFree(units));
  PetscCall(PetscFree2(row, pivot));
  PetscFunctionReturn(PETSC_SUCCESS);
}
