/* Reorders the operations of a table. */
#include "march/reorder.h"

#define MOST_TERMS 8 /* node fields whose sum an old value is */

/* What particles take from nodes, written as what they take later on: a sum of terms. */
typedef struct {
  PetscInt n;
  MpmOp    term[MOST_TERMS];
} Delayed;

static PetscBool IsGather(const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  return traits.src == MPM_ON_NODES && traits.dst == MPM_ON_PARTICLES ? PETSC_TRUE : PETSC_FALSE;
}

static PetscBool IsSum(const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  return traits.src == MPM_ON_PARTICLES && traits.dst == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE;
}

static PetscBool IsOfNodes(const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  return traits.src == MPM_ON_NODES && traits.dst == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE;
}

/* Whether an operation reads or writes a field of the particles, or moves them. */
static PetscBool Touches(const MpmOp *op, PetscInt particle)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  if (traits.dst == MPM_NOWHERE) return PETSC_TRUE;
  return (traits.dst == MPM_ON_PARTICLES && op->dst == particle) ||
                 (traits.src == MPM_ON_PARTICLES && op->src == particle)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

static void Remove(MpmOpList *l, PetscInt at)
{
  l->n--;
  for (PetscInt o = at; o < l->n; o++) l->op[o] = l->op[o + 1];
}

static PetscErrorCode Insert(MpmOpList *l, PetscInt at, MpmOp op)
{
  PetscFunctionBegin;
  if (l->n == l->room) {
    l->room = 2 * l->room + 1;
    PetscCall(PetscRealloc(sizeof(MpmOp) * (size_t)l->room, &l->op));
  }
  for (PetscInt o = l->n++; o > at; o--) l->op[o] = l->op[o - 1];
  l->op[at] = op;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOpListCreate(const MpmTable *t, MpmOpList *l)
{
  PetscFunctionBegin;
  *l = (MpmOpList){.n = t->nops, .room = t->nops};
  PetscCall(PetscMalloc1(l->room, &l->op));
  PetscCall(PetscArraycpy(l->op, t->ops, t->nops));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmOpListSumFirst(MpmOpList *l)
{
  for (PetscInt o = 0; o < l->n; o++) {
    const MpmOp op = l->op[o];
    PetscInt    at = o;

    if (!IsSum(&op)) continue;
    for (; at > 0 && IsOfNodes(&l->op[at - 1]) && l->op[at - 1].dst != op.dst && l->op[at - 1].src != op.dst; at--)
      l->op[at] = l->op[at - 1];
    l->op[at] = op;
  }
}

PetscErrorCode MpmOpListDestroy(MpmOpList *l)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(l->op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a WALL sets to 0, just before operation at, a field that is 0 there already. */
static PetscBool IsZeroThere(const MpmOpList *l, PetscInt at, const MpmOp *wall)
{
  unsigned zero[MPM_MAX_FIELDS] = {0}; /* zero[n]: a bit for each end where node field n is 0 */

  if (wall->factor != 0) return PETSC_FALSE;
  for (const MpmOp *op = l->op; op < l->op + at; op++) {
    const unsigned end = 1U << (2 * op->axis + op->side);

    if (MpmOpTraitsOf(op->kind).dst != MPM_ON_NODES) continue;
    if (op->kind == MPM_WALL && op->factor == 0)
      zero[op->dst] |= end;
    else if (op->kind == MPM_WALL) /* the nodes of a corner are on other walls too */
      zero[op->dst] = (zero[op->dst] | end) & zero[op->src];
    else if (op->kind == MPM_COPY)
      zero[op->dst] = op->accumulates ? zero[op->dst] & zero[op->src] : zero[op->src];
    else
      zero[op->dst] = 0;
  }
  return zero[wall->dst] >> (2 * wall->axis + wall->side) & 1 ? PETSC_TRUE : PETSC_FALSE;
}

/* Takes terms past operation at, if they can be written with the node fields after it. */
static PetscBool Pass(const MpmOpList *l, PetscInt at, Delayed *d)
{
  const MpmOp   *op = &l->op[at];
  const PetscInt n  = d->n;

  if (MpmOpTraitsOf(op->kind).dst != MPM_ON_NODES) return PETSC_TRUE;
  for (PetscInt i = 0; i < n; i++) {
    if (d->term[i].src != op->dst) continue;
    if (op->kind == MPM_WALL && IsZeroThere(l, at, op)) continue;
    if (op->kind != MPM_COPY || !op->accumulates || op->dst == op->src || op->coefficient || d->n == MOST_TERMS)
      return PETSC_FALSE;
    d->term[d->n]     = d->term[i];
    d->term[d->n].src = op->src;
    d->term[d->n++].factor *= -op->factor;
  }
  return PETSC_TRUE;
}

/* Takes operation o, which changes a field of the particles, to just before the next gather to that field. */
static PetscErrorCode DelayOne(MpmOpList *l, PetscInt o)
{
  const MpmOp op = l->op[o];
  PetscInt    to = o + 1;
  Delayed     d  = {.n = 1, .term = {op}};

  PetscFunctionBegin;
  while (to < l->n && !Touches(&l->op[to], op.dst)) to++;
  if (to == l->n || to == o + 1 || !IsGather(&l->op[to])) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt at = o + 1; at < to && IsGather(&op); at++)
    if (!Pass(l, at, &d)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < d.n; i++) PetscCall(Insert(l, to, d.term[i]));
  Remove(l, o);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsSame(const MpmOp *a, const MpmOp *b)
{
  return a->kind == b->kind && a->axis == b->axis && a->dst == b->dst && a->src == b->src &&
                 a->coefficient == b->coefficient
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* The gather before o that is the same map between the same fields, whose values are the same too; or MPM_NONE. */
static PetscInt Before(const MpmOpList *l, PetscInt o)
{
  for (PetscInt at = o - 1; at >= 0; at--) {
    const MpmOp *op = &l->op[at];

    if (IsSame(op, &l->op[o])) return at;
    if (Touches(op, l->op[o].dst) && !IsGather(op)) return MPM_NONE;
    if (MpmOpTraitsOf(op->kind).dst == MPM_ON_NODES && op->dst == l->op[o].src) return MPM_NONE;
  }
  return MPM_NONE;
}

PetscErrorCode MpmOpListDelay(const MpmTable *t, MpmOpList *l)
{
  PetscFunctionBegin;
  for (PetscInt o = l->n - 1; o >= 0; o--) { /* what is moved goes to the right, where all has been moved */
    const PetscBool scales = l->op[o].kind == MPM_SCALE && l->op[o].dst < t->nstate ? PETSC_TRUE : PETSC_FALSE;

    if (scales || (IsGather(&l->op[o]) && l->op[o].dst < t->nstate)) PetscCall(DelayOne(l, o));
  }
  for (PetscInt o = l->n - 1; o >= 0; o--) {
    const PetscInt before = IsGather(&l->op[o]) ? Before(l, o) : MPM_NONE;

    if (before == MPM_NONE) continue;
    l->op[before].factor += l->op[o].factor;
    Remove(l, o);
    if (l->op[before].factor != 0) continue;
    Remove(l, before);
    o--;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
