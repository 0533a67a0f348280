/*
   MpmTableCreate makes a table from a formulation, a transfer and a space, and checks it. It writes the operations on
   scalars, vectors and stresses out as operations on numbers, so that those who interpret a table know only numbers.
*/
#include "scheme/language.h"
#include "scheme/table_check.h"
#include <mpmstab/errors.h>

const char *const MpmGradientNames[]   = {"basis", "mls", NULL};
const char *const MpmFilterTimeNames[] = {"after", "before", NULL};
const char *const MpmMoveNames[]       = {"grid", "projected", NULL};

/*
   What MpmTableCreate needs while it makes a table. particle[f] and node[n] are the first registers of the formulation's
   fields. kept[n]: the node register with the values of node register n from before the wall, or MPM_NONE. sharp[n]: the
   node register that particles take instead of node register n, as it was when the table had sharp_at[n] operations.
*/
typedef struct {
  const MpmFormulation     *formulation;
  const MpmTransfer        *transfer;
  const MpmTransferNumbers *numbers;
  const MpmSpace           *space;
  PetscInt                  particle[MPM_MAX_FIELDS], node[MPM_MAX_FIELDS], kept[MPM_MAX_FIELDS], sharp[MPM_MAX_FIELDS],
      sharp_at[MPM_MAX_FIELDS];
  MpmTable *table;
} Builder;

/* ---- fields and their components ---- */

static PetscInt Components(const MpmSpace *space, MpmRank rank)
{
  if (rank == MPM_VECTOR) return space->dim;
  return rank == MPM_TENSOR && !MpmSpaceIsFluid(space) ? space->dim * (space->dim + 1) / 2 : 1;
}

/* The component ab of a stress, or MPM_NONE: the stress of a fluid has only a diagonal, which is one number. */
static PetscInt Stress(const MpmSpace *space, PetscInt a, PetscInt b)
{
  const PetscInt least = PetscMin(a, b), most = PetscMax(a, b);

  if (MpmSpaceIsFluid(space)) return a == b ? 0 : MPM_NONE;
  return least * space->dim - least * (least - 1) / 2 + most - least;
}

PetscErrorCode MpmTableAppendOwn(MpmTable *t, MpmOp op)
{
  PetscFunctionBegin;
  if (t->nops == t->room) {
    t->room = PetscMax(32, 2 * t->room);
    PetscCall(PetscRealloc(sizeof(*t->ops) * (size_t)t->room, &t->ops));
  }
  t->ops[t->nops++] = op;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsAffine(const MpmTable *t, PetscInt particle)
{
  return particle >= t->affine && particle < t->affine + t->dim ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmTableAppendAffine(MpmTable *t, MpmOp op)
{
  const MpmOp of = op;

  PetscFunctionBegin;
  for (PetscInt axis = 0; axis < t->dim; axis++) {
    op.axis = axis;
    if (of.kind == MPM_P2G && IsAffine(t, of.src)) {
      op.kind        = MPM_P2G_AFFINE;
      op.src         = t->affine_part + t->dim * (of.src - t->affine) + axis;
      op.accumulates = PETSC_TRUE;
    } else if (of.kind == MPM_G2P && IsAffine(t, of.dst)) {
      op.kind = t->affine_map;
      op.dst  = t->affine_part + t->dim * (of.dst - t->affine) + axis;
    } else if ((of.kind == MPM_SCALE || of.kind == MPM_ADD) && of.dst == of.src && IsAffine(t, of.dst)) {
      op.dst = op.src = t->affine_part + t->dim * (of.dst - t->affine) + axis;
      op.axis         = 0;
    } else
      PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(MpmTableAppendOwn(t, op));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTableAppend(MpmTable *t, MpmOp op)
{
  PetscFunctionBegin;
  PetscCall(MpmTableAppendOwn(t, op));
  if (t->affine != MPM_NONE) PetscCall(MpmTableAppendAffine(t, op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses a written scheme that needs more registers than there are. Those of the program fit. */
static PetscErrorCode CheckRoom(const MpmTable *t, PetscInt used, const char place[])
{
  PetscFunctionBegin;
  MpmCheckInput(used < MPM_MAX_FIELDS,
                "%s: more than the %d numbers that fit at a %s, with dim %" PetscInt_FMT
                " and transfer %s; allowed: fewer fields, dimensions or terms of xpic",
                t->where, MPM_MAX_FIELDS, place, t->dim, t->transfer->name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTableNode(MpmTable *t, PetscInt like, PetscInt *node)
{
  PetscFunctionBegin;
  PetscCall(CheckRoom(t, t->nnodes, "node"));
  *node = t->nnodes++;
  PetscCall(PetscArraycpy(t->parity[*node], t->parity[like], MPM_MAX_DIM));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTableScratch(MpmTable *t, PetscInt *particle)
{
  PetscFunctionBegin;
  PetscCall(CheckRoom(t, t->nparticles, "particle"));
  *particle = t->nparticles++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- walls ---- */

static PetscErrorCode Wall(MpmTable *t, PetscInt axis, PetscInt end, PetscInt dst, PetscInt src, PetscReal factor)
{
  PetscFunctionBegin;
  PetscCall(MpmTableAppendOwn(
      t, (MpmOp){.kind = MPM_WALL, .axis = axis, .dst = dst, .src = src, .factor = factor, .side = end}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTableImpose(MpmTable *t, PetscInt node)
{
  PetscFunctionBegin;
  for (PetscInt axis = 0; axis < t->dim; axis++)
    for (PetscInt end = 0; end < 2; end++)
      if (MpmEndImposes(t->ends[axis][end], t->parity[node][axis])) PetscCall(Wall(t, axis, end, node, node, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keeps the values of a node register at all ends with a reaction. */
static PetscErrorCode Keep(Builder *b, PetscInt node)
{
  MpmTable *t = b->table;

  PetscFunctionBegin;
  PetscCall(MpmTableNode(t, node, &b->kept[node]));
  for (PetscInt axis = 0; axis < t->dim; axis++)
    for (PetscInt end = 0; end < 2; end++)
      if (t->ends[axis][end] == MPM_FIXED_REACTION) PetscCall(Wall(t, axis, end, b->kept[node], node, 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Sets a node register to 0 at ends with a reaction. If a later REACT uses it (wanted), its value before the wall is kept
   in another node register, the first time that the wall is imposed in the step.
*/
static PetscErrorCode ImposeWithReaction(Builder *b, PetscInt node, PetscBool wanted)
{
  MpmTable *t = b->table;

  PetscFunctionBegin;
  for (PetscInt axis = 0; axis < t->dim; axis++) {
    for (PetscInt end = 0; end < 2; end++) {
      if (t->ends[axis][end] != MPM_FIXED_REACTION) continue;
      if (wanted && b->kept[node] == MPM_NONE) PetscCall(Keep(b, node));
      PetscCall(Wall(t, axis, end, node, node, 0));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode React(Builder *b, PetscInt dst, PetscInt imposed)
{
  const MpmTable *t = b->table;

  PetscFunctionBegin;
  for (PetscInt axis = 0; axis < t->dim; axis++) {
    for (PetscInt end = 0; end < 2; end++) {
      if (MpmEndImposes(t->ends[axis][end], t->parity[dst][axis])) PetscCall(Wall(b->table, axis, end, dst, dst, 0));
      if (t->ends[axis][end] == MPM_FIXED_REACTION) PetscCall(Wall(b->table, axis, end, dst, b->kept[imposed], -1));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what particles take from nodes ---- */

/* Whether an operation from number first on, but a WALL, writes to a register at a place. */
static PetscBool IsWritten(const MpmTable *t, PetscInt first, MpmPlace place, PetscInt reg)
{
  for (PetscInt o = first; o < t->nops; o++)
    if (t->ops[o].kind != MPM_WALL && MpmOpTraitsOf(t->ops[o].kind).dst == place && t->ops[o].dst == reg)
      return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Appends an operation. Where it goes from nodes to particles, it reads what the transfer's sharpen makes of the nodes. */
static PetscErrorCode Append(Builder *b, MpmOp op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op.kind);
  const PetscInt    n      = op.src;

  PetscFunctionBegin;
  if (b->transfer->sharpen && traits.src == MPM_ON_NODES && traits.dst == MPM_ON_PARTICLES) {
    if (b->sharp[n] == MPM_NONE || IsWritten(b->table, b->sharp_at[n], MPM_ON_NODES, n)) {
      b->sharp_at[n] = b->table->nops;
      PetscCall(b->transfer->sharpen(b->table, b->numbers, n, &b->sharp[n]));
    }
    op.src = b->sharp[n];
  }
  PetscCall(MpmTableAppend(b->table, op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the operations of formulations, written out for components ---- */

static PetscInt ComponentsOf(const Builder *b, PetscBool on_nodes, PetscInt field)
{
  return Components(b->space, on_nodes ? b->formulation->node_ranks[field] : b->formulation->particle_ranks[field]);
}

static PetscInt RegisterOf(const Builder *b, PetscBool on_nodes, PetscInt field)
{
  return on_nodes ? b->node[field] : b->particle[field];
}

/* An operation between fields of one rank: one on each component. */
static PetscErrorCode Each(Builder *b, const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const PetscBool   to     = traits.dst == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE,
                  from     = traits.src == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE;
  MpmOp one                = *op;

  PetscFunctionBegin;
  if (traits.dst == MPM_NOWHERE) {
    PetscCall(Append(b, *op));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheck(ComponentsOf(b, to, op->dst) == ComponentsOf(b, from, op->src), PETSC_COMM_SELF, PETSC_ERR_SUP,
             "the table: fields of different ranks, in an operation that acts on each component");
  for (PetscInt c = 0; c < ComponentsOf(b, to, op->dst); c++) {
    one.dst = RegisterOf(b, to, op->dst) + c;
    one.src = RegisterOf(b, from, op->src) + c;
    PetscCall(Append(b, one));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A term of DIV or GRAD: along one axis, with the weights of the space's gradient. */
static PetscErrorCode Term(Builder *b, const MpmOp *op, PetscInt dst, PetscInt src, PetscInt axis, PetscReal factor,
                           PetscBool accumulates)
{
  const PetscBool mls = b->space->gradient == MPM_GRADIENT_MLS ? PETSC_TRUE : PETSC_FALSE;
  MpmOp           one = *op;

  PetscFunctionBegin;
  if (mls && op->kind == MPM_DIV) one.kind = MPM_DIV_MLS;
  if (mls && op->kind == MPM_GRAD) one.kind = MPM_GRAD_MLS;
  if (mls && op->kind == MPM_CURVE) one.kind = MPM_CURVE_MLS;
  one.dst         = dst;
  one.src         = src;
  one.axis        = axis;
  one.factor      = op->factor * factor;
  one.accumulates = accumulates;
  PetscCall(Append(b, one));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The force of a prestress on displaced particles, in one dimension: s0 CURVE x. */
static PetscErrorCode Curve(Builder *b, const MpmOp *div)
{
  MpmOp op = *div;

  PetscFunctionBegin;
  if (!b->space->displaced) PetscFunctionReturn(PETSC_SUCCESS);
  op.kind = MPM_CURVE;
  PetscCall(Term(b, &op, b->node[div->dst], b->table->displacement, 0, b->space->prestress, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* x += k G2P of each component of a velocity of the grid. */
static PetscErrorCode Move(Builder *b, const MpmOp *op)
{
  const PetscBool projected = op->kind == MPM_MOVE_PROJECTED ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  if (!b->space->displaced || projected != (b->space->move == MPM_MOVES_PROJECTED)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < b->space->dim; a++)
    PetscCall(Append(b, (MpmOp)G2P(b->table->displacement + a, b->node[op->src] + a, COURANT)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Div(Builder *b, const MpmOp *op)
{
  const PetscInt dim = b->space->dim, dst = b->node[op->dst], src = b->particle[op->src];
  const MpmRank  to = b->formulation->node_ranks[op->dst], from = b->formulation->particle_ranks[op->src];
  PetscBool      accumulates = op->accumulates;

  PetscFunctionBegin;
  PetscCheck(dim == 1 || (to == MPM_VECTOR && from != MPM_VECTOR) || (to == MPM_SCALAR && from == MPM_VECTOR),
             PETSC_COMM_SELF, PETSC_ERR_SUP,
             "the table: DIV makes a vector of a stress or a number, and a number of a vector");
  if (from != MPM_TENSOR) {
    for (PetscInt a = 0; a < dim; a++) {
      PetscCall(Term(b, op, dst + (to == MPM_VECTOR ? a : 0), src + (from == MPM_VECTOR ? a : 0), a, 1, accumulates));
      if (to != MPM_VECTOR) accumulates = PETSC_TRUE;
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt a = 0; a < dim; a++) {
    accumulates = op->accumulates;

    for (PetscInt axis = 0; axis < dim; axis++) {
      const PetscInt component = Stress(b->space, a, axis);

      if (component == MPM_NONE) continue;
      PetscCall(Term(b, op, dst + a, src + component, axis, 1 + b->space->prestress, accumulates));
      accumulates = PETSC_TRUE;
    }
  }
  PetscCall(Curve(b, op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* s_ab += lambda delta_ab sum_c GRAD_c v_c + mu (GRAD_b v_a + GRAD_a v_b), with lambda + 2 mu = 1 */
static PetscErrorCode GradToStress(Builder *b, const MpmOp *op)
{
  const PetscInt  dim = b->space->dim, s = b->particle[op->dst], v = b->node[op->src];
  const PetscReal nu = b->space->poisson, lambda = nu / (1 - nu), mu = (1 - 2 * nu) / (2 * (1 - nu));

  PetscFunctionBegin;
  if (MpmSpaceIsFluid(b->space)) {
    for (PetscInt a = 0; a < dim; a++) PetscCall(Term(b, op, s, v + a, a, 1, PETSC_TRUE));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt a = 0; a < dim; a++) {
    for (PetscInt c = 0; c < dim; c++)
      if (c == a || lambda > 0)
        PetscCall(Term(b, op, s + Stress(b->space, a, a), v + c, c, c == a ? 1 : lambda, PETSC_TRUE));
    for (PetscInt c = a + 1; c < dim; c++) {
      PetscCall(Term(b, op, s + Stress(b->space, a, c), v + a, c, mu, PETSC_TRUE));
      PetscCall(Term(b, op, s + Stress(b->space, a, c), v + c, a, mu, PETSC_TRUE));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Grad(Builder *b, const MpmOp *op)
{
  const PetscInt dim = b->space->dim, dst = b->particle[op->dst], src = b->node[op->src];
  const MpmRank  to = b->formulation->particle_ranks[op->dst], from = b->formulation->node_ranks[op->src];

  PetscFunctionBegin;
  if (dim == 1)
    PetscCall(Term(b, op, dst, src, 0, 1, PETSC_TRUE));
  else if (to == MPM_TENSOR && from == MPM_VECTOR)
    PetscCall(GradToStress(b, op));
  else {
    PetscCheck((to == MPM_VECTOR && from == MPM_SCALAR) || (to == MPM_SCALAR && from == MPM_VECTOR), PETSC_COMM_SELF,
               PETSC_ERR_SUP, "the table: GRAD makes a stress or a number of a vector, and a vector of a number");
    for (PetscInt a = 0; a < dim; a++)
      PetscCall(Term(b, op, dst + (to == MPM_VECTOR ? a : 0), src + (from == MPM_VECTOR ? a : 0), a, 1, PETSC_TRUE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sum of the second differences over the directions. */
static PetscErrorCode Lap(Builder *b, const MpmOp *op)
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

static PetscBool HasField(const Builder *b, MpmPlace place, PetscInt field)
{
  const char *const *names = place == MPM_ON_NODES ? b->formulation->node_fields : b->formulation->particle_fields;

  if (place == MPM_NOWHERE) return PETSC_TRUE;
  for (PetscInt f = 0; names[f]; f++)
    if (f == field) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscErrorCode Expand(Builder *b, const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  PetscFunctionBegin;
  PetscCheck(HasField(b, traits.dst, op->dst) && HasField(b, traits.src, op->src), PETSC_COMM_SELF, PETSC_ERR_SUP,
             "the table: an operation on a field that does not exist");
  PetscCheck(op->axis == 0, PETSC_COMM_SELF, PETSC_ERR_SUP, "the table: formulations name no axis");
  if (op->kind == MPM_DIV)
    PetscCall(Div(b, op));
  else if (op->kind == MPM_GRAD)
    PetscCall(Grad(b, op));
  else if (op->kind == MPM_LAP)
    PetscCall(Lap(b, op));
  else
    PetscCall(Each(b, op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a node register holds P2G of a particle register as it is now. */
static PetscBool Holds(const MpmTable *t, PetscInt node, PetscInt particle)
{
  PetscInt taken = MPM_NONE;

  for (PetscInt o = 0; o < t->nops; o++)
    if (t->ops[o].kind == MPM_P2G && t->ops[o].dst == node && t->ops[o].src == particle) taken = o;
  return taken != MPM_NONE && !IsWritten(t, taken + 1, MPM_ON_PARTICLES, particle) ? PETSC_TRUE : PETSC_FALSE;
}

/* Whether an operation is a filter that acts in the space. */
static PetscBool IsFilter(const Builder *b, const MpmOp *op)
{
  const MpmFilterTime at = b->space->filter;

  return op->kind == MPM_FILTER || (op->kind == MPM_FILTER_BEFORE && at == MPM_FILTERS_BEFORE) ||
                 (op->kind == MPM_FILTER_AFTER && at == MPM_FILTERS_AFTER)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* A filter needs P2G of its field. Where the nodes do not hold it, one is added. */
static PetscErrorCode Filter(Builder *b, const MpmOp *op)
{
  MpmTable      *t     = b->table;
  const PetscInt first = b->particle[op->dst], node = b->node[op->src], n = ComponentsOf(b, PETSC_TRUE, op->src);

  PetscFunctionBegin;
  if (!b->transfer->filter) PetscFunctionReturn(PETSC_SUCCESS);
  if (!Holds(t, node, first)) {
    PetscCall(Each(b, &(MpmOp)P2G(op->src, op->dst)));
    for (PetscInt c = 0; c < n; c++) PetscCall(MpmTableImpose(t, node + c));
  }
  for (PetscInt c = 0; c < n; c++) {
    const PetscInt before = t->nops;

    PetscCall(b->transfer->filter(t, b->numbers, first + c, node + c));
    if (!IsWritten(t, before, MPM_ON_PARTICLES, first + c)) continue;
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

/* A wall with a reaction is imposed after the filter, because the filter must act on the values before the wall. */
static PetscErrorCode Translate(Builder *b)
{
  const MpmFormulation *f = b->formulation;

  PetscFunctionBegin;
  for (PetscInt o = 0; o < f->nops; o++) {
    const MpmOp    *op = &f->ops[o];
    const PetscBool filtered =
        o + 1 < f->nops && IsFilter(b, &op[1]) && op[1].src == op->dst ? PETSC_TRUE : PETSC_FALSE;

    if (op->kind == MPM_IMPOSE) {
      const PetscInt n = ComponentsOf(b, PETSC_TRUE, op->dst);

      for (PetscInt c = 0; c < n; c++) PetscCall(MpmTableImpose(b->table, b->node[op->dst] + c));
      if (filtered) PetscCall(Filter(b, &f->ops[++o]));
      for (PetscInt c = 0; c < n; c++) PetscCall(ImposeWithReaction(b, b->node[op->dst] + c, IsKept(f, op->dst)));
    } else if (IsFilter(b, op))
      PetscCall(Filter(b, op));
    else if (op->kind == MPM_FILTER_BEFORE || op->kind == MPM_FILTER_AFTER)
      continue; /* the filter acts in the other place */
    else if (op->kind == MPM_MOVE || op->kind == MPM_MOVE_PROJECTED)
      PetscCall(Move(b, op));
    else if (op->kind == MPM_REACT)
      for (PetscInt c = 0; c < ComponentsOf(b, PETSC_TRUE, op->dst); c++)
        PetscCall(React(b, b->node[op->dst] + c, b->node[op->src] + c));
    else
      PetscCall(Expand(b, op));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the table ---- */

static PetscErrorCode AddState(MpmTable *t, const char name[], PetscInt field, PetscInt component)
{
  const PetscInt r = t->nstate;

  PetscFunctionBegin;
  PetscCall(CheckRoom(t, r, "particle"));
  PetscCall(PetscStrncpy(t->names[r], name, sizeof t->names[r]));
  t->fields[r]    = t->names[r];
  t->field[r]     = field;
  t->component[r] = component;
  t->nstate++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The registers of a field of the state. Their names end in the directions where there are several: v_x, s_xy. */
static PetscErrorCode AddField(Builder *b, PetscInt field)
{
  static const char     axes[] = "xyz";
  const MpmFormulation *f      = b->formulation;
  const PetscInt        n = ComponentsOf(b, PETSC_FALSE, field), dim = b->space->dim;
  char                  name[16];

  PetscFunctionBegin;
  b->particle[field] = b->table->nstate;
  if (n == 1)
    PetscCall(AddState(b->table, f->particle_fields[field], field, 0));
  else if (f->particle_ranks[field] == MPM_VECTOR)
    for (PetscInt a = 0; a < dim; a++) {
      PetscCall(PetscSNPrintf(name, sizeof name, "%s_%c", f->particle_fields[field], axes[a]));
      PetscCall(AddState(b->table, name, field, a));
    }
  else
    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt c = a; c < dim; c++) {
        PetscCall(PetscSNPrintf(name, sizeof name, "%s_%c%c", f->particle_fields[field], axes[a], axes[c]));
        PetscCall(AddState(b->table, name, field, Stress(b->space, a, c)));
      }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The displacement of particles: x, or x_x, x_y, x_z. */
static PetscErrorCode AddDisplacement(Builder *b)
{
  static const char axes[] = "xyz";
  MpmTable         *t      = b->table;
  char              name[16];

  PetscFunctionBegin;
  t->displacement = MPM_NONE;
  if (!b->space->displaced) PetscFunctionReturn(PETSC_SUCCESS);
  t->displacement = t->nstate;
  for (PetscInt a = 0; a < t->dim; a++) {
    PetscCall(PetscSNPrintf(name, sizeof name, t->dim == 1 ? "x" : "x_%c", axes[a]));
    PetscCall(AddState(t, name, MPM_DISPLACEMENT, a));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddAffinePart(Builder *b)
{
  static const char axes[] = "xyz";
  MpmTable         *t      = b->table;
  char              name[16];

  PetscFunctionBegin;
  t->affine = MPM_NONE;
  if (!b->transfer->affine) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(b->formulation->affine != MPM_NONE, PETSC_COMM_SELF, PETSC_ERR_PLIB, "no field to be affine");
  t->affine      = b->particle[b->formulation->affine];
  t->affine_part = t->nstate;
  t->affine_map  = b->transfer->taylor ? MPM_G2P_SLOPE : MPM_G2P_AFFINE;
  for (PetscInt a = 0; a < t->dim; a++)
    for (PetscInt axis = 0; axis < t->dim; axis++) {
      PetscCall(PetscSNPrintf(name, sizeof name, t->dim == 1 ? "c" : "c_%c%c", axes[a], axes[axis]));
      t->filtered[t->nstate] = PETSC_TRUE;
      PetscCall(AddState(t, name, MPM_NONE, t->dim * a + axis));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In one dimension a number that is imposed at ends stands for the component along the only direction. */
static MpmParity ParityOf(const Builder *b, PetscInt node, PetscInt component, PetscInt axis)
{
  const MpmFormulation *f       = b->formulation;
  PetscBool             imposed = PETSC_FALSE;

  for (PetscInt o = 0; o < f->nops; o++)
    if ((f->ops[o].kind == MPM_IMPOSE || f->ops[o].kind == MPM_REACT) && f->ops[o].dst == node) imposed = PETSC_TRUE;
  if (!imposed) return f->like[node] ? ParityOf(b, f->like[node] - 1, component, axis) : MPM_EVEN;
  if (b->space->dim > 1 && f->node_ranks[node] != MPM_VECTOR) return MPM_TANGENTIAL;
  return component == axis ? MPM_NORMAL : MPM_TANGENTIAL;
}

static PetscErrorCode AddNodes(Builder *b)
{
  MpmTable *t = b->table;

  PetscFunctionBegin;
  for (PetscInt n = 0; b->formulation->node_fields[n]; n++) {
    b->node[n] = t->nnodes;
    for (PetscInt c = 0; c < ComponentsOf(b, PETSC_TRUE, n); c++) {
      PetscCall(CheckRoom(t, t->nnodes, "node"));
      for (PetscInt axis = 0; axis < t->dim; axis++) t->parity[t->nnodes][axis] = ParityOf(b, n, c, axis);
      t->nnodes++;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
                              const MpmTransferNumbers *numbers, const MpmSpace *space, MpmTable **table)
{
  Builder   b = {.formulation = formulation, .transfer = transfer, .numbers = numbers, .space = space};
  MpmTable *t;

  PetscFunctionBegin;
  PetscCall(PetscNew(table));
  t       = *table;
  b.table = t;
  t->dim  = space->dim;
  PetscCall(WhereOf(formulation, sizeof t->where, t->where));
  t->transfer = transfer;
  for (PetscInt n = 0; n < MPM_MAX_FIELDS; n++) b.kept[n] = b.sharp[n] = MPM_NONE;
  PetscCall(PetscArraycpy(&t->ends[0][0], &space->ends[0][0], 2 * MPM_MAX_DIM));
  for (PetscInt f = 0; formulation->particle_fields[f]; f++) PetscCall(AddField(&b, f));
  PetscCall(AddDisplacement(&b));
  t->unfiltered = t->nstate;
  PetscCall(AddAffinePart(&b));
  t->nparticles = t->nstate;
  PetscCall(AddNodes(&b));
  PetscCall(Translate(&b));
  PetscCall(CheckRuns(t));
  PetscCall(MpmTableCheck(t));
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
