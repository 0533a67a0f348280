/* The smaller matrix of a matrix A = C + B Z: its check, and what is said of A by it alone. */
#include "base/hash.h"
#include "linalg/dense.h"
#include "linalg/reduced.h"
#include <petscksp.h>
#include <math.h>

#define VECTORS 2          /* random ones of a check */
#define UNSEEN 1e-13       /* relative tolerance of LSQR */
#define UNSEEN_STEPS 10000 /* of LSQR */
#define SPLIT 8            /* rounding of a defective pair, in units of sqrt(1e-16 norm) */

PetscErrorCode MpmReducedDestroy(MpmReduced **reduced)
{
  PetscFunctionBegin;
  if (!*reduced) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatDestroy(&(*reduced)->M));
  PetscCall(MatDestroy(&(*reduced)->B));
  PetscCall(MatDestroy(&(*reduced)->Z));
  PetscCall(VecDestroy(&(*reduced)->kept));
  PetscCall(VecDestroy(&(*reduced)->kept_small));
  PetscCall(PetscFree(*reduced));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same numbers on any number of ranks. */
static PetscErrorCode SetRandom(PetscInt seed, Vec x)
{
  PetscInt   begin, end;
  PetscReal *values;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(x, &begin, &end));
  PetscCall(VecGetArrayWrite(x, &values));
  for (PetscInt row = begin; row < end; row++) values[row - begin] = MpmHash(seed, row) - 0.5;
  PetscCall(VecRestoreArrayWrite(x, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The norm of left x - kept x - (second of first of x), relative to those of x and left x. */
static PetscErrorCode Difference(Mat left, Vec kept, Mat first, Mat second, PetscInt seed, PetscReal *largest)
{
  Vec       x, y, between, image;
  PetscReal norm, image_norm, rest;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(left, &x, &y));
  PetscCall(MatCreateVecs(first, NULL, &between));
  PetscCall(VecDuplicate(x, &image));
  PetscCall(SetRandom(seed, x));
  PetscCall(MatMult(left, x, image));
  PetscCall(VecNorm(x, NORM_2, &norm));
  PetscCall(VecNorm(image, NORM_2, &image_norm));
  PetscCall(VecPointwiseMult(y, kept, x));
  PetscCall(VecAXPY(image, -1, y));
  PetscCall(MatMult(first, x, between));
  PetscCall(MatMult(second, between, y));
  PetscCall(VecAXPY(image, -1, y));
  PetscCall(VecNorm(image, NORM_2, &rest));
  rest /= PetscMax(norm, image_norm);
  if (!(rest <= *largest)) *largest = rest; /* NaN is the largest */
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscCall(VecDestroy(&between));
  PetscCall(VecDestroy(&image));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReducedCheck(Mat A, MpmReduced *r)
{
  PetscFunctionBegin;
  r->mismatch = 0;
  for (PetscInt v = 0; v < VECTORS; v++) {
    PetscCall(Difference(A, r->kept, r->Z, r->B, v, &r->mismatch));
    PetscCall(Difference(r->M, r->kept_small, r->B, r->Z, v, &r->mismatch));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Least squares: x of smallest norm with Z x = z. */
static PetscErrorCode LeastSquares(Mat Z, Vec z, Vec x)
{
  KSP ksp;
  PC  pc;

  PetscFunctionBegin;
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)Z), &ksp));
  PetscCall(KSPSetOperators(ksp, Z, Z));
  PetscCall(KSPSetType(ksp, KSPLSQR));
  PetscCall(KSPGetPC(ksp, &pc));
  PetscCall(PCSetType(pc, PCNONE));
  PetscCall(KSPSetTolerances(ksp, UNSEEN, PETSC_DEFAULT, PETSC_DEFAULT, UNSEEN_STEPS));
  PetscCall(KSPSolve(ksp, z, x));
  PetscCall(KSPDestroy(&ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReducedUnseen(const MpmReduced *r, PetscInt k, PetscInt seed, Vec q)
{
  PetscInt         n;
  PetscReal       *values, norm;
  const PetscReal *kept;
  Vec              z, seen;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(r->Z, &seen, &z));
  PetscCall(SetRandom(seed, q));
  PetscCall(VecGetLocalSize(q, &n));
  PetscCall(VecGetArray(q, &values));
  PetscCall(VecGetArrayRead(r->kept, &kept));
  for (PetscInt i = 0; i < n; i++)
    if (kept[i] != r->number[k]) values[i] = 0;
  PetscCall(VecRestoreArrayRead(r->kept, &kept));
  PetscCall(VecRestoreArray(q, &values));
  PetscCall(MatMult(r->Z, q, z));
  PetscCall(LeastSquares(r->Z, z, seen));
  PetscCall(VecAXPY(q, -1, seen));
  PetscCall(VecNorm(q, NORM_2, &norm));
  if (norm > 0) PetscCall(VecScale(q, 1 / norm));
  PetscCall(VecDestroy(&seen));
  PetscCall(VecDestroy(&z));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt MpmReducedKept(const MpmReduced *r, PetscReal norm, PetscReal re, PetscReal im)
{
  for (PetscInt k = 0; k < r->nkept; k++)
    if (hypot(re - r->number[k], im) <= SPLIT * sqrt(PETSC_MACHINE_EPSILON * PetscMax(1, norm))) return k;
  return -1;
}

PetscErrorCode MpmReducedLargest(const MpmReduced *r, PetscReal value[2])
{
  PetscReal norm;
  PetscInt  near;

  PetscFunctionBegin;
  PetscCall(MpmDenseLargest(r->M, value));
  PetscCall(MatNorm(r->M, NORM_INFINITY, &norm));
  if (!isfinite(value[0])) PetscFunctionReturn(PETSC_SUCCESS);
  near = MpmReducedKept(r, norm, value[0], value[1]);
  if (near >= 0) {
    value[0] = r->number[near];
    value[1] = 0;
  }
  for (PetscInt k = 0; k < r->nkept; k++)
    if (r->count[k] > r->count_small[k] && fabs(r->number[k]) > hypot(value[0], value[1])) {
      value[0] = r->number[k];
      value[1] = 0;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}
