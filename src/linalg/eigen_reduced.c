/*
   Eigenvalues of A by its smaller matrix M. Vectors of M are lifted and their residuals are those of A, so a wrong pair
   is not listed. The numbers that A keeps are listed as often as the determinants say (see linalg/reduced.h); their
   residual is that of a random vector that Z does not see, and so that of almost all such vectors.
*/
#include "linalg/eigen.h"
#include <math.h>

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
   How often kept number k is listed, which near eigenvalues of M are but for rounding. Beside eigenvalues of largest
   abs it is one of them, if it is larger than the last.
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
