/*
   Eigenvalues of A by its smaller matrix M. Vectors of M are lifted and their residuals are those of A, so a wrong pair
   is not listed. The numbers that A keeps are listed as often as the determinants say (see linalg/reduced.h); their
   residual is that of a random vector that Z does not see, and so that of almost all such vectors.
*/
#include "linalg/eigen_reduced.h"
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

typedef struct {
  Vec      x[2], work;
  PetscInt near[MPM_REDUCED_KEPT],
      rejected; /* eigenvalues of M that are a kept number but for rounding, and that are none */
} Listing;

/* Tries a pair. Of a complex pair the residual of the second is that of the first. */
static PetscErrorCode Try(MpmEigen *e, Listing *l, PetscInt place, PetscReal re, PetscReal im, PetscBool *listed)
{
  const PetscInt last = e->n - 1;
  PetscReal      residual;

  PetscFunctionBegin;
  e->place[e->n] = place;
  if (im < 0 && last >= 0 && e->re[last] == re && e->im[last] == -im)
    residual = e->residual[last];
  else {
    PetscCall(MpmEigenVector(e, e->n, l->x[0], l->x[1]));
    PetscCall(MpmEigenResidual(e, re, im, l->x, l->work, &residual));
  }
  *listed = residual <= MPM_EIGEN_ACCEPTED ? PETSC_TRUE : PETSC_FALSE;
  if (!*listed) PetscFunctionReturn(PETSC_SUCCESS);
  e->re[e->n]         = re;
  e->im[e->n]         = im;
  e->residual[e->n++] = residual;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How often kept number k is listed. Beside eigenvalues of largest abs it is one of them, if it is larger than the last. */
static PetscInt TimesKept(const MpmEigen *e, const Listing *l, PetscInt k, PetscReal least)
{
  const MpmReduced *r    = e->reduced;
  const PetscInt    left = r->count[k] - r->count_small[k];

  if (e->small->complete) return l->near[k] + left;
  if (e->small->leftmost) return PetscMin(1, left);
  return e->small->largest && fabs(r->number[k]) >= least ? PetscMin(PetscMax(1, l->near[k]), left) : 0;
}

static PetscErrorCode ListKept(MpmEigen *e, Listing *l)
{
  PetscReal least = PETSC_MAX_REAL;
  PetscBool listed;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < e->small->n; j++) least = PetscMin(least, hypot(e->small->re[j], e->small->im[j]));
  for (PetscInt k = 0; k < e->reduced->nkept; k++) {
    const PetscInt times = TimesKept(e, l, k, least);

    if (times <= 0) continue;
    PetscCall(Try(e, l, PlaceOfKept(e->reduced, k, 0), e->reduced->number[k], 0, &listed));
    for (PetscInt i = 1; listed && i < times; i++, e->n++) {
      e->re[e->n]       = e->reduced->number[k];
      e->im[e->n]       = 0;
      e->residual[e->n] = e->residual[e->n - 1];
      e->place[e->n]    = PlaceOfKept(e->reduced, k, i);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode List(MpmEigen *e, PetscBool near_target)
{
  const MpmEigen *small = e->small;
  const PetscInt  room  = e->order + small->n + MPM_REDUCED_KEPT;
  Listing         l     = {.near = {0}};
  PetscBool       listed;

  PetscFunctionBegin;
  PetscCall(PetscMalloc4(room, &e->re, room, &e->im, room, &e->residual, room, &e->place));
  PetscCall(MatCreateVecs(e->A, &l.x[0], &l.x[1]));
  PetscCall(VecDuplicate(l.x[0], &l.work));
  for (PetscInt j = 0; j < small->n; j++) {
    const PetscInt k = near_target ? -1 : MpmReducedKept(e->reduced, small->norm, small->re[j], small->im[j]);

    if (k >= 0)
      l.near[k]++;
    else {
      PetscCall(Try(e, &l, j, small->re[j], small->im[j], &listed));
      l.rejected += listed ? 0 : 1;
    }
  }
  PetscCall(ListKept(e, &l));
  PetscCall(VecDestroy(&l.x[0]));
  PetscCall(VecDestroy(&l.x[1]));
  PetscCall(VecDestroy(&l.work));
  PetscCall(MpmEigenSort(e));
  e->leftmost = small->leftmost && l.rejected == 0 && e->n > 0 ? PETSC_TRUE : PETSC_FALSE;
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
