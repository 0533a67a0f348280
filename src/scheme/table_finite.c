/*
   Finite deformation: particles carry the stretch F in the place of the stress, and move with the grid's velocity.

   A formulation is written once. Its lines become

     DIV of the stress    tau = tau(F), the Kirchhoff stress of the material; then DIV of tau, whose weight is the volume at
                          rest, since V sigma = V0 tau; and P2G of the body force, where there is one
     a viscous material   L = h GRAD v_i of the velocity that the force is made at, and tau += its viscous stress
     GRAD to the stress   L = k sum_i v_i dphi_ip, of all GRADs that follow one another; then F <- (I + L) F, and in a step
                          of several stages F <- (I + L + L L / 2) F
     q = s + GRAD         the stress of a stage: the same of a copy of F
     a material that flows: F is its elastic part, with its internal variables after it, and returns to the yield surface as
                          soon as it is stretched
     MOVE                 the velocity that particles move with, a sum of shares of node fields
     DRIFT                x <- x + k sum_i phi_ip of that velocity
     MOVE_TO              the same to a part of the step, from where particles were at its start: they go by the difference to the
                          way that they have gone so far, which is kept from one MOVE_TO to the next and to DRIFT

     IMPLICIT           a_i is the solution of a_i = - k DIV T, T = P((I + theta L) F) F^T the stress in the middle of the step,
                        brought back to its start (deform.c). L = k GRAD (v_i + theta a_i). The lines that set the
                        stress of the middle, and make a force of it, are lines of this system.

   tau, L, copies of F and the way that particles go are scratch: they live for one pass over the particles. So L and
   this way are found next to one another at the end of a step, and F is stretched after that.

   Stages: a Runge-Kutta stage F + c L F' has the F' of the stage before it, which is no more. (I + c L + (c L)^2 / 2) F
   differs from it by as much as both differ from the solution: such a step has order two in time, as has the motion of
   particles once a step.

   Source: Sulsky, Chen and Schreyer 1994; the notation is that of de Vaucorbeil et al. 2020, section 2.
*/
#include "scheme/table_builder.h"
#include <mpmstab/errors.h>

PetscErrorCode MpmFiniteAddState(MpmTableBuilder *b, PetscInt field)
{
  MpmTable *t = b->table;

  PetscFunctionBegin;
  PetscCheck(t->stretch == MPM_NONE, PETSC_COMM_SELF, PETSC_ERR_SUP, "the table: two stresses at finite deformation");
  t->stretch = t->nstate;
  PetscCall(MpmBuilderAddComponents(t, "f", MPM_STRETCHED, MPM_TENSOR, PETSC_TRUE));
  for (PetscInt c = t->dim * t->dim; c < MpmMaterialComponents(&b->space->material, t->dim); c++) {
    PetscReal start;

    PetscCall(MpmBuilderAddState(t, MpmMaterialInternal(&b->space->material, t->dim, c - t->dim * t->dim, &start),
                                 MPM_STRETCHED, c));
  }
  b->particle[field] = MPM_NONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteAddScratch(MpmTableBuilder *b)
{
  const MpmFormulation *f   = b->formulation;
  MpmTable             *t   = b->table;
  const PetscInt        dim = t->dim;
  PetscInt              tau;

  PetscFunctionBegin;
  PetscCall(MpmBuilderScratches(t, MpmSpaceComponents(b->space, MPM_TENSOR), &tau));
  for (PetscInt o = 0; o < f->nops; o++)
    if (f->ops[o].kind == MPM_IMPLICIT) b->implicit = PETSC_TRUE;
  if (b->implicit) PetscCall(MpmBuilderScratches(t, dim * dim, &b->stress));
  for (PetscInt field = 0; f->particle_fields[field]; field++) {
    if (f->particle_ranks[field] != MPM_TENSOR) continue;
    b->particle[field]  = tau;
    b->stretched[field] = t->stretch;
    if (!f->scratch[field] || b->implicit) continue;
    PetscCall(MpmBuilderScratches(t, dim * dim, &b->stretched[field]));
    b->staged = PETSC_TRUE;
  }
  b->stretching = MPM_NONE;
  PetscCall(MpmBuilderScratches(t, dim * dim, &b->slope));
  PetscCall(MpmBuilderScratches(t, dim, &b->way));
  b->load    = MPM_NONE;
  b->at_part = 0;
  if (b->space->loaded) PetscCall(MpmBuilderScratches(t, dim, &b->load));
  t->material = b->space->material;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what particles move with ---- */

static PetscBool WritesNode(const MpmOp *op, PetscInt node)
{
  if (op->dst != node) return PETSC_FALSE;
  if (op->kind == MPM_IMPOSE || op->kind == MPM_REACT) return PETSC_TRUE;
  return op->kind < MPM_OP_KINDS && MpmOpTraitsOf(op->kind).dst == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE;
}

/* The last of the lines from first on, and before end, that writes a node field; MPM_NONE: there is none. */
static PetscInt LastWrite(const MpmTableBuilder *b, PetscInt node, PetscInt first, PetscInt end)
{
  PetscInt last = MPM_NONE;

  for (PetscInt o = first; o < end; o++)
    if (WritesNode(&b->formulation->ops[o], node)) last = o;
  return last;
}

/*
   Lines MOVE that follow one another are kept together: after the line on nodes before them, or as soon as all are
   there.
*/
static void PlanMove(MpmTableBuilder *b, PetscInt o, MpmOpKind kind)
{
  const MpmOp   *ops  = b->formulation->ops;
  const PetscInt m    = b->nmoved++;
  PetscInt       last = LastWrite(b, ops[o].src, 0, o);

  b->moved[m] = ops[o].src;
  b->share[m] = ops[o].factor;
  if (o > 0 && WritesNode(&ops[o - 1], ops[o - 1].dst)) last = o - 1;
  if (m > 0 && ops[o - 1].kind == kind) last = PetscMax(last, b->moved_at[m - 1]);
  for (PetscInt i = m - 1; i >= 0 && ops[o - m + i].kind == kind; i--) b->moved_at[i] = last;
  b->moved_at[m] = last;
}

/*
   Where one node field is the velocity, and keeps it to the end of the step, particles move with it. Else the sum is
   kept in a node field of its own.
*/
PetscErrorCode MpmFinitePlan(MpmTableBuilder *b)
{
  const MpmOpKind kind  = b->space->move == MPM_MOVES_PROJECTED ? MPM_MOVE_PROJECTED : MPM_MOVE;
  PetscInt        first = MPM_NONE;

  PetscFunctionBegin;
  for (PetscInt o = 0; o < b->formulation->nops; o++) {
    if (b->formulation->ops[o].kind != kind) continue;
    if (first == MPM_NONE) first = o;
    MpmCheckInput(b->nmoved < MPM_MAX_MOVED, "%s: more than %d lines MOVE, with kinematics finite; allowed: fewer",
                  b->table->where, MPM_MAX_MOVED);
    PlanMove(b, o, kind);
  }
  PetscCheck(b->nmoved && b->formulation->node_ranks[b->moved[0]] == MPM_VECTOR, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "the table: no line says what particles move with");
  b->velocity = b->node[b->moved[0]];
  if (b->nmoved == 1 && b->share[0] == 1 && LastWrite(b, b->moved[0], first, b->formulation->nops) == MPM_NONE) {
    b->nsummed = 1;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmBuilderNodes(b->table, b->node[b->moved[0]], b->space->dim, &b->velocity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteAfter(MpmTableBuilder *b, PetscInt o)
{
  PetscFunctionBegin;
  for (; b->nsummed < b->nmoved && o >= b->moved_at[b->nsummed]; b->nsummed++)
    for (PetscInt a = 0; a < b->space->dim; a++) {
      MpmOp op = COPY(b->velocity + a, b->node[b->moved[b->nsummed]] + a);

      op.factor      = b->share[b->nsummed];
      op.accumulates = b->nsummed ? PETSC_TRUE : PETSC_FALSE;
      PetscCall(MpmTableAppend(b->table, op));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- operations ---- */

/* F <- (I + L) F or (I + L + L L / 2) F, when the slopes L are complete. */
static PetscErrorCode Stretch(MpmTableBuilder *b)
{
  PetscFunctionBegin;
  if (b->stretching != MPM_NONE)
    PetscCall(MpmTableAppendOwn(
        b->table, (MpmOp){.kind = MPM_STRETCH, .dst = b->stretching, .src = b->slope, .factor = b->staged ? 0.5 : 0}));
  if (b->stretching != MPM_NONE && MpmMaterialFlows(&b->space->material))
    PetscCall(MpmTableAppendOwn(b->table,
                                (MpmOp){.kind = MPM_RETURN, .dst = b->stretching, .src = b->stretching, .factor = 1}));
  b->stretching = MPM_NONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteBefore(MpmTableBuilder *b, const MpmOp *op)
{
  PetscFunctionBegin;
  if (op->kind != MPM_MOVE && op->kind != MPM_MOVE_PROJECTED && op->kind != MPM_MOVE_TO && op->kind != MPM_DRIFT)
    PetscCall(Stretch(b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteSet(MpmTableBuilder *b, const MpmOp *op)
{
  MpmOp one = *op;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < b->space->dim * b->space->dim && !b->implicit; c++) {
    one.dst = b->stretched[op->dst] + c;
    one.src = b->stretched[op->src] + c;
    PetscCall(MpmTableAppendOwn(b->table, one));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   DIV of a stress, which has dim x dim components if it is whole, to a node register and those after it; and the body
   force at a part of the step.
*/
static PetscErrorCode Force(MpmTableBuilder *b, const MpmOp *div, PetscInt node, PetscInt stress, PetscBool whole,
                            PetscReal part)
{
  const PetscInt dim = b->space->dim;

  PetscFunctionBegin;
  if (b->space->loaded)
    PetscCall(MpmTableAppendOwn(b->table, (MpmOp){.kind = MPM_LOAD, .dst = b->load, .src = b->load, .factor = part}));
  for (PetscInt a = 0; a < dim; a++) {
    for (PetscInt axis = 0; axis < dim; axis++)
      PetscCall(MpmBuilderTerm(b, div, node + a, stress + (whole ? dim * a + axis : MpmSpaceStress(b->space, a, axis)),
                               axis, b->space->stiffness, axis ? PETSC_TRUE : div->accumulates));
    if (!b->space->loaded) continue;
    PetscCall(MpmTableAppendOwn(b->table, (MpmOp){.kind        = MPM_P2G,
                                                  .dst         = node + a,
                                                  .src         = b->load + a,
                                                  .accumulates = PETSC_TRUE,
                                                  .coefficient = div->coefficient,
                                                  .factor      = -div->factor}));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteDiv(MpmTableBuilder *b, const MpmOp *op)
{
  const PetscInt  dim = b->space->dim, node = b->node[op->dst], tau = b->particle[op->src];
  const PetscBool ahead = b->implicit && b->formulation->scratch[op->src] ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  PetscCheck(b->formulation->node_ranks[op->dst] == MPM_VECTOR && b->formulation->particle_ranks[op->src] == MPM_TENSOR,
             PETSC_COMM_SELF, PETSC_ERR_SUP, "the table: at finite deformation DIV makes a vector of a stress");
  for (PetscInt a = 0; a < dim && ahead; a++) /* the solution is sought from 0 on */
    PetscCall(MpmTableAppendOwn(b->table, (MpmOp){.kind = MPM_COPY, .dst = node + a, .src = b->start + a}));
  if (ahead) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(
      MpmTableAppendOwn(b->table, (MpmOp){.kind = MPM_STRESS, .dst = tau, .src = b->stretched[op->src], .factor = 1}));
  if (b->rate != MPM_NONE && !op->accumulates)
    PetscCall(MpmTableAppendOwn(
        b->table, (MpmOp){.kind = MPM_VISCOUS, .dst = tau, .src = b->rate, .factor = 1 / b->space->stiffness}));
  PetscCall(Force(b, op, node, tau, PETSC_FALSE, b->at_part));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   image = - DIV T of the slopes of a node field, and the body force. The grid's own slopes: no transfer has sharpened
   them.
*/
PetscErrorCode MpmFiniteAhead(MpmTableBuilder *b, PetscInt field, PetscInt image)
{
  static const MpmOp grad = GRAD(0, 0, ONE), div = MINUS_DIV(0, 0, ONE);
  const MpmTransfer  plain = {.name = b->transfer->name};
  const PetscInt     dim   = b->space->dim;
  MpmTableBuilder    own   = *b;

  PetscFunctionBegin;
  own.transfer = &plain;
  PetscCall(MpmBuilderClear(b->table, dim * dim, b->slope));
  PetscCall(MpmBuilderSlopes(&own, &grad, b->slope, b->node[field]));
  PetscCall(MpmTableAppendOwn(
      b->table, (MpmOp){.kind = MPM_STRESS_AHEAD, .dst = b->stress, .src = b->slope, .factor = b->ahead}));
  PetscCall(Force(&own, &div, image, b->stress, PETSC_TRUE, b->ahead));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteGrad(MpmTableBuilder *b, const MpmOp *op, PetscBool begins, PetscBool ends)
{
  const PetscInt dim = b->space->dim;

  PetscFunctionBegin;
  PetscCheck(b->formulation->particle_ranks[op->dst] == MPM_TENSOR && b->formulation->node_ranks[op->src] == MPM_VECTOR,
             PETSC_COMM_SELF, PETSC_ERR_SUP, "the table: at finite deformation GRAD makes a stress of a vector");
  for (PetscInt a = 0; a < dim; a++) {
    PetscInt sharp; /* what a transfer makes of the nodes comes before the scratch begins */

    PetscCall(MpmBuilderSharpen(b, b->node[op->src] + a, &sharp));
    if (b->nsummed == b->nmoved && !b->formulation->scratch[op->dst])
      PetscCall(MpmBuilderSharpen(b, b->velocity + a, &sharp));
  }
  if (b->implicit && b->formulation->scratch[op->dst]) {
    PetscCall(MpmBuilderSharpen(b, b->node[op->src], &b->start));
    b->ahead = op->factor;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (begins) PetscCall(MpmBuilderClear(b->table, dim * dim, b->slope));
  PetscCall(MpmBuilderSlopes(b, op, b->slope, b->node[op->src]));
  if (ends) b->stretching = b->stretched[op->dst];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddTo(MpmTableBuilder *b, PetscInt to, PetscReal factor, PetscInt from)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < b->space->dim; a++)
    PetscCall(MpmTableAppendOwn(
        b->table,
        (MpmOp){.kind = MPM_ADD, .dst = to + a, .src = from + a, .accumulates = PETSC_TRUE, .factor = factor}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteGo(MpmTableBuilder *b, PetscInt velocity, PetscReal part)
{
  PetscFunctionBegin;
  PetscCall(MpmBuilderSharpenAll(b, velocity, b->space->dim));
  PetscCall(MpmBuilderClear(b->table, b->space->dim, b->way));
  if (b->at_part > 0) PetscCall(AddTo(b, b->way, -1, b->gone));
  for (PetscInt a = 0; a < b->space->dim; a++)
    PetscCall(MpmBuilderAppend(b, (MpmOp)G2P_TIMES(b->way + a, velocity + a, part, COURANT)));
  PetscCall(Stretch(b));
  if (part < 1) PetscCall(AddTo(b, b->gone, 1, b->way));
  PetscCall(MpmTableAppendOwn(b->table, (MpmOp){.kind = MPM_ADVANCE, .dst = MPM_NONE, .src = b->way, .factor = part}));
  b->at_part = part;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At small strain particles stay where they are, or move with the drift alone. */
PetscErrorCode MpmFiniteMoveTo(MpmTableBuilder *b, const MpmOp *op)
{
  PetscFunctionBegin;
  if (!b->space->finite) PetscFunctionReturn(PETSC_SUCCESS);
  if (b->at_part == 0) PetscCall(MpmBuilderClear(b->table, b->space->dim, b->gone));
  PetscCall(MpmFiniteGo(b, b->node[op->src], op->factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}
