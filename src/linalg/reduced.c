/* The smaller matrix of a matrix A = C + B Z: its check, and what is said of A by it alone. */
#include "linalg/dense.h"
#include "linalg/eigen.h"
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

/*
   ---- eigenvalues ----

   Eigenvalues of A by its smaller matrix M. Vectors of M are lifted and their residuals are those of A, so a wrong pair
   is not listed. The numbers that A keeps are listed as often as the determinants say (see linalg/reduced.h); their
   residual is that of a random vector that Z does not see, and so that of almost all such vectors.
*/

static PetscErrorCode Lift(const MpmEigen *e, PetscInt j, Vec re, Vec im)
{
  const MpmReduced *r = e->reduced;
  const PetscReal   a = e->small->re[j], b = e->small->im[j], *kept;
  PetscInt          n;
  PetscReal        *x[2];
  Vec               z[2];

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(r->M, &z[0], &z[1]));
  PetscCall(MpmEigenVector(e->small, j, z[0], z[1]));
  PetscCall(MatMult(r->B, z[0], re));
  if (b == 0)
    PetscCall(VecSet(im, 0));
  else
    PetscCall(MatMult(r->B, z[1], im));
  PetscCall(VecGetLocalSize(re, &n));
  PetscCall(VecGetArrayRead(r->kept, &kept));
  PetscCall(VecGetArray(re, &x[0]));
  PetscCall(VecGetArray(im, &x[1]));
  for (PetscInt i = 0; i < n; i++) {
    const PetscReal d = a - kept[i], size = d * d + b * b, old = x[0][i];

    x[0][i] = (old * d + x[1][i] * b) / size;
    x[1][i] = (x[1][i] * d - old * b) / size;
  }
  PetscCall(VecRestoreArray(im, &x[1]));
  PetscCall(VecRestoreArray(re, &x[0]));
  PetscCall(VecRestoreArrayRead(r->kept, &kept));
  PetscCall(VecDestroy(&z[0]));
  PetscCall(VecDestroy(&z[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A place below 0 stands for a kept number and for one of its vectors. */
static PetscInt PlaceOfKept(const MpmReduced *r, PetscInt k, PetscInt which)
{
  return -1 - k - r->nkept * which;
}

static PetscErrorCode Vector(const MpmEigen *e, PetscInt j, Vec re, Vec im)
{
  const PetscInt place = e->place[j], kept = -1 - place;

  PetscFunctionBegin;
  if (place >= 0)
    PetscCall(Lift(e, place, re, im));
  else {
    PetscCall(MpmReducedUnseen(e->reduced, kept % e->reduced->nkept, kept / e->reduced->nkept, re));
    PetscCall(VecSet(im, 0));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   How often kept number k is listed, which near eigenvalues of M are but for rounding. Beside eigenvalues of largest abs it is
   one of them, if it is larger than the last.
*/
static PetscInt TimesKept(const MpmEigen *e, PetscInt near, PetscInt k, PetscReal least)
{
  const MpmReduced *r    = e->reduced;
  const PetscInt    left = r->count[k] - r->count_small[k];

  if (e->small->complete) return near + left;
  if (e->small->leftmost) return PetscMin(1, left);
  return e->small->largest && fabs(r->number[k]) >= least ? PetscMin(PetscMax(1, near), left) : 0;
}

static PetscErrorCode ListKept(MpmEigen *e, const PetscInt near[])
{
  PetscReal least = PETSC_MAX_REAL;
  PetscBool listed;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < e->small->n; j++) least = PetscMin(least, hypot(e->small->re[j], e->small->im[j]));
  for (PetscInt k = 0; k < e->reduced->nkept; k++) {
    const PetscInt times = TimesKept(e, near[k], k, least);

    listed = PETSC_TRUE;
    for (PetscInt i = 0; listed && i < times; i++)
      PetscCall(MpmEigenTry(e, PlaceOfKept(e->reduced, k, i), e->reduced->number[k], 0, i ? e->residual[e->n - 1] : NAN,
                            &listed));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of a complex pair the residual of the second is that of the first. */
static PetscErrorCode List(MpmEigen *e, PetscBool near_target)
{
  const MpmEigen *small                  = e->small;
  PetscInt        near[MPM_REDUCED_KEPT] = {0}, rejected = 0; /* near: a kept number but for rounding */
  PetscBool       listed;

  PetscFunctionBegin;
  PetscCall(MpmEigenListBegin(e, e->order + small->n + MPM_REDUCED_KEPT));
  for (PetscInt j = 0; j < small->n; j++) {
    const PetscReal re = small->re[j], im = small->im[j];
    const PetscInt  k = near_target ? -1 : MpmReducedKept(e->reduced, small->norm, re, im), last = e->n - 1;

    if (k >= 0) {
      near[k]++;
      continue;
    }
    PetscCall(MpmEigenTry(e, j, re, im,
                          im < 0 && last >= 0 && e->re[last] == re && e->im[last] == -im ? e->residual[last] : NAN,
                          &listed));
    rejected += listed ? 0 : 1;
  }
  PetscCall(ListKept(e, near));
  PetscCall(MpmEigenListEnd(e));
  e->leftmost = small->leftmost && rejected == 0 && e->n > 0 ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenSolveReduced(Mat A, const MpmReduced *reduced, const char prefix[], MpmEigenMethod method,
                                    const PetscReal target[2], MpmEigen **eigen)
{
  const PetscReal begin = MPI_Wtime();
  MpmEigen       *e;

  PetscFunctionBegin;
  PetscCall(PetscNew(eigen));
  e          = *eigen;
  e->A       = A;
  e->reduced = reduced;
  e->vector  = Vector;
  PetscCall(MatGetSize(A, &e->order, NULL));
  PetscCall(MpmEigenNorm(A, &e->norm));
  PetscCall(MpmEigenSolve(reduced->M, prefix, method, target, &e->small));
  PetscCall(PetscSNPrintf(e->solver, sizeof e->solver, "%s", e->small->solver));
  PetscCall(List(e, method == MPM_EIGEN_TARGET ? PETSC_TRUE : PETSC_FALSE));
  e->failed    = e->small->failed;
  e->converged = e->small->converged;
  e->complete  = e->n == e->order ? PETSC_TRUE : PETSC_FALSE;
  e->largest   = e->small->largest && e->n > 0 ? PETSC_TRUE : PETSC_FALSE;
  e->solve_s   = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}
