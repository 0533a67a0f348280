/* The growth of particles that move and only gain from nodes: a turn on the numbers that nodes give. */
#include "linalg/small_qr.h"
#include "symbol/bloch_gained.h"
#include "symbol/bloch.h"
#include <mpmstab/verdict.h>

#define LARGEST 1e250 /* of the numbers that nodes give: sums of their products with weights are doubles, too */

/* The smaller of the two matrices; order stays 0 where both have as many rows as the registers. */
static PetscErrorCode ChooseOrder(const MpmBloch *b, const MpmFraction drift[], MpmBlochGained *g)
{
  const PetscInt all = g->cycles * b->turn * g->gains->numbers;
  PetscInt       few;

  PetscFunctionBegin;
  PetscCall(MpmBlochStillCreate(b, drift, g->gains, &g->still));
  few = g->still ? g->still->n * g->still->moving : all;
  if (few >= all) PetscCall(MpmBlochStillDestroy(&g->still));
  if (PetscMin(few, all) < b->size && PetscMin(few, all) <= MPM_SMALL_QR_MOST) g->order = PetscMin(few, all);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochGainedCreate(const MpmBloch *b, const MpmFraction drift[], MpmBlochGained **gained)
{
  MpmBlochGained *g;

  PetscFunctionBegin;
  PetscCall(PetscNew(gained));
  g         = *gained;
  g->cycles = 1;
  for (PetscInt j = b->place[0]; j != 0; j = b->place[j]) g->cycles++;
  PetscCall(MpmTakenFind(b->scheme->table, PETSC_TRUE, &g->gains));
  if (g->gains) PetscCall(ChooseOrder(b, drift, g));
  if (g->order == 0) {
    PetscCall(MpmBlochGainedDestroy(gained));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /* a row is filled up as the registers' are, which have b->size columns */
  PetscCall(PetscMalloc4(2 * b->turn * g->gains->numbers * (g->order + MPM_BLOCH_LANES), &g->given, g->order * g->order,
                         &g->matrix, g->order, &g->value, b->ppc, &g->beyond));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochGainedDestroy(MpmBlochGained **gained)
{
  PetscFunctionBegin;
  if (!*gained) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmBlochStillDestroy(&(*gained)->still));
  PetscCall(PetscFree((*gained)->gains));
  if ((*gained)->order) PetscCall(PetscFree4((*gained)->given, (*gained)->matrix, (*gained)->value, (*gained)->beyond));
  PetscCall(PetscFree(*gained));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets column l x steps x numbers + number of the registers to P^l U, of one number of a step. */
static void SetColumns(const MpmBlochGained *g, MpmBloch *b, PetscReal courant, PetscInt number,
                       const MpmTakenGift *gift)
{
  for (PetscInt i = 0; i < gift->parts; i++) {
    const MpmOp    *part   = &gift->part[i];
    const PetscReal factor = MpmOpValue(part, courant);

    for (PetscInt j = 0; j < b->ppc; j++) {
      double complex given = factor * MpmBlochTie(b, part, j, NULL);
      PetscInt       at    = j;

      for (PetscInt l = 0; l < g->cycles; l++) {
        PetscReal *row = MpmBlochRows(b, part->dst) + 2 * at * b->width + l * b->turn * g->gains->numbers + number;

        row[0] += creal(given);
        row[b->width] += cimag(given);
        given *= g->beyond[at];
        at = b->place[at];
      }
    }
  }
}

/* The registers at the start of a turn. */
static void Begin(MpmBlochGained *g, MpmBloch *b, PetscReal courant)
{
  const MpmTaken *gains = g->gains;

  if (g->still) MpmBlochStillBegin(g->still, b, gains, courant);
  for (PetscInt step = 0; step < b->turn && !g->still; step++) {
    MpmBlochSetStep(b, step);
    for (PetscInt y = 0; y < gains->numbers; y++)
      SetColumns(g, b, courant, step * gains->numbers + y, &gains->gift[gains->first[y]]);
  }
}

/* The steps of a turn. Returns false where what nodes give might leave the range of doubles. */
static PetscBool March(MpmBlochGained *g, MpmBloch *b, const PetscReal beta[])
{
  const PetscInt each = g->gains->numbers * 2 * b->width;
  PetscBool      ok   = PETSC_TRUE;

  for (PetscInt i = 0; i < b->turn * each; i++) g->given[i] = 0;
  for (PetscInt step = 0; step < b->turn; step++) {
    MpmBlochSetStep(b, step);
    if (g->still) MpmBlochStillWeigh(g->still, b, step);
    for (PetscInt o = 0; o < b->scheme->table->nops; o++) {
      MpmBlochNote(b, g->gains, o, g->given + step * each);
      MpmBlochApply(b, o, beta);
    }
  }
  for (PetscInt i = 0; i < b->turn * each; i++)
    if (!(fabs(g->given[i]) < LARGEST)) ok = PETSC_FALSE;
  return ok;
}

/* C: what is there goes to the next power of P, and what is given to the first. */
static void SetMatrix(MpmBlochGained *g, const MpmBloch *b)
{
  const PetscInt n = g->order, block = b->turn * g->gains->numbers;
  double complex mu = 1, times;
  PetscInt       j  = 0;

  for (PetscInt l = 0; l < g->cycles; l++) {
    mu *= g->beyond[j];
    j = b->place[j];
  }
  times = g->cycles == 1 ? mu : 1;
  for (PetscInt i = 0; i < n * n; i++) g->matrix[i] = 0;
  for (PetscInt c = 0; c < n; c++) {
    double complex *column = g->matrix + n * c;

    column[(c + block) % n] = c + block < n ? 1 : mu;
    for (PetscInt y = 0; y < block; y++)
      column[(y + block) % n] += times * CMPLX(g->given[2 * y * b->width + c], g->given[(2 * y + 1) * b->width + c]);
  }
}

PetscErrorCode MpmBlochGainedGrowth(MpmBlochGained *g, MpmBloch *b, PetscReal courant, const PetscReal beta[],
                                    PetscReal *growth, PetscBool *ok)
{
  PetscReal largest = 1;

  PetscFunctionBegin;
  PetscCall(MpmBlochBegin(b, 1, &courant, beta, b->turn, g->order));
  for (PetscInt j = 0; j < b->ppc; j++) g->beyond[j] = MpmBlochPhaseBeyond(b, beta, j);
  Begin(g, b, courant);
  *ok = March(g, b, beta);
  if (!*ok) PetscFunctionReturn(PETSC_SUCCESS);
  if (g->still)
    MpmBlochStillMatrix(g->still, b, g->gains, g->given, g->beyond, g->matrix);
  else
    SetMatrix(g, b);
  MpmSmallQr(g->order, g->matrix, g->value, ok);
  if (!*ok) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < g->order; i++) largest = PetscMax(largest, cabs(g->value[i]));
  *growth = MpmGrowthPerStep(largest, 0, b->turn);
  PetscFunctionReturn(PETSC_SUCCESS);
}
