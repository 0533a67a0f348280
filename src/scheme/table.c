/* MpmTableCreate makes a table from a formulation, a transfer and a boundary, and checks it. */
#include <mpmstab/table.h>

/* What MpmTableCreate needs while it makes a table. */
typedef struct {
  const MpmFormulation     *formulation;
  const MpmTransfer        *transfer;
  const MpmTransferNumbers *numbers;
  PetscInt                  kept[MPM_MAX_FIELDS]; /* node fields with values from before the wall, or MPM_NONE */
  MpmTable                 *table;
} Builder;

static PetscErrorCode AppendOp(MpmTable *t, MpmOp op)
{
  PetscFunctionBegin;
  if (t->nops == t->room) {
    t->room = PetscMax(32, 2 * t->room);
    PetscCall(PetscRealloc(sizeof(*t->ops) * (size_t)t->room, &t->ops));
  }
  t->ops[t->nops++] = op;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For an operation on the field with an affine part, appends the operation on that part. */
static PetscErrorCode AppendAffine(MpmTable *t, MpmOp op)
{
  PetscFunctionBegin;
  if (op.kind == MPM_P2G && op.src == t->affine) {
    op.kind        = MPM_P2G_AFFINE;
    op.src         = t->affine_part;
    op.accumulates = PETSC_TRUE;
  } else if (op.kind == MPM_G2P && op.dst == t->affine) {
    op.kind = MPM_G2P_AFFINE;
    op.dst  = t->affine_part;
  } else if (op.kind == MPM_SCALE && op.dst == t->affine)
    op.dst = op.src = t->affine_part;
  else
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(AppendOp(t, op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AppendBoth(MpmTable *t, MpmOp op)
{
  PetscFunctionBegin;
  PetscCall(AppendOp(t, op));
  if (t->affine != MPM_NONE) PetscCall(AppendAffine(t, op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTableAppend(MpmTable *t, MpmOp op)
{
  PetscFunctionBegin;
  PetscCall(AppendBoth(t, op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTableNode(MpmTable *t, PetscInt like, PetscInt *node)
{
  PetscFunctionBegin;
  PetscCheck(t->nnodes < MPM_MAX_FIELDS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MAX_FIELDS");
  *node                   = t->nnodes++;
  t->antisymmetric[*node] = t->antisymmetric[like];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTableScratch(MpmTable *t, PetscInt *particle)
{
  PetscFunctionBegin;
  PetscCheck(t->nparticles < MPM_MAX_FIELDS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MAX_FIELDS");
  *particle = t->nparticles++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Wall(MpmTable *t, PetscInt end, PetscInt dst, PetscInt src, PetscReal factor)
{
  PetscFunctionBegin;
  PetscCall(AppendOp(t, (MpmOp){.kind = MPM_WALL, .dst = dst, .src = src, .factor = factor, .side = end}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTableImpose(MpmTable *t, PetscInt node)
{
  PetscFunctionBegin;
  for (PetscInt end = 0; end < 2; end++)
    if (t->ends[end] == MPM_FIXED && t->antisymmetric[node]) PetscCall(Wall(t, end, node, node, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Sets a node field to 0 at ends with a reaction. If a later REACT uses the field, its value before the wall is kept in
   another node field, the first time that the wall is imposed in the step.
*/
static PetscErrorCode ImposeWithReaction(Builder *b, PetscInt node)
{
  MpmTable *t      = b->table;
  PetscBool wanted = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt o = 0; o < b->formulation->nops; o++)
    if (b->formulation->ops[o].kind == MPM_REACT && b->formulation->ops[o].src == node) wanted = PETSC_TRUE;
  for (PetscInt end = 0; end < 2; end++) {
    const PetscBool keep = wanted && b->kept[node] == MPM_NONE ? PETSC_TRUE : PETSC_FALSE;

    if (t->ends[end] != MPM_FIXED_REACTION) continue;
    if (keep) {
      PetscCall(MpmTableNode(t, node, &b->kept[node]));
      for (PetscInt each = 0; each < 2; each++)
        if (t->ends[each] == MPM_FIXED_REACTION) PetscCall(Wall(t, each, b->kept[node], node, 1));
    }
    PetscCall(Wall(t, end, node, node, 0));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode React(Builder *b, const MpmOp *op)
{
  PetscFunctionBegin;
  for (PetscInt end = 0; end < 2; end++) {
    if (b->table->ends[end] == MPM_FIXED) PetscCall(Wall(b->table, end, op->dst, op->dst, 0));
    if (b->table->ends[end] == MPM_FIXED_REACTION) PetscCall(Wall(b->table, end, op->dst, b->kept[op->src], -1));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A filter needs P2G of its field. Where the table has none before the filter, one is added. */
static PetscErrorCode Filter(Builder *b, const MpmOp *op)
{
  MpmTable *t     = b->table;
  PetscBool taken = PETSC_FALSE;

  PetscFunctionBegin;
  if (!b->transfer->filter) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt o = 0; o < t->nops; o++)
    if (t->ops[o].kind == MPM_P2G && t->ops[o].dst == op->src) taken = PETSC_TRUE;
  if (!taken) {
    PetscCall(MpmTableAppend(t, (MpmOp)P2G(op->src, op->dst)));
    PetscCall(MpmTableImpose(t, op->src));
  }
  PetscCall(b->transfer->filter(t, b->numbers, op->dst, op->src));
  t->filtered[op->dst] = PETSC_TRUE;
  t->unfiltered--;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A wall with a reaction is imposed after the filter, because the filter must act on the values before the wall. */
static PetscErrorCode Translate(Builder *b)
{
  const MpmFormulation *f = b->formulation;

  PetscFunctionBegin;
  for (PetscInt o = 0; o < f->nops; o++) {
    const MpmOp    *op = &f->ops[o];
    const PetscBool filtered =
        o + 1 < f->nops && op[1].kind == MPM_FILTER && op[1].src == op->dst ? PETSC_TRUE : PETSC_FALSE;

    if (op->kind == MPM_IMPOSE) {
      PetscCall(MpmTableImpose(b->table, op->dst));
      if (filtered) PetscCall(Filter(b, &f->ops[++o]));
      PetscCall(ImposeWithReaction(b, op->dst));
    } else if (op->kind == MPM_FILTER)
      PetscCall(Filter(b, op));
    else if (op->kind == MPM_REACT)
      PetscCall(React(b, op));
    else
      PetscCall(AppendBoth(b->table, *op));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define SUPPORTED(condition, o, why)                                                                                   \
  PetscCheck(condition, PETSC_COMM_SELF, PETSC_ERR_SUP, "operation %" PetscInt_FMT " of the table: %s", o, why)

/* Whether all operations between o, which continues a sum over particles, and the one that begins the sum are sums. */
static PetscBool ContinuesSum(const MpmTable *t, PetscInt o)
{
  for (PetscInt before = o - 1; before >= 0; before--) {
    const MpmOpTraits traits = MpmOpTraitsOf(t->ops[before].kind);

    if (traits.dst != MPM_ON_NODES || traits.src != MPM_ON_PARTICLES) return PETSC_FALSE;
    if (t->ops[before].dst == t->ops[o].dst) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Refuses an operation that an interpreter would get wrong. written[n]: the step has written to node field n by now. */
static PetscErrorCode CheckOp(const MpmTable *t, PetscInt o, PetscBool written[])
{
  const MpmOp      *op     = &t->ops[o];
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const PetscInt    nodes = t->nnodes, particles = t->nparticles;
  const PetscBool   stencil  = op->kind == MPM_LAP || op->kind == MPM_COPY ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool   sum      = traits.dst == MPM_ON_NODES && traits.src == MPM_ON_PARTICLES ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool   to_nodes = traits.dst == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  SUPPORTED(op->axis == 0, o, "there is one axis, 0");
  SUPPORTED(op->side == 0 || op->side == 1, o, "an axis has the sides 0 and 1");
  SUPPORTED(op->coefficient >= 0, o, "powers of the Courant number are 0, 1, 2 and so on");
  if (traits.dst == MPM_NOWHERE) PetscFunctionReturn(PETSC_SUCCESS);
  SUPPORTED(op->dst >= 0 && op->dst < (to_nodes ? nodes : particles), o,
            "the register that it writes to does not exist");
  SUPPORTED(op->src >= 0 && op->src < (traits.src == MPM_ON_NODES ? nodes : particles), o,
            "the register that it reads does not exist");
  if (traits.dst == MPM_ON_PARTICLES && traits.src == MPM_ON_NODES)
    SUPPORTED(op->accumulates, o, "what goes to particles is added to what they have");
  else if (!stencil && !sum)
    SUPPORTED(!op->accumulates, o, "this kind does not accumulate");
  SUPPORTED(!stencil || op->dst != op->src, o, "it would read the nodes that it writes");
  SUPPORTED(!sum || !op->accumulates || ContinuesSum(t, o), o,
            "it continues a sum, but other operations have come in between");
  SUPPORTED(traits.src != MPM_ON_NODES || written[op->src] || op->kind == MPM_WALL, o,
            "it reads a node field that the step has not written to");
  SUPPORTED(!to_nodes || !op->accumulates || written[op->dst], o,
            "it adds to a node field before anything has been written there");
  if (to_nodes) written[op->dst] = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckOps(const MpmTable *t)
{
  PetscBool written[MPM_MAX_FIELDS] = {PETSC_FALSE};

  PetscFunctionBegin;
  for (PetscInt o = 0; o < t->nops; o++) PetscCall(CheckOp(t, o, written));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt CountNames(const char *const names[])
{
  PetscInt n = 0;
  while (names[n]) n++;
  return n;
}

PetscErrorCode MpmTableCreate(const MpmFormulation *formulation, const MpmTransfer *transfer,
                              const MpmTransferNumbers *numbers, const MpmEnd ends[2], MpmTable **table)
{
  Builder   b = {.formulation = formulation, .transfer = transfer, .numbers = numbers};
  MpmTable *t;

  PetscFunctionBegin;
  PetscCall(PetscNew(table));
  t       = *table;
  b.table = t;
  for (PetscInt n = 0; n < MPM_MAX_FIELDS; n++) b.kept[n] = MPM_NONE;
  for (PetscInt end = 0; end < 2; end++) t->ends[end] = ends[end];
  t->nnodes = CountNames(formulation->node_fields);
  t->nstate = CountNames(formulation->particle_fields);
  for (PetscInt f = 0; f < t->nstate; f++) t->fields[f] = formulation->particle_fields[f];
  t->affine = MPM_NONE;
  if (transfer->affine) {
    PetscCheck(formulation->affine != MPM_NONE, PETSC_COMM_SELF, PETSC_ERR_PLIB, "no field to be affine");
    t->affine              = formulation->affine;
    t->affine_part         = t->nstate;
    t->fields[t->nstate++] = "c";
  }
  t->nparticles = t->unfiltered = t->nstate;
  if (transfer->affine) {
    t->filtered[t->affine_part] = PETSC_TRUE;
    t->unfiltered--;
  }
  for (PetscInt o = 0; o < formulation->nops; o++)
    if (formulation->ops[o].kind == MPM_IMPOSE || formulation->ops[o].kind == MPM_REACT)
      t->antisymmetric[formulation->ops[o].dst] = PETSC_TRUE;
  PetscCall(Translate(&b));
  PetscCall(CheckOps(t));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTableDestroy(MpmTable **table)
{
  PetscFunctionBegin;
  if (*table) PetscCall(PetscFree((*table)->ops));
  PetscCall(PetscFree(*table));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const MpmOp *MpmTableSeenBy(const MpmTable *table, PetscInt field)
{
  for (PetscInt o = 0; o < table->nops; o++) {
    const MpmOpTraits traits = MpmOpTraitsOf(table->ops[o].kind);

    if (traits.dst == MPM_ON_NODES && traits.src == MPM_ON_PARTICLES && table->ops[o].src == field)
      return &table->ops[o];
  }
  return NULL;
}

PetscBool MpmTableIsAntisymmetric(const MpmTable *table, PetscInt field)
{
  const MpmOp *seen = MpmTableSeenBy(table, field);

  return seen && seen->kind == MPM_P2G ? table->antisymmetric[seen->dst] : PETSC_FALSE;
}

PetscBool MpmTableHas(const MpmTable *table, MpmOpKind kind)
{
  for (PetscInt o = 0; o < table->nops; o++)
    if (table->ops[o].kind == kind) return PETSC_TRUE;
  return PETSC_FALSE;
}
