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

PetscErrorCode MpmBuilderAppend(MpmTableBuilder *b, MpmOp op)
{
  PetscFunctionBegin;
  if (MpmOpIsGather(&op)) PetscCall(MpmBuilderSharpen(b, op.src, &op.src));
  PetscCall(MpmTableAppend(b->table, op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the operations of formulations, written out for components ---- */

static PetscInt RegisterOf(const MpmTableBuilder *b, PetscBool on_nodes, PetscInt field)
{
  return on_nodes ? b->node[field] : b->particle[field];
}

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
    one.dst = RegisterOf(b, to, op->dst) + c;
    one.src = RegisterOf(b, from, op->src) + c;
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

static PetscErrorCode Div(MpmTableBuilder *b, const MpmOp *op)
{
  const PetscInt  dim = b->space->dim, dst = b->node[op->dst], src = b->particle[op->src];
  const MpmRank   to = b->formulation->node_ranks[op->dst], from = b->formulation->particle_ranks[op->src];
  const PetscReal stiffness   = IsOneNumber(b->space) ? 1 + b->space->prestress[0] : 1;
  PetscBool       accumulates = op->accumulates;

  PetscFunctionBegin;
  PetscCheck(dim == 1 || (to == MPM_VECTOR && from != MPM_VECTOR) || (to == MPM_SCALAR && from == MPM_VECTOR),
             PETSC_COMM_SELF, PETSC_ERR_SUP,
             "the table: DIV makes a vector of a stress or a number, and a number of a vector");
  if (MpmBuilderIsAhead(b, op->src)) {
    for (PetscInt a = 0; a < dim; a++) {
      for (PetscInt axis = 0; axis < dim; axis++)
        PetscCall(MpmBuilderTerm(b, op, dst + a, src + dim * a + axis, axis, 1, axis ? PETSC_TRUE : op->accumulates));
      PetscCall(Curve(b, op, a));
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (from != MPM_TENSOR) {
    for (PetscInt a = 0; a < dim; a++) {
      PetscCall(MpmBuilderTerm(b, op, dst + (to == MPM_VECTOR ? a : 0), src + (from == MPM_VECTOR ? a : 0), a, 1,
                               accumulates));
      if (to != MPM_VECTOR) accumulates = PETSC_TRUE;
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt a = 0; a < dim; a++) {
    accumulates = op->accumulates;

    for (PetscInt axis = 0; axis < dim; axis++) {
      const PetscInt component = MpmSpaceStress(b->space, a, axis);

      if (component == MPM_NONE) continue;
      PetscCall(MpmBuilderTerm(b, op, dst + a, src + component, axis, stiffness, accumulates));
      accumulates = PETSC_TRUE;
    }
    PetscCall(Curve(b, op, a));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* s_ab += (c_abcd + d_ac sigma0_db + sigma0_ad d_bc) GRAD_d v_c */
static PetscErrorCode GradToPrestressed(MpmTableBuilder *b, const MpmOp *op)
{
  const PetscInt dim = b->space->dim, s = b->particle[op->dst], v = b->node[op->src];

  PetscFunctionBegin;
  for (PetscInt i = 0; i < dim; i++)
    for (PetscInt j = i; j < dim; j++)
      for (PetscInt c = 0; c < dim; c++)
        for (PetscInt d = 0; d < dim; d++) {
          const PetscReal tangent = MpmSpaceTangent(b->space, i, j, c, d);

          if (tangent != 0)
            PetscCall(MpmBuilderTerm(b, op, s + MpmSpaceStress(b->space, i, j), v + c, d, tangent, PETSC_TRUE));
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

/* q_ab += (ds_ab / d (dv_c/dx_d) - sigma0_ad d_bc) GRAD_d v_c: dT = dtau - tau L^T */
static PetscErrorCode GradAhead(MpmTableBuilder *b, const MpmOp *op)
{
  const PetscInt dim = b->space->dim, q = b->particle[op->dst], v = b->node[op->src];

  PetscFunctionBegin;
  for (PetscInt i = 0; i < dim * dim * dim * dim; i++) {
    const PetscInt  a = i / dim / dim / dim, e = i / dim / dim % dim, c = i / dim % dim, d = i % dim;
    const PetscReal tangent = MpmSpaceTangent(b->space, a, e, c, d) - (e == c ? MpmSpacePrestress(b->space, a, d) : 0);

    if (tangent != 0) PetscCall(MpmBuilderTerm(b, op, q + dim * a + e, v + c, d, tangent, PETSC_TRUE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   s_ab += lambda delta_ab sum_c GRAD_c v_c + mu (GRAD_b v_a + GRAD_a v_b), with lambda + 2 mu = 1, or with the moduli of
   each particle.
*/
static PetscErrorCode GradToStress(MpmTableBuilder *b, const MpmOp *op)
{
  const PetscInt  dim = b->space->dim, s = b->particle[op->dst], v = b->node[op->src];
  const PetscReal nu = b->space->poisson, lambda = nu / (1 - nu), mu = (1 - 2 * nu) / (2 * (1 - nu));
  MpmOp           of_lambda = *op, of_mu = *op;

  PetscFunctionBegin;
  if (MpmSpaceIsFluid(b->space)) {
    for (PetscInt a = 0; a < dim; a++) PetscCall(MpmBuilderTerm(b, op, s, v + a, a, 1, PETSC_TRUE));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (MpmSpaceIsPrestressed(b->space)) {
    PetscCall(GradToPrestressed(b, op));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (b->space->lames) {
    of_lambda.side = MPM_LAMBDA - MPM_STIFFNESS;
    of_mu.side     = MPM_SHEAR - MPM_STIFFNESS;
  } else {
    of_lambda.factor *= lambda;
    of_mu.factor *= mu;
  }
  for (PetscInt a = 0; a < dim; a++) {
    for (PetscInt c = 0; c < dim; c++)
      if (c == a || of_lambda.factor != 0)
        PetscCall(
            MpmBuilderTerm(b, c == a ? op : &of_lambda, s + MpmSpaceStress(b->space, a, a), v + c, c, 1, PETSC_TRUE));
    for (PetscInt c = a + 1; c < dim; c++) {
      PetscCall(MpmBuilderTerm(b, &of_mu, s + MpmSpaceStress(b->space, a, c), v + a, c, 1, PETSC_TRUE));
      PetscCall(MpmBuilderTerm(b, &of_mu, s + MpmSpaceStress(b->space, a, c), v + c, a, 1, PETSC_TRUE));
    }
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
  else if (MpmBuilderIsAhead(b, op->dst))
    PetscCall(GradAhead(b, op));
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

  for (PetscInt field = 0; f->particle_fields[field]; field++) {
    if (MpmBuilderIsAhead(b, field)) return field;
    if (f->particle_ranks[field] == MPM_TENSOR && first == MPM_NONE) first = field;
  }
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
  PetscInt          scratch;

  PetscFunctionBegin;
  space.displaced = PETSC_FALSE;
  b.space         = &space;
  b.transfer      = &plain;
  for (PetscInt c = 0; c < n; c++) {
    PetscCall(MpmTableScratch(b.table, &scratch));
    if (c == 0) b.particle[stress] = scratch;
    PetscCall(MpmTableAppendOwn(b.table, (MpmOp)SCALE(scratch, 0)));
  }
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
  PetscInt       image, node;

  PetscFunctionBegin;
  MpmCheckInput(t->nstiff < MPM_MAX_STIFF, "%s: more than %d fields are IMPLICIT; allowed: fewer", t->where,
                MPM_MAX_STIFF);
  PetscCall(MpmTableNode(t, b->node[field], &image));
  for (PetscInt c = 1; c < t->dim; c++) PetscCall(MpmTableNode(t, b->node[field] + c, &node));
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
    const MpmTable own = *t->stiff[i];

    *t->stiff[i]        = *t;
    t->stiff[i]->nops   = own.nops;
    t->stiff[i]->ops    = own.ops;
    t->stiff[i]->solved = own.solved;
    t->stiff[i]->image  = own.image;
    t->stiff[i]->start  = own.start;
    t->stiff[i]->theta  = own.theta;
    t->stiff[i]->nstiff = 0;
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

  if (place == MPM_NOWHERE) return PETSC_TRUE;
  for (PetscInt f = 0; names[f]; f++)
    if (f == field) return PETSC_TRUE;
  return PETSC_FALSE;
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
    for (PetscInt c = 0;
         MpmOpTraitsOf(f->ops[o].kind).src == MPM_ON_NODES && c < MpmBuilderComponents(b, PETSC_TRUE, f->ops[o].src);
         c++) {
      PetscInt sharp;

      PetscCall(MpmBuilderSharpen(b, b->node[f->ops[o].src] + c, &sharp));
    }
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
      PetscCall(MpmFiniteMove(b));
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

/* Refuses a written scheme with more operations on nodes in a row than march has room for. */
static PetscErrorCode CheckRuns(const MpmTable *t)
{
  PetscInt run = 0;

  PetscFunctionBegin;
  for (PetscInt o = 0; o < t->nops; o++) {
    const MpmOpTraits traits = MpmOpTraitsOf(t->ops[o].kind);

    run = traits.dst == MPM_ON_NODES && traits.src == MPM_ON_NODES ? run + 1 : 0;
    MpmCheckInput(run <= MPM_MAX_NODE_OPS,
                  "%s: more than %d operations on nodes follow one another, with dim %" PetscInt_FMT
                  "; allowed: fewer lines or dimensions",
                  t->where, MPM_MAX_NODE_OPS, t->dim);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What messages call a formulation: a written scheme stands in a line of a file. */
static PetscErrorCode WhereOf(const MpmFormulation *f, size_t room, char where[])
{
  PetscFunctionBegin;
  if (f->written)
    (void)snprintf(where, room, "%.400s:%d: scheme %.60s", f->written->file, f->written->line, f->name);
  else
    PetscCall(PetscSNPrintf(where, room, "formulation %s", f->name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
  PetscCall(WhereOf(formulation, sizeof t->where, t->where));
  t->transfer = transfer;
  b.trial = b.lost = b.lost_by = MPM_NONE;
  for (PetscInt n = 0; n < MPM_MAX_FIELDS; n++) b.kept[n] = b.sharp[n] = MPM_NONE;
  PetscCall(PetscArraycpy(&t->ends[0][0], &space->ends[0][0], 2 * MPM_MAX_DIM));
  PetscCall(MpmBuilderAddRegisters(&b));
  if (space->finite) PetscCall(MpmFinitePlan(&b));
  PetscCall(Translate(&b));
  CompleteStiffness(t);
  PetscCall(CheckRuns(t));
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

PetscErrorCode MpmTableRequireLinear(const MpmTable *table)
{
  PetscFunctionBegin;
  MpmCheckInput(!MpmTableIsFinite(table),
                "kinematics finite: the step is not linear, so that it has no operator and no "
                "symbol; allowed: kinematics linear");
  MpmCheckInput(
      !MpmTableHas(table, MPM_LOCAL),
      "local_damping: the force that it takes off turns with the sign of a velocity, so that the step has no operator, "
      "no symbol and no limit; allowed: task run, or grid_damping");
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

const MpmParity *MpmTableParity(const MpmTable *table, PetscInt field)
{
  static const MpmParity even[MPM_MAX_DIM] = {MPM_EVEN, MPM_EVEN, MPM_EVEN};
  const MpmOp           *seen              = MpmTableSeenBy(table, field);

  return seen && seen->kind == MPM_P2G ? table->parity[seen->dst] : even;
}

PetscBool MpmTableHas(const MpmTable *table, MpmOpKind kind)
{
  for (PetscInt o = 0; o < table->nops; o++)
    if (table->ops[o].kind == kind) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscBool MpmTableSolves(const MpmTable *table)
{
  return MpmTableHas(table, MPM_SOLVE) || MpmTableHas(table, MPM_IMPLICIT) ? PETSC_TRUE : PETSC_FALSE;
}
