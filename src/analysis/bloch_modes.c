/*
   Where the layout is uniform, eigenvectors of the operator are Bloch modes. They need no factorisation: the symbol
   says which are leading, and a product with the operator says whether they are eigenvectors of it.
*/
#include "analysis/bloch_modes.h"
#include "linalg/small_eigen.h"
#include "scene/layout.h"
#include "symbol/bloch.h"
#include <mpmstab/errors.h>
#include <math.h>

#define MODES (MPM_BLOCH_VECTORS / 2)
#define AWAY 0.05      /* distance from 1 */
#define EQUAL_ABS 1e-9 /* relative: abs that differ by less are taken for equal */

/* An amplification factor and the number of its phase; size is -1 where there is none. */
typedef struct {
  PetscReal re, im, size, distance, phase;
} Candidate;

static PetscBool IsBetter(const Candidate *a, const Candidate *b)
{
  const PetscBool away = a->distance > AWAY ? PETSC_TRUE : PETSC_FALSE;

  if (b->size < 0 || a->size < 0) return a->size > b->size ? PETSC_TRUE : PETSC_FALSE;
  if (away != (b->distance > AWAY ? PETSC_TRUE : PETSC_FALSE)) return away;
  if (away && fabs(a->size - b->size) > EQUAL_ABS * b->size) return a->size > b->size ? PETSC_TRUE : PETSC_FALSE;
  return a->distance > b->distance * (1 + EQUAL_ABS) ? PETSC_TRUE : PETSC_FALSE;
}

/* Inserts a candidate in a list that is sorted, best first. */
static void Insert(Candidate c, Candidate best[MODES])
{
  for (PetscInt i = 0; i < MODES; i++) {
    if (IsBetter(&c, &best[i])) {
      const Candidate kept = best[i];

      best[i] = c;
      c       = kept;
    }
  }
}

/* The best factor of a class. */
static Candidate BestOf(const MpmSymbol *s, PetscInt i)
{
  Candidate best = {.size = -1, .distance = -1};

  for (PetscInt j = 0; j < s->size; j++) {
    const PetscReal *factor = s->factors + 2 * (s->size * i + j);
    Candidate        c      = {.re    = scalbn(factor[0], (int)s->exponents[i]),
                               .im    = scalbn(factor[1], (int)s->exponents[i]),
                               .phase = (PetscReal)MpmSymbolPhaseOfClass(s, s->first + i)};

    c.size     = hypot(c.re, c.im);
    c.distance = hypot(c.re - 1, c.im);
    if (IsBetter(&c, &best)) best = c;
  }
  return best;
}

/* The leading factors of different classes, on every rank. */
static PetscErrorCode Leading(MPI_Comm comm, const MpmSymbol *s, Candidate best[MODES])
{
  const PetscMPIInt count = MODES * sizeof(Candidate) / sizeof(PetscReal);
  const PetscMPIInt ranks = MpmRanksOf(comm);
  Candidate        *all;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < MODES; i++) best[i] = (Candidate){.size = -1};
  for (PetscInt i = 0; i < s->count; i++) Insert(BestOf(s, i), best);
  PetscCall(PetscMalloc1(ranks * MODES, &all));
  PetscCallMPI(MPI_Allgather(best, count, MPIU_REAL, all, count, MPIU_REAL, comm));
  for (PetscInt i = 0; i < MODES; i++) best[i] = (Candidate){.size = -1};
  for (PetscInt i = 0; i < ranks * MODES; i++) Insert(all[i], best);
  PetscCall(PetscFree(all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Fills a state, real and imaginary part, with a Bloch mode. q: the numbers of the cell at the origin. */
static PetscErrorCode Fill(const MpmOperator *op, const PetscReal beta[], const double complex q[], Vec mode[2])
{
  const MpmLayout *layout = op->layout;
  PetscInt         begin, end;
  PetscReal       *x[2];

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(mode[0], &begin, &end));
  for (int part = 0; part < 2; part++) PetscCall(VecGetArrayWrite(mode[part], &x[part]));
  for (PetscInt64 id = begin / op->fields; id < end / op->fields; id++) {
    PetscInt64 site[MPM_MAX_DIM];
    PetscInt   j     = 0;
    PetscReal  angle = 0;

    MpmLayoutSites(layout, id, site);
    for (PetscInt a = layout->dim - 1; a >= 0; a--) {
      j = j * layout->ppc[a] + (PetscInt)(site[a] % layout->ppc[a]);
      angle += beta[a] * (PetscReal)(site[a] / layout->ppc[a]);
    }
    for (PetscInt f = 0; f < op->fields; f++) {
      const double complex value = cexp(I * angle) * q[op->fields * j + f];

      x[0][op->fields * id + f - begin] = creal(value);
      x[1][op->fields * id + f - begin] = cimag(value);
    }
  }
  for (int part = 0; part < 2; part++) PetscCall(VecRestoreArrayWrite(mode[part], &x[part]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The eigenvector of a phase's matrix for a candidate; the same on every rank. */
static PetscErrorCode Vector(MPI_Comm comm, MpmBloch *bloch, const MpmSymbol *s, const Candidate *c,
                             const PetscReal beta[], MpmSmallEigen *small, PetscInt *nearest)
{
  PetscMPIInt count;
  PetscInt    exponent;

  PetscFunctionBegin;
  PetscCall(MpmBlochMatrices(bloch, 1, &s->step.courant, beta, PETSC_FALSE, small->matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(small, PETSC_TRUE));
  PetscCall(PetscMPIIntCast(2 * (PetscInt64)s->size * s->size, &count));
  PetscCallMPI(MPI_Bcast(small->right, count, MPI_DOUBLE, 0, comm));
  PetscCallMPI(MPI_Bcast(small->value, (PetscMPIInt)(2 * s->size), MPI_DOUBLE, 0, comm));
  *nearest = 0;
  for (PetscInt j = 1; j < s->size; j++) {
    const double complex sought = (c->re + I * c->im) * scalbn(1, -(int)exponent);

    if (cabs(small->value[j] - sought) < cabs(small->value[*nearest] - sought)) *nearest = j;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochModesCreate(const MpmOperator *op, const MpmSymbol *s, PetscInt *n, Vec **vectors)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)op->A);
  Candidate      best[MODES];
  MpmBloch       bloch;
  MpmSmallEigen  small;
  Vec            x;

  PetscFunctionBegin;
  PetscCall(Leading(comm, s, best));
  *n = 0;
  while (*n < 2 * MODES && best[*n / 2].size >= 0) *n += 2;
  PetscCall(MatCreateVecs(op->A, &x, NULL));
  PetscCall(VecDuplicateVecs(x, MPM_BLOCH_VECTORS, vectors));
  PetscCall(VecDestroy(&x));
  PetscCall(MpmBlochCreate(op->layout, op->scheme, s->step.drift, &bloch));
  PetscCall(MpmSmallEigenCreate(s->size, &small));
  for (PetscInt m = 0; m < *n / 2; m++) {
    PetscReal beta[MPM_MAX_DIM];
    PetscInt  j = 0;

    MpmSymbolBeta(s, (PetscInt)best[m].phase, beta);
    PetscCall(Vector(comm, &bloch, s, &best[m], beta, &small, &j));
    PetscCall(Fill(op, beta, small.right + j * s->size, *vectors + 2 * m));
  }
  PetscCall(MpmSmallEigenDestroy(&small));
  PetscCall(MpmBlochDestroy(&bloch));
  PetscFunctionReturn(PETSC_SUCCESS);
}
