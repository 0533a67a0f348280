/* Finds the registers that take their values from nodes, from what the plan of the nodal operator says of a step. */
#include "symbol/bloch.h"
#include "operator/nodal.h"

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
