/* The smaller matrix of a matrix A = C + B Z: its check, and what is said of A by it alone. */
#include "linalg/dense.h"
#include "linalg/reduced.h"
#include "linalg/singular.h"
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

/* The norm of left x - kept x - (second of first of x), relative to those of x and left x. */
static PetscErrorCode Difference(Mat left, Vec kept, Mat first, Mat second, PetscInt seed, PetscReal *largest)
{
  Vec       x, y, between, image;
  PetscReal norm, image_norm, rest;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(left, &x, &y));
  PetscCall(MatCreateVecs(first, NULL, &between));
  PetscCall(VecDuplicate(x, &image));
  PetscCall(MpmSingularStart(seed, x));
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
  PetscCall(MpmSingularStart(seed, q));
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

/* ---- powers: the transpose goes through the formula from the end ---- */

PetscErrorCode MpmReducedPowersCreate(const MpmReduced *r, Vec weights, MpmReducedPowers *p)
{
  PetscFunctionBegin;
  *p = (MpmReducedPowers){.reduced = r, .weights = weights};
  PetscCall(MatCreateVecs(r->M, &p->z[0], &p->z[1]));
  PetscCall(VecDuplicate(r->kept, &p->work[0]));
  PetscCall(VecDuplicate(r->kept, &p->work[1]));
  for (PetscInt k = 0; k < r->nkept; k++) PetscCall(VecDuplicate(p->z[0], &p->sum[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReducedPowersDestroy(MpmReducedPowers *p)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < p->reduced->nkept; k++) PetscCall(VecDestroy(&p->sum[k]));
  for (int i = 0; i < 2; i++) {
    PetscCall(VecDestroy(&p->z[i]));
    PetscCall(VecDestroy(&p->work[i]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Selects what belongs to number k: y += D_k (power x + image). */
static PetscErrorCode AddRows(const MpmReduced *r, PetscInt k, PetscReal power, Vec x, Vec image, Vec y)
{
  const PetscReal *kept, *old, *add;
  PetscReal       *sum;
  PetscInt         n;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(y, &n));
  PetscCall(VecGetArrayRead(r->kept, &kept));
  PetscCall(VecGetArrayRead(x, &old));
  PetscCall(VecGetArrayRead(image, &add));
  PetscCall(VecGetArray(y, &sum));
  for (PetscInt i = 0; i < n; i++)
    if (kept[i] == r->number[k]) sum[i] += power * old[i] + add[i];
  PetscCall(VecRestoreArray(y, &sum));
  PetscCall(VecRestoreArrayRead(image, &add));
  PetscCall(VecRestoreArrayRead(x, &old));
  PetscCall(VecRestoreArrayRead(r->kept, &kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Swap(Vec *a, Vec *b)
{
  const Vec c = *a;

  *a = *b;
  *b = c;
}

/* y, which is not x, is 0 and becomes A^n x. */
static PetscErrorCode Forward(const MpmReducedPowers *p, PetscInt n, const PetscInt shift[], Vec x, Vec y)
{
  const MpmReduced *r = p->reduced;
  Vec               z = p->z[0], next = p->z[1];
  PetscReal         power[MPM_REDUCED_KEPT];

  PetscFunctionBegin;
  PetscCall(MatMult(r->Z, x, z));
  for (PetscInt k = 0; k < r->nkept; k++) {
    PetscCall(VecSet(p->sum[k], 0));
    power[k] = 1;
  }
  for (PetscInt j = 0; j < n; j++) {
    const PetscReal scale = scalbn(1, -(int)shift[j]);

    for (PetscInt k = 0; k < r->nkept; k++) {
      PetscCall(VecAXPBY(p->sum[k], scale, scale * r->number[k], z));
      power[k] *= scale * r->number[k];
    }
    if (j == n - 1) break;
    PetscCall(MatMult(r->M, z, next));
    if (shift[j]) PetscCall(VecScale(next, scale));
    Swap(&z, &next);
  }
  for (PetscInt k = 0; k < r->nkept; k++) {
    PetscCall(MatMult(r->B, p->sum[k], p->work[1]));
    PetscCall(AddRows(r, k, power[k], x, p->work[1], y));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same of the transpose: Z^T sum over j of (M^T)^j B^T C^(n-1-j) x, by Horner's rule. */
static PetscErrorCode Backward(const MpmReducedPowers *p, PetscInt n, const PetscInt shift[], Vec x, Vec y)
{
  const MpmReduced *r = p->reduced;
  Vec               z = p->z[0], next = p->z[1];
  PetscReal         power[MPM_REDUCED_KEPT];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < r->nkept; k++) {
    PetscCall(VecSet(y, 0));
    PetscCall(VecSet(p->work[1], 0));
    PetscCall(AddRows(r, k, 1, x, p->work[1], y)); /* D_k x */
    PetscCall(MatMultTranspose(r->B, y, p->sum[k]));
    power[k] = 1;
  }
  PetscCall(VecSet(z, 0));
  for (PetscInt j = n - 1; j >= 0; j--) {
    const PetscReal scale = scalbn(1, -(int)shift[j]);

    PetscCall(MatMultTranspose(r->M, z, next));
    for (PetscInt k = 0; k < r->nkept; k++) {
      PetscCall(VecAXPY(next, power[k], p->sum[k]));
      power[k] *= scale * r->number[k];
    }
    if (shift[j]) PetscCall(VecScale(next, scale));
    Swap(&z, &next);
  }
  PetscCall(MatMultTranspose(r->Z, z, p->work[1]));
  PetscCall(VecCopy(p->work[1], y));
  PetscCall(VecSet(p->work[1], 0));
  for (PetscInt k = 0; k < r->nkept; k++) PetscCall(AddRows(r, k, power[k], x, p->work[1], y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReducedPowersMult(const MpmReducedPowers *p, PetscInt n, const PetscInt shift[], PetscBool transpose,
                                    Vec x, Vec y)
{
  PetscFunctionBegin;
  if (!p->weights)
    PetscCall(VecCopy(x, p->work[0]));
  else if (transpose)
    PetscCall(VecPointwiseMult(p->work[0], x, p->weights));
  else
    PetscCall(VecPointwiseDivide(p->work[0], x, p->weights));
  PetscCall(VecSet(y, 0));
  PetscCall((transpose ? Backward : Forward)(p, n, shift, p->work[0], y));
  if (p->weights && transpose)
    PetscCall(VecPointwiseDivide(y, y, p->weights));
  else if (p->weights)
    PetscCall(VecPointwiseMult(y, y, p->weights));
  PetscFunctionReturn(PETSC_SUCCESS);
}
