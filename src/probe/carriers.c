/* Which particles carry an eigenvector. */
#include "probe/carriers.h"
#include <stdlib.h>

#define NEARLY_ALL 0.9

typedef struct {
  PetscReal  share;
  PetscInt64 particle;
} Share;

static int ByShare(const void *one, const void *other)
{
  const Share *p = one, *q = other;

  if (p->share != q->share) return p->share > q->share ? -1 : 1;
  return p->particle < q->particle ? -1 : p->particle > q->particle;
}

/* Adds the squares of a vector's numbers to the shares of their particles, of which each has n numbers. */
static PetscErrorCode AddSquares(Vec x, PetscInt n, PetscReal squares[])
{
  const PetscScalar *value;
  PetscInt           first, last;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(x, &first, &last));
  PetscCall(VecGetArrayRead(x, &value));
  for (PetscInt i = first; i < last; i++) squares[i / n] += PetscSqr(value[i - first]);
  PetscCall(VecRestoreArrayRead(x, &value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCarriersFind(const MpmProgram *p, const MpmSpectrum *s, MpmCarriers *c)
{
  const PetscInt64 particles = p->stepper->particles;
  PetscReal       *squares, all = 0, sum = 0;
  Share           *shares;
  Vec              x[2];

  PetscFunctionBegin;
  *c = (MpmCarriers){.n = 0, .all = particles, .dim = p->stepper->place == MPM_NONE ? 0 : p->stepper->dim};
  if (!s->eigen->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc1(particles, &squares));
  PetscCall(PetscMalloc1(particles, &shares));
  for (int part = 0; part < 2; part++) PetscCall(MatCreateVecs(s->op->A, &x[part], NULL));
  PetscCall(MpmEigenVector(s->eigen, 0, x[0], x[1]));
  for (int part = 0; part < 2; part++) {
    if (s->op->unit) PetscCall(VecPointwiseDivide(x[part], x[part], s->op->unit));
    PetscCall(AddSquares(x[part], p->unread.n, squares));
    PetscCall(VecDestroy(&x[part]));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, squares, (PetscMPIInt)particles, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD));
  for (PetscInt64 i = 0; i < particles; i++) {
    shares[i] = (Share){.share = squares[i], .particle = i};
    all += squares[i];
  }
  qsort(shares, (size_t)particles, sizeof *shares, ByShare);
  c->n = (PetscInt)PetscMin(MPM_CARRIERS, particles);
  for (PetscInt i = 0; i < c->n; i++) {
    c->particle[i] = shares[i].particle;
    c->share[i]    = shares[i].share / all;
    if (c->dim) PetscCall(PetscArraycpy(c->place[i], MpmStepperPlace(p->stepper, c->particle[i]), c->dim));
  }
  while (c->most < particles && sum < NEARLY_ALL * all) sum += shares[c->most++].share;
  PetscCall(PetscFree(squares));
  PetscCall(PetscFree(shares));
  PetscFunctionReturn(PETSC_SUCCESS);
}
