/* The growth of particles that move along some directions only: the vectors that they gain, and the matrix of a turn. */
#include "symbol/bloch.h"
#include "symbol/bloch_still.h"

/* Whether two parts have the same weights along the moving directions. */
static PetscBool SameKinds(const MpmBlochStill *s, PetscInt dim, const MpmOp *a, const MpmOp *b)
{
  for (PetscInt d = 0; d < dim; d++)
    if (s->moves[d] && MpmKindAlong(a->kind, a->axis, d) != MpmKindAlong(b->kind, b->axis, d)) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Sorts the parts of all numbers. Returns false where there are too many w. */
static PetscBool Sort(MpmBlochStill *s, PetscInt dim, const MpmTaken *gains)
{
  for (PetscInt y = 0; y < gains->numbers; y++) {
    const MpmTakenGift *gift = &gains->gift[gains->first[y]];

    for (PetscInt i = 0; i < gift->parts; i++) {
      PetscInt w = 0;

      while (w < s->n && (s->number[w] != y || !SameKinds(s, dim, &s->part[w], &gift->part[i]))) w++;
      if (w == MPM_MAX_STILL) return PETSC_FALSE;
      s->number[w] = y;
      s->part[w]   = gift->part[i];
      s->of[y][i]  = w;
      s->n         = PetscMax(s->n, w + 1);
    }
  }
  return PETSC_TRUE;
}

/* The places of particles along the moving directions. */
static void SetPlaces(const MpmBloch *b, MpmBlochStill *s)
{
  const PetscInt *ppc = b->layout->ppc;

  for (PetscInt j = b->ppc - 1; j >= 0; j--) {
    PetscInt rest = j, stride = 1;

    s->place[j] = 0;
    for (PetscInt a = 0; a < b->layout->dim; a++) {
      if (s->moves[a]) s->place[j] += stride * (rest % ppc[a]);
      if (s->moves[a]) stride *= ppc[a];
      rest /= ppc[a];
    }
    s->first[s->place[j]] = j;
  }
}

PetscErrorCode MpmBlochStillCreate(const MpmBloch *b, const MpmFraction drift[], const MpmTaken *gains,
                                   MpmBlochStill **still)
{
  MpmBlochStill *s;

  PetscFunctionBegin;
  PetscCall(PetscNew(still));
  s         = *still;
  s->moving = 1;
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    s->rests[a] = drift[a].value == 0 ? PETSC_TRUE : PETSC_FALSE;
    s->moves[a] = s->rests[a] ? PETSC_FALSE : PETSC_TRUE;
    if (s->moves[a]) s->moving *= b->layout->ppc[a];
  }
  if (!Sort(s, b->layout->dim, gains)) {
    PetscCall(PetscFree(*still));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscMalloc3(b->ppc, &s->place, s->moving, &s->first, b->turn * s->n * s->moving, &s->weight));
  SetPlaces(b, s);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochStillDestroy(MpmBlochStill **still)
{
  PetscFunctionBegin;
  if (!*still) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree3((*still)->place, (*still)->first, (*still)->weight));
  PetscCall(PetscFree(*still));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmBlochStillBegin(const MpmBlochStill *s, MpmBloch *b, const MpmTaken *gains, PetscReal courant)
{
  MpmBlochSetStep(b, 0);
  for (PetscInt y = 0; y < gains->numbers; y++) {
    const MpmTakenGift *gift = &gains->gift[gains->first[y]];

    for (PetscInt i = 0; i < gift->parts; i++) {
      const MpmOp    *part   = &gift->part[i];
      const PetscReal factor = MpmOpValue(part, courant);

      for (PetscInt j = 0; j < b->ppc; j++) {
        const double complex given = factor * MpmBlochTie(b, part, j, s->rests);
        PetscReal *row = MpmBlochRows(b, part->dst) + 2 * j * b->width + s->place[j] + s->moving * s->of[y][i];

        row[0] += creal(given);
        row[b->width] += cimag(given);
      }
    }
  }
}

void MpmBlochStillWeigh(MpmBlochStill *s, const MpmBloch *b, PetscInt step)
{
  for (PetscInt w = 0; w < s->n; w++)
    for (PetscInt m = 0; m < s->moving; m++)
      s->weight[(step * s->n + w) * s->moving + m] = MpmBlochTie(b, &s->part[w], s->first[m], s->moves);
}

/* What is there and what is given goes to the places that particles have taken. */
void MpmBlochStillMatrix(const MpmBlochStill *s, const MpmBloch *b, const MpmTaken *gains, const PetscReal given[],
                         const double complex beyond[], double complex matrix[])
{
  const PetscInt order = s->n * s->moving;

  for (PetscInt i = 0; i < order; i++) {
    const PetscInt j = s->first[i % s->moving], to = i - i % s->moving + s->place[b->place[j]];

    for (PetscInt c = 0; c < order; c++) {
      double complex sum = c == i ? 1 : 0;

      for (PetscInt step = 0; step < b->turn; step++) {
        const PetscReal *row = given + (step * gains->numbers + s->number[i / s->moving]) * 2 * b->width;

        sum += s->weight[step * order + i] * CMPLX(row[c], row[b->width + c]);
      }
      matrix[order * c + to] = beyond[j] * sum;
    }
  }
}
