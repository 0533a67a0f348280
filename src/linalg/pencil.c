/* The least x at which C_0 + x C_1 has the eigenvalue -1: one factorisation and the eigenvalues of a small matrix. */
#include "linalg/dense.h"
#include "linalg/lapack_names.h"
#include "linalg/pencil.h"
#include <math.h>
#include <petscblaslapack.h>
#include <slepceps.h>

#define BASIS 64       /* vectors of the Krylov space */
#define ACCURACY 1e-11 /* of its eigenvalue */
#define RESTARTS 1000
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

PetscErrorCode MpmPencilLeastKrylov(Mat C0, Mat C1, PetscReal *x)
{
  EPS       eps;
  ST        st;
  KSP       ksp;
  PC        pc;
  PetscInt  order, found;
  PetscReal re, im;

  PetscFunctionBegin;
  *x = NAN;
  PetscCall(MatShift(C0, 1));
  PetscCall(MatGetSize(C0, &order, NULL));
  PetscCall(EPSCreate(PetscObjectComm((PetscObject)C0), &eps));
  PetscCall(EPSSetOperators(eps, C1, C0));
  PetscCall(EPSSetProblemType(eps, EPS_GNHEP));
  PetscCall(EPSSetWhichEigenpairs(eps, EPS_SMALLEST_REAL));
  PetscCall(EPSSetDimensions(eps, 1, PetscMin(BASIS, order), PETSC_DETERMINE));
  PetscCall(EPSSetTolerances(eps, ACCURACY, RESTARTS));
  PetscCall(EPSGetST(eps, &st));
  PetscCall(STGetKSP(st, &ksp));
  PetscCall(KSPSetType(ksp, KSPGMRES));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCNONE));
  PetscCall(KSPSetTolerances(ksp, ACCURACY / 100, PETSC_DEFAULT, PETSC_DEFAULT, RESTARTS));
  PetscCall(EPSSolve(eps));
  PetscCall(EPSGetConverged(eps, &found));
  if (found) {
    PetscCall(EPSGetEigenvalue(eps, 0, &re, &im));
    *x = re >= 0 ? INFINITY : fabs(im) <= REAL * fabs(re) ? -1 / re : NAN;
  }
  PetscCall(EPSDestroy(&eps));
  PetscFunctionReturn(PETSC_SUCCESS);
}
