/* What a Bloch mode is made with: its registers, the weights of its maps, and where particles stand after a turn. */
#include "symbol/bloch_growth.h"
#include <math.h>

#define LANES_UP_TO 64 /* columns of a Courant number; wider rows fill the blocks well enough */

/* ---- registers that take their values from nodes, from what the plan of the nodal operator says of a step ---- */

static PetscBool SamePlace(const MpmOp *a, const MpmOp *b)
{
  return a->dst == b->dst && a->kind == b->kind && a->axis == b->axis && a->coefficient == b->coefficient ? PETSC_TRUE
                                                                                                          : PETSC_FALSE;
}

/* Adds a part to the gift of its slot. Returns whether there was room for it. */
static PetscBool Give(MpmTaken *of, const MpmNodalSent *sent)
{
  MpmTakenGift *gift = of->gift;

  while (gift < of->gift + of->ngifts && gift->slot != sent->slot) gift++;
  if (gift == of->gift + MPM_MAX_TAKEN) return PETSC_FALSE;
  if (gift == of->gift + of->ngifts)
    of->gift[of->ngifts++] = (MpmTakenGift){.at = sent->at, .src = sent->op.src, .slot = sent->slot};
  for (PetscInt i = 0; i < gift->parts; i++)
    if (SamePlace(&gift->part[i], &sent->op)) {
      gift->part[i].factor += sent->op.factor;
      return PETSC_TRUE;
    }
  if (gift->parts == MPM_MAX_FIELDS) return PETSC_FALSE;
  gift->part[gift->parts++] = sent->op;
  return PETSC_TRUE;
}

/* The number that a gift is a multiple of another one by, or 0 where it is none. */
static PetscReal Multiple(const MpmTakenGift *gift, const MpmTakenGift *of)
{
  PetscReal ratio = 0;

  if (gift->parts != of->parts) return 0;
  for (PetscInt i = 0; i < of->parts; i++) {
    PetscInt j = 0;

    while (j < gift->parts && !SamePlace(&gift->part[j], &of->part[i])) j++;
    if (j == gift->parts || of->part[i].factor == 0) return 0;
    if (i > 0 && gift->part[j].factor != ratio * of->part[i].factor) return 0;
    ratio = gift->part[j].factor / of->part[i].factor;
  }
  return ratio;
}

/* Gifts that give the same, but for a number, are parts of one unknown. */
static void Number(MpmTaken *of)
{
  for (PetscInt g = 0; g < of->ngifts; g++) {
    MpmTakenGift *gift = &of->gift[g];

    gift->times = 0;
    for (gift->number = 0; gift->number < of->numbers; gift->number++) {
      gift->times = Multiple(gift, &of->gift[of->first[gift->number]]);
      if (gift->times != 0) break;
    }
    if (gift->number < of->numbers) continue;
    gift->times              = 1;
    of->first[of->numbers++] = g;
  }
}

PetscErrorCode MpmTakenFind(const MpmTable *table, PetscBool gains, MpmTaken **taken)
{
  PetscBool     room = PETSC_TRUE;
  const char   *why;
  MpmNodalPlan *plan;
  MpmTaken     *t;

  PetscFunctionBegin;
  *taken = NULL;
  PetscCall(MpmNodalPlanCreate(table, &why, &plan));
  if (!plan) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscNew(taken));
  t = *taken;
  for (PetscInt r = 0; r < table->nstate; r++) {
    t->taken[r] = plan->kept[r] == 0 && !gains ? PETSC_TRUE : PETSC_FALSE;
    t->left += t->taken[r] ? 0 : 1;
    if (gains && plan->kept[r] != 1) room = PETSC_FALSE;
  }
  for (PetscInt o = 0; o < table->nops; o++)
    for (PetscInt i = 0; i < plan->nsent && room; i++)
      if (plan->sent[i].at == o && (gains || t->taken[plan->sent[i].op.dst])) room = Give(t, &plan->sent[i]);
  Number(t);
  if (!room || t->ngifts == 0) PetscCall(PetscFree(*taken));
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the mode ---- */

/*
   Finds the kinds whose weights the maps of a scheme have along some direction. Every table has a P2G, whose weights
   give the masses. SOLVE needs G2P too.
*/
static void FindUsed(const MpmTable *t, PetscBool used[])
{
  for (PetscInt o = 0; o < t->nops; o++) {
    const MpmOp      *op     = &t->ops[o];
    const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

    if (op->kind == MPM_SOLVE) used[MPM_G2P] = PETSC_TRUE;
    if (traits.src == traits.dst) continue;
    for (PetscInt a = 0; a < t->dim; a++) used[MpmKindAlong(op->kind, op->axis, a)] = PETSC_TRUE;
  }
}

static PetscInt FloorOver(PetscInt a, PetscInt b)
{
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

/*
   A turn is over when every particle has the place that some particle of a cell had at the start: after a whole number
   of the distances between them, 1 / ppc.
*/
static PetscErrorCode FindTurn(const MpmFraction drift[], MpmBloch *b)
{
  const PetscInt *ppc = b->layout->ppc;

  PetscFunctionBegin;
  b->turn = 1;
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    const PetscInt steps =
        drift[a].value == 0 ? 1 : (PetscInt)drift[a].den / (PetscInt)MpmCommonDivisor(drift[a].den, ppc[a]);

    b->turn *= steps / (PetscInt)MpmCommonDivisor(b->turn, steps);
  }
  PetscCall(PetscMalloc2(b->ppc, &b->place, b->ppc, &b->beyond));
  for (PetscInt j = 0; j < b->ppc; j++) {
    PetscInt stride = 1, rest = j;

    b->place[j] = 0;
    for (PetscInt a = 0; a < b->layout->dim; a++) {
      const PetscInt moved = drift[a].value == 0 ? 0 : (PetscInt)(drift[a].num * b->turn * ppc[a] / drift[a].den),
                     to    = rest % ppc[a] + moved;

      b->beyond[j][a] = FloorOver(to, ppc[a]);
      b->place[j] += stride * (to - ppc[a] * b->beyond[j][a]);
      stride *= ppc[a];
      rest /= ppc[a];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Particles that move take the smaller matrix of a turn where there is one. */
static PetscErrorCode FindTaken(MpmBloch *b)
{
  PetscFunctionBegin;
  b->turn_size = b->size;
  if (b->period == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmTakenFind(b->scheme->table, PETSC_FALSE, &b->taken));
  if (b->taken) b->turn_size = b->taken->numbers + b->taken->left * b->ppc;
  if (b->taken && b->turn_size < b->size) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(b->taken));
  b->turn_size = b->size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmFraction drift[], MpmBloch *b)
{
  const MpmTable    *table     = scheme->table;
  const MpmRegisters registers = {.comm = PETSC_COMM_SELF, .n = {table->nparticles, table->nnodes}};
  MpmStep            step      = {.courant = 0};

  PetscFunctionBegin;
  PetscCall(MpmTableRequireLinear(table));
  *b = (MpmBloch){.layout = layout, .scheme = scheme, .fields = table->nstate, .ppc = MpmLayoutPpc(layout)};
  for (PetscInt a = 0; a < layout->dim; a++) step.drift[a] = drift[a];
  PetscCall(MpmStepPeriod(&step, &b->period));
  b->size = b->fields * b->ppc;
  PetscCall(FindTurn(drift, b));
  PetscCall(FindTaken(b));
  b->most = b->size <= LANES_UP_TO ? MPM_BLOCH_LANES : 1;
  PetscCall(PetscMalloc3(2 * table->nparticles * b->ppc * MpmBlochFullWidth(b->size * b->most), &b->particle,
                         2 * table->nnodes * MpmBlochFullWidth(b->size * b->most), &b->nodes,
                         b->most * b->turn_size * b->turn_size, &b->turns));
  PetscCall(MpmStepProgramCreate(&registers, 0, &b->program));
  PetscCall(MpmStepProgramAppendTable(b->program, table, NULL));
  PetscCall(PetscMalloc1(b->program->n * MPM_BLOCH_LANES, &b->values));
  FindUsed(scheme->table, b->used);
  for (PetscInt i = 0; i < table->nstiff; i++) FindUsed(table->stiff[i], b->used);
  for (PetscInt a = 0; a < layout->dim; a++) {
    PetscCall(MpmTiesCreate(layout, scheme, a, &drift[a], b->used, &b->ties[a]));
    PetscCall(PetscMalloc1(b->ties[a].period * MPM_OP_KINDS * layout->ppc[a], &b->tie[a]));
    b->beta[a] = NAN;
  }
  PetscCall(MpmBlochNodalCreate(b, &b->nodal));
  if (!b->nodal && !b->taken && b->most == 1) PetscCall(MpmBlochGainedCreate(b, drift, &b->gained));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochDestroy(MpmBloch *b)
{
  PetscFunctionBegin;
  PetscCall(MpmBlochNodalDestroy(&b->nodal));
  PetscCall(MpmBlochGainedDestroy(&b->gained));
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    PetscCall(MpmTiesDestroy(&b->ties[a]));
    PetscCall(PetscFree(b->tie[a]));
  }
  PetscCall(PetscFree3(b->particle, b->nodes, b->turns));
  PetscCall(PetscFree2(b->place, b->beyond));
  PetscCall(PetscFree(b->taken));
  PetscCall(PetscFree(b->values));
  PetscCall(MpmStepProgramDestroy(&b->program));
  PetscFunctionReturn(PETSC_SUCCESS);
}
