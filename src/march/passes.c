/*
   Compiles a table to passes. Its operations are first put in an order for which a march needs fewer passes over the
   particles. They do the same but for rounding.
*/
#include "march/passes.h"

/* ---- the order of the operations ---- */

/* Operations that are run one after the other as those of a table. */
typedef struct {
  PetscInt n, room;
  MpmOp   *op;
} OpList;

#define MOST_TERMS 8 /* node fields whose sum an old value is */

/* What particles take from nodes, written as what they take later on: a sum of terms. */
typedef struct {
  PetscInt n;
  MpmOp    term[MOST_TERMS];
} Delayed;

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

static void Remove(OpList *l, PetscInt at)
{
  l->n--;
  for (PetscInt o = at; o < l->n; o++) l->op[o] = l->op[o + 1];
}

static PetscErrorCode Insert(OpList *l, PetscInt at, MpmOp op)
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

static PetscErrorCode CreateList(const MpmTable *t, OpList *l)
{
  PetscFunctionBegin;
  *l = (OpList){.n = t->nops, .room = t->nops};
  PetscCall(PetscMalloc1(l->room, &l->op));
  PetscCall(PetscArraycpy(l->op, t->ops, t->nops));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes sums from particles to nodes before the operations on nodes that they do not depend on. */
static void SumFirst(OpList *l)
{
  for (PetscInt o = 0; o < l->n; o++) {
    const MpmOp op = l->op[o];
    PetscInt    at = o;

    if (!MpmOpIsSum(&op)) continue;
    for (; at > 0 && IsOfNodes(&l->op[at - 1]) && l->op[at - 1].dst != op.dst && l->op[at - 1].src != op.dst; at--)
      l->op[at] = l->op[at - 1];
    l->op[at] = op;
  }
}

/* Whether a WALL sets to 0, just before operation at, a field that is 0 there already. */
static PetscBool IsZeroThere(const OpList *l, PetscInt at, const MpmOp *wall)
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
static PetscBool Pass(const OpList *l, PetscInt at, Delayed *d)
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
static PetscErrorCode DelayOne(OpList *l, PetscInt o)
{
  const MpmOp op = l->op[o];
  PetscInt    to = o + 1;
  Delayed     d  = {.n = 1, .term = {op}};

  PetscFunctionBegin;
  while (to < l->n && !Touches(&l->op[to], op.dst)) to++;
  if (to == l->n || to == o + 1 || !MpmOpIsGather(&l->op[to])) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt at = o + 1; at < to && MpmOpIsGather(&op); at++)
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
static PetscInt Before(const OpList *l, PetscInt o)
{
  for (PetscInt at = o - 1; at >= 0; at--) {
    const MpmOp *op = &l->op[at];

    if (IsSame(op, &l->op[o])) return at;
    if (Touches(op, l->op[o].dst) && !MpmOpIsGather(op)) return MPM_NONE;
    if (MpmOpTraitsOf(op->kind).dst == MPM_ON_NODES && op->dst == l->op[o].src) return MPM_NONE;
  }
  return MPM_NONE;
}

/*
   Lets particles take values from nodes as late as they can. Where a node field changes by n += b m in between, its old
   value is
   n - b m. Operations of the same map and fields become one, and vanish where their factors cancel. So particles with
   apic or pic take the new velocity at once, not the old one and then its change.
*/
static PetscErrorCode Delay(const MpmTable *t, OpList *l)
{
  PetscFunctionBegin;
  for (PetscInt o = l->n - 1; o >= 0; o--) { /* what is moved goes to the right, where all has been moved */
    const PetscBool scales = l->op[o].kind == MPM_SCALE && l->op[o].dst < t->nstate ? PETSC_TRUE : PETSC_FALSE;

    if (scales || (MpmOpIsGather(&l->op[o]) && l->op[o].dst < t->nstate)) PetscCall(DelayOne(l, o));
  }
  for (PetscInt o = l->n - 1; o >= 0; o--) {
    const PetscInt before = MpmOpIsGather(&l->op[o]) ? Before(l, o) : MPM_NONE;

    if (before == MPM_NONE) continue;
    l->op[before].factor += l->op[o].factor;
    Remove(l, o);
    if (l->op[before].factor != 0) continue;
    Remove(l, before);
    o--;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- passes ---- */

typedef struct {
  const MpmTable *table;
  const OpList   *ops;
  PetscReal       courant;
  PetscBool       fused, mass_due;
  PetscInt        depth[MPM_MAX_FIELDS]; /* ghosts at each end of a node field that are not valid */
  PetscInt        holds[MPM_MAX_FIELDS]; /* the particle field of which a node field is P2G as it is now, or MPM_NONE */
  MpmSchedule    *schedule;
} Compiler;

static PetscBool Sums(const MpmPass *pass, PetscInt node)
{
  for (PetscInt s = 0; s < pass->nsums; s++)
    if (pass->sum[s] == node) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscBool Reads(const MpmPass *pass, PetscInt node)
{
  for (PetscInt o = 0; o < pass->nops; o++)
    if (MpmOpIsGather(&pass->op[o]) && pass->op[o].src == node) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Notes that an operation, which is appended next, sums to a node field. */
static PetscErrorCode NoteSum(Compiler *c, MpmPass *pass, const MpmOp *op)
{
  PetscFunctionBegin;
  if (c->mass_due) {
    PetscCheck(op->kind == MPM_P2G, PETSC_COMM_SELF, PETSC_ERR_PLIB, "no P2G before another sum");
    pass->mass  = pass->nops;
    c->mass_due = PETSC_FALSE;
  }
  if (!Sums(pass, op->dst)) {
    pass->sum[pass->nsums++] = op->dst;
    c->depth[op->dst]        = 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AppendNodeOp(Compiler *c, MpmPass *pass, const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const PetscBool   solves = op->kind == MPM_SOLVE || op->kind == MPM_IMPLICIT ? PETSC_TRUE : PETSC_FALSE;
  const PetscInt    reads  = solves ? 0 : c->depth[op->src] + traits.halo;
  const PetscBool   keeps = op->accumulates || op->kind == MPM_WALL || op->kind == MPM_LOCAL ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  PetscCheck(pass->nnode_ops < MPM_MAX_PASS_OPS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MAX_PASS_OPS");
  c->depth[op->dst]                = keeps ? PetscMax(reads, c->depth[op->dst]) : reads;
  c->schedule->halo                = PetscMax(c->schedule->halo, c->depth[op->dst]);
  pass->depth[pass->nnode_ops]     = c->depth[op->dst];
  pass->node_op[pass->nnode_ops++] = *op;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Whether a pass has so many operations that the next one begins another. Sums and scratch fields live for one pass
   alone, and have the rest of the room.
*/
static PetscBool IsFull(const MpmTable *table, const MpmPass *pass, const MpmOp *op)
{
  const MpmOpTraits traits  = MpmOpTraitsOf(op->kind);
  const PetscBool   scratch = (traits.dst == MPM_ON_PARTICLES && op->dst >= MpmTableHeld(table)) ||
                                    (traits.src == MPM_ON_PARTICLES && op->src >= MpmTableHeld(table))
                                  ? PETSC_TRUE
                                  : PETSC_FALSE;

  if (traits.dst == MPM_NOWHERE || (traits.dst == MPM_ON_NODES && (traits.src == MPM_ON_NODES || op->accumulates)))
    return PETSC_FALSE;
  return pass->nops >= MPM_MAX_PASS_OPS - MPM_MAX_FIELDS && !scratch ? PETSC_TRUE : PETSC_FALSE;
}

/*
   A pass must end before an operation that reads a field which the pass has yet to complete, or that sums it anew. A
   scratch field begins in a pass that has completed what the field will be made of.
*/
static PetscBool EndsBefore(const MpmTable *table, const MpmPass *pass, const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const PetscBool   begins = op->kind == MPM_SCALE && op->dst >= MpmTableHeld(table) ? PETSC_TRUE : PETSC_FALSE;

  if (traits.dst == MPM_ON_NODES && traits.src == MPM_ON_NODES) return PETSC_FALSE;
  if (pass->nnode_ops || pass->rebase) return PETSC_TRUE;
  if (traits.dst == MPM_NOWHERE || begins) return pass->nsums ? PETSC_TRUE : PETSC_FALSE;
  if (traits.src == traits.dst || (traits.dst == MPM_ON_NODES && op->accumulates)) return PETSC_FALSE;
  return Sums(pass, traits.dst == MPM_ON_NODES ? op->dst : op->src);
}

/* Whether an operation is P2G, and neither a multiple of it nor a part of a sum. */
static PetscBool IsPlain(const MpmOp *op)
{
  return op->kind == MPM_P2G && !op->accumulates && op->factor == 1 && !op->coefficient ? PETSC_TRUE : PETSC_FALSE;
}

/* Notes which node fields are P2G of a particle field once op is done. */
static void NoteHeld(Compiler *c, const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  for (PetscInt n = 0; n < MPM_MAX_FIELDS; n++) {
    const PetscBool moved   = traits.dst == MPM_NOWHERE ? PETSC_TRUE : PETSC_FALSE;
    const PetscBool changed = traits.dst == MPM_ON_PARTICLES && c->holds[n] == op->dst ? PETSC_TRUE : PETSC_FALSE;
    const PetscBool written = traits.dst == MPM_ON_NODES && n == op->dst ? PETSC_TRUE : PETSC_FALSE;

    if (moved || changed || written) c->holds[n] = MPM_NONE;
  }
  if (IsPlain(op)) c->holds[op->dst] = op->src;
}

/* An ADD of a field to itself is a SCALE. */
static PetscErrorCode CompileOp(Compiler *c, MpmPass *pass, const MpmOp *of)
{
  const MpmOpTraits traits = MpmOpTraitsOf(of->kind);
  MpmOp             op     = *of;

  PetscFunctionBegin;
  op.factor      = MpmOpValue(of, c->courant);
  op.coefficient = 0;
  if (op.kind == MPM_ADD && op.dst == op.src) {
    op.kind = MPM_SCALE;
    op.factor += 1;
  }
  NoteHeld(c, of);
  if (traits.dst == MPM_ON_NODES && traits.src == MPM_ON_NODES) {
    PetscCall(AppendNodeOp(c, pass, &op));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (traits.dst == MPM_NOWHERE) {
    pass->drifts = PETSC_TRUE;
    pass->within = op.kind == MPM_ADVANCE && op.factor < 1 ? PETSC_TRUE : PETSC_FALSE;
    pass->rebase = c->fused ? PETSC_FALSE : PETSC_TRUE;
    c->mass_due  = PETSC_TRUE;
  }
  if (traits.dst == MPM_ON_NODES) PetscCall(NoteSum(c, pass, &op));
  PetscCheck(pass->nops < MPM_MAX_PASS_OPS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MAX_PASS_OPS");
  pass->op[pass->nops++] = op;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt MpmHeadLength(const MpmTable *table, PetscInt nops, const MpmOp ops[])
{
  PetscBool used[MPM_MAX_FIELDS] = {PETSC_FALSE};
  PetscInt  h                    = 0;

  for (; h < nops; h++) {
    const MpmOp      *op     = &ops[h];
    const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

    if (op->kind == MPM_STRESS || op->kind == MPM_LOAD) continue; /* they need nothing but the particles */
    if (traits.dst != MPM_ON_NODES || (op->kind == MPM_IMPLICIT && MpmTableIsFinite(table))) break;
    if (traits.src == MPM_ON_PARTICLES && !op->accumulates && used[op->dst]) break;
    used[op->dst] = PETSC_TRUE;
    if (traits.src == MPM_ON_NODES) used[op->src] = PETSC_TRUE;
  }
  return h;
}

static PetscErrorCode NewPass(MpmSchedule *schedule, MpmPass **pass)
{
  PetscFunctionBegin;
  if (schedule->npasses == schedule->room) {
    schedule->room = PetscMax(8, 2 * schedule->room);
    PetscCall(PetscRealloc(sizeof(MpmPass) * (size_t)schedule->room, &schedule->pass));
  }
  *pass = &schedule->pass[schedule->npasses++];
  PetscCall(PetscMemzero(*pass, sizeof **pass));
  (*pass)->mass = MPM_NONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A scratch field lives for one pass: an operation that reads it, or adds to it, comes in the pass that begins it. */
static PetscErrorCode CheckScratch(const MpmTable *t, const MpmOp *op, PetscBool begun[])
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const PetscBool   from   = traits.src == MPM_ON_PARTICLES && op->src >= MpmTableHeld(t) ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool   to     = traits.dst == MPM_ON_PARTICLES && op->dst >= MpmTableHeld(t) ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  if (MpmTableIsFinite(t)) PetscFunctionReturn(PETSC_SUCCESS); /* there operations have more fields than they name */
  if (to && op->kind == MPM_SCALE) begun[op->dst] = PETSC_TRUE;
  PetscCheck((!from || begun[op->src]) && (!to || begun[op->dst]), PETSC_COMM_SELF, PETSC_ERR_PLIB,
             "a scratch field outlives its pass over the particles");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CompileOps(Compiler *c, PetscBool drifts)
{
  const MpmTable *t                     = c->table;
  const OpList   *ops                   = c->ops;
  const PetscInt  head                  = MpmHeadLength(t, ops->n, ops->op);
  PetscBool       begun[MPM_MAX_FIELDS] = {PETSC_FALSE};
  MpmPass        *pass;

  PetscFunctionBegin;
  c->schedule->start.mass = MPM_NONE;
  for (PetscInt o = 0; o < head; o++) PetscCall(CompileOp(c, &c->schedule->start, &ops->op[o]));
  PetscCall(NewPass(c->schedule, &pass));
  for (PetscInt o = 0; o < ops->n; o++) {
    const MpmOp *op = &ops->op[(head + o) % ops->n];

    if (MpmOpTraitsOf(op->kind).dst == MPM_NOWHERE && !drifts) continue;
    if (IsPlain(op) && c->holds[op->dst] == op->src) continue; /* at rest, musl's second P2G serves */
    if (EndsBefore(t, pass, op) || IsFull(t, pass, op)) {
      PetscCall(NewPass(c->schedule, &pass));
      PetscCall(PetscArrayzero(begun, MPM_MAX_FIELDS));
    }
    PetscCall(CheckScratch(t, op, begun));
    PetscCall(CompileOp(c, pass, op));
  }
  for (PetscInt p = 0; p < c->schedule->npasses; p++)
    for (PetscInt s = 0; s < c->schedule->pass[p].nsums; s++) {
      const PetscInt node = c->schedule->pass[p].sum[s];

      if (Reads(&c->schedule->pass[p], node)) c->schedule->spare[node] = PETSC_TRUE;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The passes of a step, and the node fields that each of them reads or sums. */
static PetscInt CostOf(const MpmSchedule *schedule)
{
  PetscInt cost = schedule->npasses;

  for (const MpmPass *pass = schedule->pass; pass < schedule->pass + schedule->npasses; pass++) {
    cost += pass->nsums;
    for (PetscInt n = 0; n < MPM_MAX_FIELDS; n++) cost += Reads(pass, n);
  }
  return cost;
}

/*
   Whether operations may be brought together: all sums fit in one pass, and all operations on nodes after one. At
   finite deformation operations on particles have more fields than those that they name.
*/
static PetscBool MayReorder(const MpmTable *t)
{
  PetscInt sums = 0, nodes = 0;

  if (MpmTableIsFinite(t)) return PETSC_FALSE;
  for (PetscInt o = 0; o < t->nops; o++) {
    const MpmOpTraits traits = MpmOpTraitsOf(t->ops[o].kind);

    if (traits.dst != MPM_ON_NODES) continue;
    if (traits.src == MPM_ON_NODES)
      nodes++;
    else
      sums++;
  }
  return sums < MPM_MAX_PASS_OPS - MPM_MAX_FIELDS && nodes < MPM_MAX_PASS_OPS ? PETSC_TRUE : PETSC_FALSE;
}

/* Compiles the operations with and without delayed gathers, and keeps what is cheaper. */
PetscErrorCode MpmScheduleCompile(const MpmTable *t, PetscReal courant, PetscBool drifts, PetscBool fused,
                                  MpmSchedule *schedule)
{
  const PetscBool reorders = MayReorder(t);
  OpList          list     = {.n = 0};
  MpmSchedule     each[2]  = {{.npasses = 0}, {.npasses = 0}};
  PetscInt        cheapest = 0;

  PetscFunctionBegin;
  PetscCall(MpmScheduleDestroy(schedule));
  PetscCall(CreateList(t, &list));
  for (PetscInt delayed = 0; delayed < (reorders ? 2 : 1); delayed++) {
    Compiler c = {.table    = t,
                  .ops      = &list,
                  .courant  = courant,
                  .fused    = fused,
                  .mass_due = MpmTableHas(t, MPM_P2G) && !t->image, /* a table of IMPLICIT finds the masses */
                  .schedule = &each[delayed]};

    for (PetscInt n = 0; n < MPM_MAX_FIELDS; n++) c.holds[n] = MPM_NONE;
    if (delayed) PetscCall(Delay(t, &list));
    if (reorders) SumFirst(&list);
    PetscCall(CompileOps(&c, drifts));
    if (delayed && CostOf(&each[1]) < CostOf(&each[0])) cheapest = 1;
  }
  PetscCall(PetscFree(list.op));
  PetscCall(MpmScheduleDestroy(&each[1 - cheapest]));
  *schedule = each[cheapest];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmScheduleDestroy(MpmSchedule *schedule)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(schedule->pass));
  PetscCall(PetscMemzero(schedule, sizeof *schedule));
  PetscFunctionReturn(PETSC_SUCCESS);
}
