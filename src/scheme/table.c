/*
   MpmTableCreate makes a table from a formulation, a transfer and a space, and checks it. It writes the operations on
   scalars, vectors and stresses out as operations on numbers, so that those who interpret a table know only numbers.
*/
#include "scheme/language.h"
#include "scheme/table_builder.h"
#include <mpmstab/errors.h>

const char *const MpmGradientNames[]   = {"basis", "mls", NULL};
const char *const MpmFilterTimeNames[] = {"after", "before", NULL};
const char *const MpmMoveNames[]       = {"grid", "projected", NULL};

/* ---- what particles take from nodes ---- */

/* Whether an operation from number first on writes to a register at a place. */
static PetscBool Writes(const MpmTable *t, PetscInt first, MpmPlace place, PetscInt reg)
{
  for (PetscInt o = first; o < t->nops; o++)
    if (MpmOpTraitsOf(t->ops[o].kind).dst == place && t->ops[o].dst == reg) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode MpmBuilderSharpen(MpmTableBuilder *b, PetscInt node, PetscInt *sharp)
{
  PetscFunctionBegin;
  *sharp = node;
  if (!b->transfer->sharpen) PetscFunctionReturn(PETSC_SUCCESS);
  if (b->sharp[node] == MPM_NONE || Writes(b->table, b->sharp_at[node], MPM_ON_NODES, node)) {
    b->sharp_at[node] = b->table->nops;
    PetscCall(b->transfer->sharpen(b->table, b->numbers, node, &b->sharp[node]));
  }
  *sharp = b->sharp[node];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBuilderSharpenAll(MpmTableBuilder *b, PetscInt first, PetscInt n)
{
  PetscInt sharp;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < n; c++) PetscCall(MpmBuilderSharpen(b, first + c, &sharp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBuilderAppend(MpmTableBuilder *b, MpmOp op)
{
  PetscFunctionBegin;
  if (MpmOpIsGather(&op)) PetscCall(MpmBuilderSharpen(b, op.src, &op.src));
  PetscCall(MpmTableAppend(b->table, op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the operations of formulations, written out for components ---- */

/* An operation between fields of one rank: one on each component. */
static PetscErrorCode Each(MpmTableBuilder *b, const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const PetscBool   to     = traits.dst == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE,
                  from     = traits.src == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE;
  MpmOp one                = *op;

  PetscFunctionBegin;
  if (traits.dst == MPM_NOWHERE) {
    PetscCall(MpmBuilderAppend(b, *op));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheck(MpmBuilderComponents(b, to, op->dst) == MpmBuilderComponents(b, from, op->src), PETSC_COMM_SELF,
             PETSC_ERR_SUP, "the table: fields of different ranks, in an operation that acts on each component");
  for (PetscInt c = 0; c < MpmBuilderComponents(b, to, op->dst); c++) {
    one.dst = (to ? b->node : b->particle)[op->dst] + c;
    one.src = (from ? b->node : b->particle)[op->src] + c;
    PetscCall(MpmBuilderAppend(b, one));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a stress is one number, which the prestress adds to the stiffness of: in one dimension, and of a fluid. */
static PetscBool IsOneNumber(const MpmSpace *space)
{
  return space->dim == 1 || MpmSpaceIsFluid(space) ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmBuilderTerm(MpmTableBuilder *b, const MpmOp *op, PetscInt dst, PetscInt src, PetscInt axis,
                              PetscReal factor, PetscBool accumulates)
{
  const PetscBool mls = b->space->gradient == MPM_GRADIENT_MLS ? PETSC_TRUE : PETSC_FALSE;
  MpmOp           one = *op;

  PetscFunctionBegin;
  if (mls && op->kind == MPM_DIV) one.kind = MPM_DIV_MLS;
  if (mls && op->kind == MPM_GRAD) one.kind = MPM_GRAD_MLS;
  if (mls && op->kind == MPM_CURVE) one.kind = MPM_CURVE_MLS;
  if (mls && op->kind == MPM_G2P_SLOPE) one.kind = MPM_G2P_AFFINE; /* the slopes that fit the nodes best */
  one.dst         = dst;
  one.src         = src;
  one.axis        = axis;
  one.factor      = op->factor * factor;
  one.accumulates = accumulates;
  PetscCall(MpmBuilderAppend(b, one));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBuilderSlopes(MpmTableBuilder *b, const MpmOp *op, PetscInt slopes, PetscInt v)
{
  const PetscInt dim = b->space->dim;
  MpmOp          one = *op;

  PetscFunctionBegin;
  one.kind = MPM_G2P_SLOPE;
  for (PetscInt c = 0; c < dim * dim; c++)
    PetscCall(MpmBuilderTerm(b, &one, slopes + c, v + c / dim, c % dim, 1, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The force of a prestress on displaced particles: a_a += sigma0_ab CURVE_bc x_c. */
static PetscErrorCode Curve(MpmTableBuilder *b, const MpmOp *div, PetscInt a)
{
  const MpmSpace *space = b->space;
  MpmOp           op    = *div;

  PetscFunctionBegin;
  if (!space->displaced) PetscFunctionReturn(PETSC_SUCCESS);
  op.kind = MPM_CURVE;
  for (PetscInt along = 0; along < space->dim; along++) {
    const PetscReal sigma0 = MpmSpacePrestress(space, a, along);

    for (PetscInt c = 0; c < space->dim && sigma0 != 0; c++)
      if (space->curved || c != along)
        PetscCall(MpmBuilderTerm(b, &op, b->node[div->dst] + a, b->table->displacement + c, MpmAxes(along, c), sigma0,
                                 PETSC_TRUE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x += k G2P of each component of a velocity of the grid. */
static PetscErrorCode Move(MpmTableBuilder *b, const MpmOp *op)
{
  const PetscBool projected = op->kind == MPM_MOVE_PROJECTED ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  if (!b->space->displaced || projected != (b->space->move == MPM_MOVES_PROJECTED)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < b->space->dim; a++)
    PetscCall(
        MpmBuilderAppend(b, (MpmOp)G2P_TIMES(b->table->displacement + a, b->node[op->src] + a, op->factor, COURANT)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The component of a field that DIV along an axis makes component a of another of, or MPM_NONE. */
static PetscInt ComponentOfDiv(const MpmTableBuilder *b, PetscInt field, PetscInt a, PetscInt axis)
{
  const MpmRank rank = b->formulation->particle_ranks[field];

  if (MpmBuilderIsAhead(b, field)) return b->space->dim * a + axis;
  if (rank == MPM_TENSOR) return MpmSpaceStress(b->space, a, axis);
  return rank == MPM_VECTOR ? axis : a == axis ? 0 : MPM_NONE;
}

static PetscErrorCode Div(MpmTableBuilder *b, const MpmOp *op)
{
  const PetscInt  dim = b->space->dim, dst = b->node[op->dst], src = b->particle[op->src];
  const MpmRank   to = b->formulation->node_ranks[op->dst], from = b->formulation->particle_ranks[op->src];
  const PetscBool stressed  = from == MPM_TENSOR && !MpmBuilderIsAhead(b, op->src) ? PETSC_TRUE : PETSC_FALSE;
  const PetscReal stiffness = stressed && IsOneNumber(b->space) ? 1 + b->space->prestress[0] : 1;

  PetscFunctionBegin;
  PetscCheck(dim == 1 || (to == MPM_VECTOR && from != MPM_VECTOR) || (to == MPM_SCALAR && from == MPM_VECTOR),
             PETSC_COMM_SELF, PETSC_ERR_SUP,
             "the table: DIV makes a vector of a stress or a number, and a number of a vector");
  for (PetscInt a = 0; a < (to == MPM_VECTOR ? dim : 1); a++) {
    PetscBool accumulates = op->accumulates;

    for (PetscInt axis = 0; axis < dim; axis++) {
      const PetscInt component = ComponentOfDiv(b, op->src, a, axis);

      if (component == MPM_NONE) continue;
      PetscCall(MpmBuilderTerm(b, op, dst + a, src + component, axis, stiffness, accumulates));
      accumulates = PETSC_TRUE;
    }
    if (from == MPM_TENSOR) PetscCall(Curve(b, op, a));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* q_ab = a s_ab, as DIV has it: the start of the stress of the middle of an implicit step about a prestress. */
static PetscErrorCode AheadFrom(MpmTableBuilder *b, const MpmOp *op)
{
  const PetscInt dim = b->space->dim;
  MpmOp          one = *op;

  PetscFunctionBegin;
  one.factor *= IsOneNumber(b->space) ? 1 + b->space->prestress[0] : 1;
  for (PetscInt c = 0; c < dim * dim; c++) {
    const PetscInt component = MpmSpaceStress(b->space, c / dim, c % dim);

    one.dst = b->particle[op->dst] + c;
    one.src = b->particle[op->src] + component;
    if (component != MPM_NONE) PetscCall(MpmTableAppendOwn(b->table, one));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   s_ab += sum_cd MpmSpaceTangent_abcd GRAD_d v_c, or with the moduli of each particle, which have no prestress
   (scene_law.c); of a fluid s += sum_c GRAD_c v_c; and of the stress ahead

     q_ab += (ds_ab / d (dv_c/dx_d) - sigma0_ad d_bc) GRAD_d v_c:    dT = dtau - tau L^T
*/
static PetscErrorCode GradToStress(MpmTableBuilder *b, const MpmOp *op)
{
  const PetscInt  dim = b->space->dim, s = b->particle[op->dst], v = b->node[op->src];
  const PetscBool ahead = MpmBuilderIsAhead(b, op->dst), fluid = MpmSpaceIsFluid(b->space) && !ahead;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < dim && fluid; a++) PetscCall(MpmBuilderTerm(b, op, s, v + a, a, 1, PETSC_TRUE));
  for (PetscInt i = 0; i < dim * dim * dim * dim && !fluid; i++) {
    const PetscInt  a = i / dim / dim / dim, e = i / dim / dim % dim, c = i / dim % dim, d = i % dim;
    const PetscBool of_trace = a == e && c == d ? PETSC_TRUE : PETSC_FALSE;
    MpmOp           own      = *op;
    PetscReal       tangent  = MpmSpaceTangent(b->space, a, e, c, d);

    if (ahead && e == c) tangent -= MpmSpacePrestress(b->space, a, d);
    if (b->space->lames) {
      own.side = !of_trace ? MPM_SHEAR - MPM_STIFFNESS : a == c ? 0 : MPM_LAMBDA - MPM_STIFFNESS;
      tangent  = of_trace || (a == c && e == d) || (a == d && e == c);
    }
    if (tangent != 0 && (ahead || a <= e))
      PetscCall(MpmBuilderTerm(b, &own, s + (ahead ? dim * a + e : MpmSpaceStress(b->space, a, e)), v + c, d, tangent,
                               PETSC_TRUE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Grad(MpmTableBuilder *b, const MpmOp *op)
{
  const PetscInt dim = b->space->dim, dst = b->particle[op->dst], src = b->node[op->src];
  const MpmRank  to = b->formulation->particle_ranks[op->dst], from = b->formulation->node_ranks[op->src];

  PetscFunctionBegin;
  if (dim == 1)
    PetscCall(MpmBuilderTerm(b, op, dst, src, 0, 1, PETSC_TRUE));
  else if (to == MPM_TENSOR && from == MPM_VECTOR)
    PetscCall(GradToStress(b, op));
  else {
    PetscCheck((to == MPM_VECTOR && from == MPM_SCALAR) || (to == MPM_SCALAR && from == MPM_VECTOR), PETSC_COMM_SELF,
               PETSC_ERR_SUP, "the table: GRAD makes a stress or a number of a vector, and a vector of a number");
    for (PetscInt a = 0; a < dim; a++)
      PetscCall(MpmBuilderTerm(b, op, dst + (to == MPM_VECTOR ? a : 0), src + (from == MPM_VECTOR ? a : 0), a, 1,
                               PETSC_TRUE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sum of the second differences over the directions. */
static PetscErrorCode Lap(MpmTableBuilder *b, const MpmOp *op)
{
  MpmOp one = *op;

  PetscFunctionBegin;
  for (PetscInt axis = 0; axis < b->space->dim; axis++) {
    one.axis = axis;
    PetscCall(Each(b, &one));
    one.accumulates = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- IMPLICIT ---- */

/* The stress of a formulation that IMPLICIT is of, or MPM_NONE. */
static PetscInt StressOf(const MpmTableBuilder *b)
{
  const MpmFormulation *f     = b->formulation;
  PetscInt              first = MPM_NONE;

  for (PetscInt field = 0; f->particle_fields[field]; field++)
    if (MpmBuilderIsAhead(b, field) || (f->particle_ranks[field] == MPM_TENSOR && first == MPM_NONE)) first = field;
  return first;
}

/* Sets components of a vector to 0 at all ends that fix them. */
static PetscErrorCode Fix(MpmTableBuilder *b, PetscInt first, PetscInt n)
{
  PetscFunctionBegin;
  for (PetscInt c = 0; c < n; c++) {
    PetscCall(MpmTableImpose(b->table, first + c));
    PetscCall(MpmBuilderImposeWithReaction(b, first + c, PETSC_FALSE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The lines of K = DIV STRESS GRAD of a node field: those of a builder whose stress is scratch, and whose force is
   image.
*/
static PetscErrorCode StiffnessLines(MpmTableBuilder b, PetscInt field, PetscInt stress, PetscInt image)
{
  const MpmTransfer plain = {.name = b.transfer->name}; /* K is that of the grid, which no transfer has sharpened */
  MpmSpace          space = *b.space;
  const PetscInt    n     = MpmBuilderComponents(&b, PETSC_FALSE, stress);

  PetscFunctionBegin;
  space.displaced = PETSC_FALSE;
  b.space         = &space;
  b.transfer      = &plain;
  PetscCall(MpmBuilderScratches(b.table, n, &b.particle[stress]));
  PetscCall(MpmBuilderClear(b.table, n, b.particle[stress]));
  PetscCall(Grad(&b, &(MpmOp)GRAD(stress, field, ONE)));
  b.node[field] = image;
  PetscCall(Div(&b, &(MpmOp){.kind = MPM_DIV, .dst = field, .src = stress, .factor = 1}));
  PetscCall(Fix(&b, image, space.dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the table of K of a node field. Its registers are those of the table when that is complete (MpmTableCreate). */
static PetscErrorCode AddStiffness(MpmTableBuilder *b, PetscInt field, PetscInt stress)
{
  MpmTable      *t    = b->table, *k;
  const MpmTable kept = *t;
  PetscInt       image;

  PetscFunctionBegin;
  MpmCheckInput(t->nstiff < MPM_MAX_STIFF, "%s: more than %d fields are IMPLICIT; allowed: fewer", t->where,
                MPM_MAX_STIFF);
  PetscCall(MpmBuilderNodes(t, b->node[field], t->dim, &image));
  PetscCall(PetscNew(&k));
  t->ops  = NULL;
  t->nops = t->room = 0;
  if (b->space->finite) {
    PetscCall(MpmFiniteAhead(b, field, image));
    PetscCall(Fix(b, image, t->dim));
  } else
    PetscCall(StiffnessLines(*b, field, stress, image));
  *k = (MpmTable){
      .nops = t->nops, .ops = t->ops, .solved = b->node[field], .image = image, .start = b->start, .theta = b->ahead};
  t->ops                = kept.ops;
  t->nops               = kept.nops;
  t->room               = kept.room;
  t->stiff[t->nstiff++] = k;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The tables of K share the registers of the table, and all that it says of them. */
static void CompleteStiffness(MpmTable *t)
{
  for (PetscInt i = 0; i < t->nstiff; i++) {
    MpmTable *k = t->stiff[i], own = *k;

    *k        = *t;
    k->nops   = own.nops;
    k->ops    = own.ops;
    k->solved = own.solved;
    k->image  = own.image;
    k->start  = own.start;
    k->theta  = own.theta;
    k->nstiff = 0;
  }
}

const MpmTable *MpmTableStiffness(const MpmTable *t, const MpmOp *implicit)
{
  PetscInt i = 0;

  while (i < t->nstiff - 1 && implicit->dst - implicit->axis != t->stiff[i]->solved) i++;
  return t->stiff[i];
}

static PetscErrorCode Implicit(MpmTableBuilder *b, const MpmOp *op)
{
  const PetscInt stress = StressOf(b);
  MpmTable      *t      = b->table;
  MpmOp          one    = *op;

  PetscFunctionBegin;
  PetscCheck(stress != MPM_NONE && b->formulation->node_ranks[op->dst] == MPM_VECTOR && op->dst == op->src,
             PETSC_COMM_SELF, PETSC_ERR_SUP, "the table: IMPLICIT is of a vector, in a formulation with a stress");
  if (!t->nstiff || MpmTableStiffness(t, &(MpmOp){.dst = b->node[op->dst]})->solved != b->node[op->dst])
    PetscCall(AddStiffness(b, op->dst, stress));
  PetscCall(Fix(b, b->node[op->dst], t->dim));
  for (one.axis = 0; one.axis < t->dim; one.axis++) {
    one.dst = one.src = b->node[op->dst] + one.axis;
    PetscCall(MpmTableAppendOwn(t, one));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool HasField(const MpmTableBuilder *b, MpmPlace place, PetscInt field)
{
  const char *const *names = place == MPM_ON_NODES ? b->formulation->node_fields : b->formulation->particle_fields;
  PetscInt           n     = 0;

  while (names[n]) n++;
  return place == MPM_NOWHERE || (field >= 0 && field < n) ? PETSC_TRUE : PETSC_FALSE;
}

static PetscErrorCode Expand(MpmTableBuilder *b, const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  PetscFunctionBegin;
  PetscCheck(HasField(b, traits.dst, op->dst) && HasField(b, traits.src, op->src), PETSC_COMM_SELF, PETSC_ERR_SUP,
             "the table: an operation on a field that does not exist");
  PetscCheck(op->axis == 0, PETSC_COMM_SELF, PETSC_ERR_SUP, "the table: formulations name no axis");
  if (op->kind == MPM_DIV && b->space->finite)
    PetscCall(MpmFiniteDiv(b, op));
  else if (b->space->finite && traits.dst == MPM_ON_PARTICLES && b->formulation->particle_ranks[op->dst] == MPM_TENSOR)
    PetscCall(MpmFiniteSet(b, op));
  else if (op->kind == MPM_ADD && op->dst != op->src && MpmBuilderIsAhead(b, op->dst))
    PetscCall(AheadFrom(b, op));
  else if (op->kind == MPM_DIV)
    PetscCall(Div(b, op));
  else if (op->kind == MPM_GRAD)
    PetscCall(Grad(b, op));
  else if (op->kind == MPM_LAP)
    PetscCall(Lap(b, op));
  else if (op->kind == MPM_IMPLICIT)
    PetscCall(Implicit(b, op));
  else
    PetscCall(Each(b, op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a node register holds P2G of a particle register as it is now, with its affine part and its walls. */
static PetscBool Holds(const MpmTable *t, PetscInt node, PetscInt particle)
{
  PetscBool holds = PETSC_FALSE;

  for (PetscInt o = 0; o < t->nops; o++) {
    const MpmOp   *op = &t->ops[o];
    const MpmPlace to = MpmOpTraitsOf(op->kind).dst;

    if (op->kind == MPM_P2G_AFFINE || (op->kind == MPM_WALL && op->factor == 0)) continue;
    if (to == MPM_ON_NODES && op->dst == node)
      holds = op->kind == MPM_P2G && op->src == particle && !op->accumulates && !op->coefficient && op->factor == 1;
    if (to == MPM_ON_PARTICLES && op->dst == particle) holds = PETSC_FALSE;
  }
  return holds;
}

/* Whether an operation is a filter that acts in the space. */
static PetscBool IsFilter(const MpmTableBuilder *b, const MpmOp *op)
{
  const MpmFilterTime at = b->space->filter;

  return op->kind == MPM_FILTER || (op->kind == MPM_FILTER_BEFORE && at == MPM_FILTERS_BEFORE) ||
                 (op->kind == MPM_FILTER_AFTER && at == MPM_FILTERS_AFTER)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* A filter needs P2G of its field. Where the nodes do not hold it, one is added. */
static PetscErrorCode Filter(MpmTableBuilder *b, const MpmOp *op)
{
  MpmTable      *t     = b->table;
  const PetscInt first = b->particle[op->dst], node = b->node[op->src],
                 n = MpmBuilderComponents(b, PETSC_TRUE, op->src);

  PetscFunctionBegin;
  if (!b->transfer->filter) PetscFunctionReturn(PETSC_SUCCESS);
  if (!Holds(t, node, first)) {
    PetscCall(Each(b, &(MpmOp)P2G(op->src, op->dst)));
    for (PetscInt c = 0; c < n; c++) PetscCall(MpmTableImpose(t, node + c));
  }
  for (PetscInt c = 0; c < n; c++) {
    const PetscInt before = t->nops;

    PetscCall(b->transfer->filter(t, b->numbers, first + c, node + c));
    if (!Writes(t, before, MPM_ON_PARTICLES, first + c)) continue;
    t->filtered[first + c] = PETSC_TRUE;
    t->unfiltered--;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a later REACT uses the value of a node field from before the wall. */
static PetscBool IsKept(const MpmFormulation *f, PetscInt node)
{
  for (PetscInt o = 0; o < f->nops; o++)
    if (f->ops[o].kind == MPM_REACT && f->ops[o].src == node) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscBool IsGradOf(const MpmOp *op, PetscInt particle)
{
  return op->kind == MPM_GRAD && op->dst == particle ? PETSC_TRUE : PETSC_FALSE;
}

/*
   Where a scratch field begins: what a transfer makes of the nodes that the next lines send to particles comes before
   it, since scratch lives for one pass over the particles.
*/
static PetscErrorCode SharpenBefore(MpmTableBuilder *b, PetscInt o)
{
  const MpmFormulation *f = b->formulation;

  PetscFunctionBegin;
  if (f->ops[o].kind != MPM_SCALE || !f->scratch[f->ops[o].dst]) PetscFunctionReturn(PETSC_SUCCESS);
  for (; o < f->nops && f->ops[o].kind < MPM_OP_KINDS && MpmOpTraitsOf(f->ops[o].kind).dst == MPM_ON_PARTICLES; o++)
    if (MpmOpTraitsOf(f->ops[o].kind).src == MPM_ON_NODES)
      PetscCall(MpmBuilderSharpenAll(b, b->node[f->ops[o].src], MpmBuilderComponents(b, PETSC_TRUE, f->ops[o].src)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode React(MpmTableBuilder *b, PetscInt o)
{
  const MpmOp *op = &b->formulation->ops[o];

  PetscFunctionBegin;
  PetscCall(MpmBuilderCollideAgain(b, o));
  for (PetscInt c = 0; c < MpmBuilderComponents(b, PETSC_TRUE, op->dst); c++)
    PetscCall(MpmBuilderReact(b, b->node[op->dst] + c, b->node[op->src] + c));
  PetscCall(MpmBuilderGiveLost(b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A wall with a reaction is imposed after the filter, because the filter must act on the values before the wall. */
static PetscErrorCode Translate(MpmTableBuilder *b)
{
  const MpmFormulation *f = b->formulation;

  PetscFunctionBegin;
  for (PetscInt o = 0; o < f->nops; o++) {
    const MpmOp    *op = &f->ops[o];
    const PetscBool filtered =
        o + 1 < f->nops && IsFilter(b, &op[1]) && op[1].src == op->dst ? PETSC_TRUE : PETSC_FALSE;

    if (b->space->finite) PetscCall(MpmFiniteBefore(b, op));
    PetscCall(SharpenBefore(b, o));
    PetscCall(MpmDampingBefore(b, o));
    if (op->kind == MPM_IMPOSE) {
      const PetscInt n = MpmBuilderComponents(b, PETSC_TRUE, op->dst);

      for (PetscInt c = 0; c < n; c++) PetscCall(MpmTableImpose(b->table, b->node[op->dst] + c));
      if (filtered) PetscCall(Filter(b, &f->ops[++o]));
      for (PetscInt c = 0; c < n; c++)
        PetscCall(MpmBuilderImposeWithReaction(b, b->node[op->dst] + c, IsKept(f, op->dst)));
      PetscCall(MpmBuilderCollide(b, (PetscInt)(op - f->ops)));
      if (b->space->collides) PetscCall(Fix(b, b->node[op->dst], n)); /* bodies do not move walls */
    } else if (IsFilter(b, op))
      PetscCall(Filter(b, op));
    else if (op->kind == MPM_FILTER_BEFORE || op->kind == MPM_FILTER_AFTER)
      continue; /* the filter acts in the other place */
    else if (b->space->finite && op->kind == MPM_GRAD)
      PetscCall(
          MpmFiniteGrad(b, op, o == 0 || !IsGradOf(&op[-1], op->dst), o + 1 == f->nops || !IsGradOf(&op[1], op->dst)));
    else if (b->space->finite && op->kind == MPM_DRIFT)
      PetscCall(MpmFiniteGo(b, b->velocity, 1));
    else if (op->kind == MPM_MOVE || op->kind == MPM_MOVE_PROJECTED)
      PetscCall(Move(b, op));
    else if (op->kind == MPM_MOVE_TO)
      PetscCall(MpmFiniteMoveTo(b, op));
    else if (op->kind == MPM_REACT)
      PetscCall(React(b, o));
    else
      PetscCall(Expand(b, op));
    PetscCall(MpmDampingAfter(b, o));
    if (b->space->finite) PetscCall(MpmFiniteAfter(b, o));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the table ---- */

PetscErrorCode MpmTableCreate(const MpmFormulation *formulation, const MpmTransfer *transfer,
                              const MpmSchemeNumbers *numbers, const MpmSpace *space, MpmTable **table)
{
  MpmFormulation  written = *formulation;
  MpmOp           lines[MPM_MOST_TABLE_LINES];
  MpmTableBuilder b = {.formulation = &written,
                       .transfer    = transfer,
                       .numbers     = numbers,
                       .space       = space,
                       .viscous     = MPM_NONE,
                       .rate        = MPM_NONE};
  MpmTable       *t;

  PetscFunctionBegin;
  PetscCall(PetscNew(table));
  t           = *table;
  b.table     = t;
  t->dim      = space->dim;
  written.ops = MpmFormulationLines(formulation, numbers, transfer, lines, &written.nops);
  if (formulation->written) /* what messages call it: it stands in a line of a file */
    (void)snprintf(t->where, sizeof t->where, "%.400s:%d: scheme %.60s", formulation->written->file,
                   formulation->written->line, formulation->name);
  else
    PetscCall(PetscSNPrintf(t->where, sizeof t->where, "formulation %s", formulation->name));
  t->transfer = transfer;
  b.trial = b.lost = b.lost_by = MPM_NONE;
  for (PetscInt n = 0; n < MPM_MAX_FIELDS; n++) b.kept[n] = b.sharp[n] = MPM_NONE;
  PetscCall(PetscArraycpy(&t->ends[0][0], &space->ends[0][0], 2 * MPM_MAX_DIM));
  PetscCall(MpmBuilderAddRegisters(&b));
  if (space->finite) PetscCall(MpmFinitePlan(&b));
  PetscCall(Translate(&b));
  CompleteStiffness(t);
  PetscCall(MpmTableCheck(t));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTableDestroy(MpmTable **table)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; *table && i < (*table)->nstiff; i++) PetscCall(MpmTableDestroy(&(*table)->stiff[i]));
  if (*table) PetscCall(PetscFree((*table)->ops));
  PetscCall(PetscFree(*table));
  PetscFunctionReturn(PETSC_SUCCESS);
}
