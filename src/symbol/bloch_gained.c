/* The growth of particles that move and only gain from nodes: a turn on the vectors that they gain. */
#include "linalg/small_qr.h"
#include "symbol/bloch_gained.h"
#include <mpmstab/verdict.h>

#define LARGEST 1e250 /* of the numbers that nodes give: sums of their products with weights are doubles, too */

/* Whether two parts have the same weights along the moving directions. */
static PetscBool SameKinds(const MpmBlochGained *g, PetscInt dim, const MpmOp *a, const MpmOp *b)
{
  for (PetscInt d = 0; d < dim; d++)
    if (g->moves[d] && MpmKindAlong(a->kind, a->axis, d) != MpmKindAlong(b->kind, b->axis, d)) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Finds the w of all numbers, with the number of each. Returns false where there are too many. */
static PetscBool FindProducts(MpmBlochGained *g, PetscInt dim, PetscInt number[])
{
  for (PetscInt y = 0; y < g->gains->numbers; y++) {
    const MpmTakenGift *gift = &g->gains->gift[g->gains->first[y]];

    for (PetscInt i = 0; i < gift->parts; i++) {
      PetscInt w = 0;

      while (w < g->n && (number[w] != y || !SameKinds(g, dim, &g->part[w], &gift->part[i]))) w++;
      if (w == MPM_MAX_STILL) return PETSC_FALSE;
      number[w]   = y;
      g->part[w]  = gift->part[i];
      g->of[y][i] = w;
      g->n        = PetscMax(g->n, w + 1);
    }
  }
  return PETSC_TRUE;
}

/* The places of particles along the moving directions. */
static void SetPlaces(const MpmBloch *b, MpmBlochGained *g)
{
  const PetscInt *ppc = b->layout->ppc;

  for (PetscInt j = b->ppc - 1; j >= 0; j--) {
    PetscInt rest = j, stride = 1;

    g->place[j] = 0;
    for (PetscInt a = 0; a < b->layout->dim; a++) {
      if (g->moves[a]) g->place[j] += stride * (rest % ppc[a]);
      if (g->moves[a]) stride *= ppc[a];
      rest /= ppc[a];
    }
    g->first[g->place[j]] = j;
  }
}

/* Chooses the vectors. order stays 0 where there are as many of them as rows of the registers. */
static PetscErrorCode Choose(const MpmBloch *b, const MpmFraction drift[], MpmBlochGained *g)
{
  const PetscInt orbits = g->cycles * b->turn * g->gains->numbers;
  PetscInt       number[MPM_MAX_STILL], order = orbits;

  PetscFunctionBegin;
  g->moving = 1;
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    g->rests[a] = drift[a].value == 0 ? PETSC_TRUE : PETSC_FALSE;
    g->moves[a] = g->rests[a] ? PETSC_FALSE : PETSC_TRUE;
    if (g->moves[a]) g->moving *= b->layout->ppc[a];
  }
  if (FindProducts(g, b->layout->dim, number)) order = PetscMin(orbits, g->n * g->moving);
  if (order >= b->size || order > MPM_SMALL_QR_MOST) PetscFunctionReturn(PETSC_SUCCESS);
  g->products = order < orbits ? PETSC_TRUE : PETSC_FALSE;
  g->order    = order;
  PetscCall(PetscMalloc4(b->ppc, &g->place, g->moving, &g->first, order, &g->number, order, &g->to));
  /* a row is filled up as the registers' are, which have b->size columns */
  PetscCall(PetscMalloc6(2 * b->turn * g->gains->numbers * (order + MPM_BLOCH_LANES), &g->given, b->turn * order,
                         &g->weight, order, &g->times, order * order, &g->matrix, order, &g->value, b->ppc,
                         &g->beyond));
  SetPlaces(b, g);
  for (PetscInt i = 0; i < order; i++) g->number[i] = g->products ? number[i / g->moving] : i % g->gains->numbers;
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
  if (g->gains) PetscCall(Choose(b, drift, g));
  if (g->order == 0) PetscCall(MpmBlochGainedDestroy(gained));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochGainedDestroy(MpmBlochGained **gained)
{
  MpmBlochGained *g = *gained;

  PetscFunctionBegin;
  if (!g) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(g->gains));
  if (g->order) PetscCall(PetscFree4(g->place, g->first, g->number, g->to));
  if (g->order) PetscCall(PetscFree6(g->given, g->weight, g->times, g->matrix, g->value, g->beyond));
  PetscCall(PetscFree(*gained));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What P makes of the vectors. */
static void SetPhase(MpmBlochGained *g, const MpmBloch *b, const PetscReal beta[])
{
  const PetscInt block = b->turn * g->gains->numbers;
  double complex mu    = 1;

  for (PetscInt j = 0; j < b->ppc; j++) g->beyond[j] = MpmBlochPhaseBeyond(b, beta, j);
  for (PetscInt l = 0, j = 0; l < g->cycles; l++, j = b->place[j]) mu *= g->beyond[j];
  for (PetscInt i = 0; i < g->order; i++) {
    const PetscInt m = i % g->moving;

    g->to[i]    = g->products ? i - m + g->place[b->place[g->first[m]]] : (i + block) % g->order;
    g->times[i] = g->products ? g->beyond[g->first[m]] : i + block < g->order ? 1 : mu;
  }
}

/* Adds to the registers at the start of a turn what number y of a step gives: its products, or it and its orbit. */
static void AddColumns(const MpmBlochGained *g, MpmBloch *b, PetscReal courant, PetscInt step, PetscInt y)
{
  const MpmTakenGift *gift = &g->gains->gift[g->gains->first[y]];

  for (PetscInt i = 0; i < gift->parts; i++)
    for (PetscInt j = 0; j < b->ppc; j++) {
      double complex given =
          MpmOpValue(&gift->part[i], courant) * MpmBlochTie(b, &gift->part[i], j, g->products ? g->rests : NULL);

      for (PetscInt l = 0, at = j; l < (g->products ? 1 : g->cycles); l++, at = b->place[at]) {
        PetscReal *row =
            MpmBlochRows(b, gift->part[i].dst) + 2 * at * b->width +
            (g->products ? g->place[j] + g->moving * g->of[y][i] : (l * b->turn + step) * g->gains->numbers + y);

        row[0] += creal(given);
        row[b->width] += cimag(given);
        given *= g->beyond[at];
      }
    }
}

static void Weigh(MpmBlochGained *g, const MpmBloch *b, PetscInt step)
{
  double complex *weight = g->weight + step * g->order;

  for (PetscInt i = 0; i < g->order; i++)
    if (g->products)
      weight[i] = MpmBlochTie(b, &g->part[i / g->moving], g->first[i % g->moving], g->moves);
    else
      weight[i] = i / g->gains->numbers == step;
}

/* The steps of a turn. Returns false where what nodes give might leave the range of doubles. */
static PetscBool March(MpmBlochGained *g, MpmBloch *b, const PetscReal beta[])
{
  const PetscInt each = g->gains->numbers * 2 * b->width;
  PetscBool      ok   = PETSC_TRUE;

  for (PetscInt i = 0; i < b->turn * each; i++) g->given[i] = 0;
  for (PetscInt step = 0; step < b->turn; step++) {
    MpmBlochRunStep(b, step, beta, g->gains, g->given + step * each);
    Weigh(g, b, step);
  }
  for (PetscInt i = 0; i < b->turn * each; i++)
    if (!(fabs(g->given[i]) < LARGEST)) ok = PETSC_FALSE;
  return ok;
}

/* What is there and what is given goes to the places that particles have taken. */
static void SetMatrix(MpmBlochGained *g, const MpmBloch *b)
{
  const PetscInt n = g->order;

  for (PetscInt i = 0; i < n; i++) {
    double complex *to = g->matrix + g->to[i];

    for (PetscInt c = 0; c < n; c++) to[n * c] = c == i ? 1 : 0;
    for (PetscInt step = 0; step < b->turn; step++) {
      const PetscReal     *row    = g->given + (step * g->gains->numbers + g->number[i]) * 2 * b->width;
      const double complex weight = g->weight[step * n + i];

      for (PetscInt c = 0; c < n && weight != 0; c++) to[n * c] += weight * CMPLX(row[c], row[b->width + c]);
    }
    for (PetscInt c = 0; c < n; c++) to[n * c] *= g->times[i];
  }
}

PetscErrorCode MpmBlochGainedGrowth(MpmBlochGained *g, MpmBloch *b, PetscReal courant, const PetscReal beta[],
                                    PetscReal *growth, PetscBool *ok)
{
  PetscReal largest = 1;

  PetscFunctionBegin;
  PetscCall(MpmBlochBegin(b, 1, &courant, beta, b->turn, g->order));
  SetPhase(g, b, beta);
  for (PetscInt step = 0; step < (g->products ? 1 : b->turn); step++) {
    MpmBlochSetStep(b, step);
    for (PetscInt y = 0; y < g->gains->numbers; y++) AddColumns(g, b, courant, step, y);
  }
  *ok = March(g, b, beta);
  if (!*ok) PetscFunctionReturn(PETSC_SUCCESS);
  SetMatrix(g, b);
  MpmSmallQr(g->order, g->matrix, g->value, ok);
  if (!*ok) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < g->order; i++) largest = PetscMax(largest, cabs(g->value[i]));
  *growth = MpmGrowthPerStep(largest, 0, b->turn);
  PetscFunctionReturn(PETSC_SUCCESS);
}
