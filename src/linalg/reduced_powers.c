/* Powers of a matrix by its smaller one: see the formula in the header. The transpose goes through it from the end. */
#include "linalg/reduced_powers.h"
#include <math.h>

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
