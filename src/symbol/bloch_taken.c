/* Finds the registers that take their values from nodes: a table followed operation by operation. */
#include "symbol/bloch_taken.h"

/*
   renewed, spoiled - of each particle register: it was set to 0, and has since got something else than nodal values
   version          - of each node register: how often it was written
   room             - there was room for all gifts
*/
typedef struct {
  const MpmTable *table;
  MpmTaken       *of;
  PetscBool       renewed[MPM_MAX_FIELDS], spoiled[MPM_MAX_FIELDS], room;
  PetscInt        version[MPM_MAX_FIELDS];
} Finder;

/* Multiplies what a register has got, which may be by 0. */
static void Scale(Finder *f, const MpmOp *op)
{
  if (op->factor == 0) {
    f->renewed[op->dst] = PETSC_TRUE;
    f->spoiled[op->dst] = PETSC_FALSE;
  }
  for (PetscInt g = 0; g < f->of->ngifts; g++) {
    MpmTakenGift *gift = &f->of->gift[g];

    for (PetscInt i = gift->parts - 1; i >= 0; i--) {
      if (gift->part[i].dst != op->dst) continue;
      gift->part[i].factor *= op->factor;
      gift->part[i].power += op->coefficient;
      if (op->factor == 0) gift->part[i] = gift->part[--gift->parts];
    }
  }
}

static MpmTakenGift *GiftOf(Finder *f, PetscInt at, PetscInt src)
{
  MpmTaken *of = f->of;

  for (PetscInt g = 0; g < of->ngifts; g++)
    if (of->gift[g].src == src && of->gift[g].version == f->version[src]) return &of->gift[g];
  if (of->ngifts == MPM_MAX_TAKEN) return NULL;
  of->gift[of->ngifts] = (MpmTakenGift){.at = at, .src = src, .version = f->version[src]};
  return &of->gift[of->ngifts++];
}

static PetscBool SamePlace(const MpmTakenPart *a, const MpmTakenPart *b)
{
  return a->dst == b->dst && a->kind == b->kind && a->axis == b->axis && a->power == b->power ? PETSC_TRUE
                                                                                              : PETSC_FALSE;
}

static void Give(Finder *f, PetscInt at, const MpmOp *op)
{
  const MpmTakenPart part = {
      .dst = op->dst, .kind = op->kind, .axis = op->axis, .power = op->coefficient, .factor = op->factor};
  MpmTakenGift *gift = GiftOf(f, at, op->src);

  if (!gift || gift->parts == MPM_MAX_FIELDS) {
    f->room = PETSC_FALSE;
    return;
  }
  for (PetscInt i = 0; i < gift->parts; i++)
    if (SamePlace(&gift->part[i], &part)) {
      gift->part[i].factor += part.factor;
      return;
    }
  gift->part[gift->parts++] = part;
}

static void Follow(Finder *f)
{
  for (PetscInt o = 0; o < f->table->nops && f->room; o++) {
    const MpmOp      *op     = &f->table->ops[o];
    const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

    if (traits.dst == MPM_ON_NODES)
      f->version[op->dst]++;
    else if (traits.dst == MPM_ON_PARTICLES && traits.src == MPM_ON_NODES)
      Give(f, o, op);
    else if (op->kind == MPM_SCALE)
      Scale(f, op);
    else if (traits.dst == MPM_ON_PARTICLES)
      f->spoiled[op->dst] = PETSC_TRUE;
  }
}

/* Parts of registers that are not taken go. */
static void KeepTaken(Finder *f)
{
  MpmTaken *of = f->of;

  for (PetscInt r = 0; r < f->table->nstate; r++) {
    of->taken[r] = f->renewed[r] && !f->spoiled[r] ? PETSC_TRUE : PETSC_FALSE;
    of->left += of->taken[r] ? 0 : 1;
  }
  for (PetscInt g = of->ngifts - 1; g >= 0; g--) {
    MpmTakenGift *gift = &of->gift[g];

    for (PetscInt i = gift->parts - 1; i >= 0; i--)
      if (!of->taken[gift->part[i].dst]) gift->part[i] = gift->part[--gift->parts];
    if (gift->parts == 0) *gift = of->gift[--of->ngifts];
  }
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

PetscErrorCode MpmTakenFind(const MpmTable *table, MpmTaken **taken)
{
  Finder f = {.table = table, .room = PETSC_TRUE};

  PetscFunctionBegin;
  PetscCall(PetscNew(taken));
  f.of = *taken;
  Follow(&f);
  KeepTaken(&f);
  Number(f.of);
  if (!f.room || f.of->left == table->nstate) PetscCall(PetscFree(*taken));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the particles of a table only gain from nodes. */
static PetscBool OnlyGain(const MpmTable *table)
{
  for (PetscInt o = 0; o < table->nops; o++) {
    const MpmOpTraits traits = MpmOpTraitsOf(table->ops[o].kind);

    if (traits.dst != MPM_ON_PARTICLES) continue;
    if (traits.src != MPM_ON_NODES || table->ops[o].dst >= table->nstate) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

PetscErrorCode MpmTakenGains(const MpmTable *table, MpmTaken **gains)
{
  Finder f = {.table = table, .room = PETSC_TRUE};

  PetscFunctionBegin;
  *gains = NULL;
  if (!OnlyGain(table)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscNew(gains));
  f.of = *gains;
  Follow(&f);
  Number(f.of);
  if (!f.room || f.of->ngifts == 0) PetscCall(PetscFree(*gains));
  PetscFunctionReturn(PETSC_SUCCESS);
}
