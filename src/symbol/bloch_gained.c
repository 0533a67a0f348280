/* The growth of particles that move and only gain from nodes: a turn on the numbers that nodes give. */
#include "linalg/complex_inline.h"
#include "linalg/small_qr.h"
#include "symbol/bloch_gained.h"
#include "symbol/bloch_steps.h"
#include <mpmstab/verdict.h>

#define LONGEST 8    /* steps of a turn, */
#define MODERATE 256 /* and Courant number up to which these steps multiply by less than 2^800 */

/* Adds what an operation gives to the gift of its node register. Returns false where there is no room. */
static PetscBool Give(MpmBlochGained *g, const MpmOp *op, PetscInt at, PetscInt version)
{
  MpmTakenGift *gift;
  PetscInt      y = 0;

  while (y < g->numbers && (g->gift[y].src != op->src || g->gift[y].version != version)) y++;
  if (y == MPM_MAX_TAKEN) return PETSC_FALSE;
  gift = &g->gift[y];
  if (y == g->numbers) {
    *gift = (MpmTakenGift){.at = at, .src = op->src, .version = version, .number = y};
    g->numbers++;
  }
  if (gift->parts == MPM_MAX_FIELDS) return PETSC_FALSE;
  gift->part[gift->parts++] = (MpmTakenPart){
      .dst = op->dst, .kind = op->kind, .axis = op->axis, .power = op->coefficient, .factor = op->factor};
  return PETSC_TRUE;
}

/* Whether the particles of a table only gain. Finds what they are given. */
static PetscBool OnlyGain(const MpmTable *table, MpmBlochGained *g)
{
  PetscInt version[MPM_MAX_FIELDS] = {0};

  for (PetscInt o = 0; o < table->nops; o++) {
    const MpmOp      *op     = &table->ops[o];
    const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

    if (traits.dst == MPM_ON_NODES) version[op->dst]++;
    if (traits.dst != MPM_ON_PARTICLES) continue;
    if (traits.src != MPM_ON_NODES || op->dst >= table->nstate) return PETSC_FALSE;
    if (!Give(g, op, o, version[op->src])) return PETSC_FALSE;
  }
  return g->numbers > 0 ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmBlochGainedCreate(const MpmBloch *b, MpmBlochGained **gained)
{
  MpmBlochGained *g;

  PetscFunctionBegin;
  PetscCall(PetscNew(gained));
  g         = *gained;
  g->cycles = 1;
  for (PetscInt j = b->place[0]; j != 0; j = b->place[j]) g->cycles++;
  if (OnlyGain(b->scheme->table, g) && b->turn <= LONGEST) g->order = g->cycles * b->turn * g->numbers;
  if (g->order == 0 || g->order >= b->size || g->order > MPM_SMALL_QR_MOST) {
    PetscCall(PetscFree(*gained));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  /* a row is filled up as the registers' are, which have b->size columns */
  PetscCall(PetscMalloc4(2 * g->order * (b->size + MPM_BLOCH_LANES), &g->given, g->order * g->order, &g->matrix,
                         g->order, &g->value, b->ppc, &g->beyond));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochGainedDestroy(MpmBlochGained **gained)
{
  PetscFunctionBegin;
  if (!*gained) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree4((*gained)->given, (*gained)->matrix, (*gained)->value, (*gained)->beyond));
  PetscCall(PetscFree(*gained));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets column l x steps x numbers + number of the registers to P^l U, of one number of a step. */
static void SetColumns(const MpmBlochGained *g, MpmBloch *b, PetscReal courant, PetscInt number,
                       const MpmTakenGift *gift)
{
  for (PetscInt i = 0; i < gift->parts; i++) {
    const MpmTakenPart *part   = &gift->part[i];
    const PetscReal     factor = part->factor * PetscPowRealInt(courant, part->power);

    for (PetscInt j = 0; j < b->ppc; j++) {
      double complex given = MpmScaled(factor, MpmBlochTie(b, part->kind, part->axis, j));
      PetscInt       at    = j;

      for (PetscInt l = 0; l < g->cycles; l++) {
        PetscReal *row = MpmBlochRows(b, part->dst) + 2 * at * b->width + l * b->turn * g->numbers + number;

        row[0] += creal(given);
        row[b->width] += cimag(given);
        given = MpmTimes(g->beyond[at], given);
        at    = b->place[at];
      }
    }
  }
}

/* The steps of a turn. The numbers that nodes give are kept as they are when the first operation reads them. */
static void March(MpmBlochGained *g, MpmBloch *b, const PetscReal beta[])
{
  for (PetscInt step = 0; step < b->turn; step++) {
    MpmBlochSetStep(b, step);
    for (PetscInt o = 0; o < b->scheme->table->nops; o++) {
      for (PetscInt y = 0; y < g->numbers; y++) {
        const PetscReal *row  = MpmBlochRow(b, g->gift[y].src);
        PetscReal       *kept = g->given + (step * g->numbers + y) * 2 * b->width;

        for (PetscInt i = 0; i < 2 * b->width && g->gift[y].at == o; i++) kept[i] = row[i];
      }
      MpmBlochApply(b, o, beta);
    }
  }
}

/* C: what is there goes to the next power of P, and what is given to the first. */
static void SetMatrix(MpmBlochGained *g, const MpmBloch *b)
{
  const PetscInt n = g->order, block = b->turn * g->numbers;
  double complex mu = 1, times;
  PetscInt       j  = 0;

  for (PetscInt l = 0; l < g->cycles; l++) {
    mu = MpmTimes(g->beyond[j], mu);
    j  = b->place[j];
  }
  times = g->cycles == 1 ? mu : 1;
  for (PetscInt i = 0; i < n * n; i++) g->matrix[i] = 0;
  for (PetscInt c = 0; c < n; c++) {
    double complex *column = g->matrix + n * c;

    column[(c + block) % n] = c + block < n ? 1 : mu;
    for (PetscInt y = 0; y < block; y++)
      column[(y + block) % n] +=
          MpmTimes(times, CMPLX(g->given[2 * y * b->width + c], g->given[(2 * y + 1) * b->width + c]));
  }
}

PetscErrorCode MpmBlochGainedGrowth(MpmBlochGained *g, MpmBloch *b, PetscReal courant, const PetscReal beta[],
                                    PetscReal *growth, PetscBool *ok)
{
  PetscReal largest = 1;

  PetscFunctionBegin;
  *ok = PETSC_FALSE;
  if (!(courant <= MODERATE)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmBlochBegin(b, 1, &courant, beta, b->turn, g->order));
  for (PetscInt j = 0; j < b->ppc; j++) g->beyond[j] = MpmBlochPhaseBeyond(b, beta, j);
  for (PetscInt step = 0; step < b->turn; step++) {
    MpmBlochSetStep(b, step);
    for (PetscInt y = 0; y < g->numbers; y++) SetColumns(g, b, courant, step * g->numbers + y, &g->gift[y]);
  }
  March(g, b, beta);
  SetMatrix(g, b);
  MpmSmallQr(g->order, g->matrix, g->value, ok);
  if (!*ok) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < g->order; i++) largest = PetscMax(largest, cabs(g->value[i]));
  *growth = MpmGrowthPerStep(largest, 0, b->turn);
  PetscFunctionReturn(PETSC_SUCCESS);
}
