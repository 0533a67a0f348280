/*
   Finite deformation: particles carry the stretch F in the place of the stress, and move with the grid's velocity.

   A formulation is written once. Its lines become

     DIV of the stress    tau = tau(F), the Kirchhoff stress of the material; then DIV of tau, whose weight is the volume at
                          rest, since V sigma = V0 tau; and P2G of the body force, where there is one
     GRAD to the stress   L = k sum_i v_i dphi_ip, of all GRADs that follow one another; then F <- (I + L) F
     MOVE                 the velocity that particles move with, a sum of node fields
     DRIFT                x <- x + k sum_i phi_ip of that velocity

   tau, L and the way that particles go are scratch: they live for one pass over the particles. So L and this way are
   found next to one another at the end of a step, and F is stretched after that.

   Source: Sulsky, Chen and Schreyer 1994; the notation is that of de Vaucorbeil et al. 2020, section 2.
*/
#include "scheme/table_builder.h"
#include <mpmstab/errors.h>

PetscErrorCode MpmFiniteAddState(MpmTableBuilder *b, PetscInt field)
{
  static const char axes[] = "xyz";
  MpmTable         *t      = b->table;
  char              name[16];

  PetscFunctionBegin;
  PetscCheck(t->stretch == MPM_NONE, PETSC_COMM_SELF, PETSC_ERR_SUP, "the table: two stresses at finite deformation");
  t->stretch = t->nstate;
  for (PetscInt a = 0; a < t->dim; a++)
    for (PetscInt c = 0; c < t->dim; c++) {
      PetscCall(PetscSNPrintf(name, sizeof name, t->dim == 1 ? "f" : "f_%c%c", axes[a], axes[c]));
      PetscCall(MpmBuilderAddState(t, name, MPM_STRETCHED, t->dim * a + c));
    }
  b->particle[field] = MPM_NONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddVector(MpmTable *t, PetscInt n, PetscInt *first)
{
  PetscInt scratch;

  PetscFunctionBegin;
  PetscCall(MpmTableScratch(t, first));
  for (PetscInt c = 1; c < n; c++) PetscCall(MpmTableScratch(t, &scratch));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteAddScratch(MpmTableBuilder *b)
{
  const MpmFormulation *f   = b->formulation;
  MpmTable             *t   = b->table;
  const PetscInt        dim = t->dim;

  PetscFunctionBegin;
  for (PetscInt field = 0; f->particle_fields[field]; field++)
    if (f->particle_ranks[field] == MPM_TENSOR)
      PetscCall(AddVector(t, MpmSpaceComponents(b->space, MPM_TENSOR), &b->particle[field]));
  PetscCall(AddVector(t, dim * dim, &b->slope));
  PetscCall(AddVector(t, dim, &b->way));
  b->load = MPM_NONE;
  if (b->space->loaded) PetscCall(AddVector(t, dim, &b->load));
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

/* Whether a line from first on, and before end, writes a node field that particles move with; last: the last such line. */
static PetscBool WritesMoved(const MpmTableBuilder *b, PetscInt first, PetscInt end, PetscInt *last)
{
  *last = MPM_NONE;
  for (PetscInt o = first; o < end; o++)
    for (PetscInt m = 0; m < b->nmoved; m++)
      if (WritesNode(&b->formulation->ops[o], b->moved[m])) *last = o;
  return *last != MPM_NONE ? PETSC_TRUE : PETSC_FALSE;
}

/*
   Where one node field is the velocity, and keeps it to the end of the step, particles move with it. Else the sum is
   kept in a node field of its own, as soon as all its terms are there.
*/
PetscErrorCode MpmFinitePlan(MpmTableBuilder *b)
{
  const MpmOpKind kind  = b->space->move == MPM_MOVES_PROJECTED ? MPM_MOVE_PROJECTED : MPM_MOVE;
  PetscInt        first = MPM_NONE, last;

  PetscFunctionBegin;
  for (PetscInt o = 0; o < b->formulation->nops; o++) {
    if (b->formulation->ops[o].kind != kind) continue;
    if (first == MPM_NONE) first = o;
    MpmCheckInput(b->nmoved < MPM_MAX_MOVED, "%s: more than %d lines MOVE, with kinematics finite; allowed: fewer",
                  b->table->where, MPM_MAX_MOVED);
    b->moved[b->nmoved++] = b->formulation->ops[o].src;
  }
  PetscCheck(b->nmoved && b->formulation->node_ranks[b->moved[0]] == MPM_VECTOR, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "the table: no line says what particles move with");
  b->moved_at = MPM_NONE;
  b->velocity = b->node[b->moved[0]];
  if (b->nmoved == 1 && !WritesMoved(b, first, b->formulation->nops, &last)) PetscFunctionReturn(PETSC_SUCCESS);
  (void)WritesMoved(b, 0, first, &b->moved_at);
  PetscCall(MpmTableNode(b->table, b->node[b->moved[0]], &b->velocity));
  for (PetscInt a = 1; a < b->space->dim; a++) {
    PetscInt node;

    PetscCall(MpmTableNode(b->table, b->node[b->moved[0]] + a, &node));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteAfter(MpmTableBuilder *b, PetscInt o)
{
  PetscFunctionBegin;
  if (b->moved_at == MPM_NONE || o < b->moved_at) PetscFunctionReturn(PETSC_SUCCESS);
  b->moved_at = MPM_NONE;
  for (PetscInt m = 0; m < b->nmoved; m++)
    for (PetscInt a = 0; a < b->space->dim; a++) {
      MpmOp op = COPY(b->velocity + a, b->node[b->moved[m]] + a);

      op.accumulates = m ? PETSC_TRUE : PETSC_FALSE;
      PetscCall(MpmTableAppend(b->table, op));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- operations ---- */

/* F <- (I + L) F, when the slopes L are complete. */
static PetscErrorCode Stretch(MpmTableBuilder *b)
{
  PetscFunctionBegin;
  if (b->stretching)
    PetscCall(MpmTableAppendOwn(b->table,
                                (MpmOp){.kind = MPM_STRETCH, .dst = b->table->stretch, .src = b->slope, .factor = 1}));
  b->stretching = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteBefore(MpmTableBuilder *b, const MpmOp *op)
{
  PetscFunctionBegin;
  if (op->kind != MPM_MOVE && op->kind != MPM_MOVE_PROJECTED && op->kind != MPM_DRIFT) PetscCall(Stretch(b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteDiv(MpmTableBuilder *b, const MpmOp *op)
{
  const PetscInt dim = b->space->dim, node = b->node[op->dst], tau = b->particle[op->src];

  PetscFunctionBegin;
  PetscCheck(b->formulation->node_ranks[op->dst] == MPM_VECTOR && b->formulation->particle_ranks[op->src] == MPM_TENSOR,
             PETSC_COMM_SELF, PETSC_ERR_SUP, "the table: at finite deformation DIV makes a vector of a stress");
  PetscCall(
      MpmTableAppendOwn(b->table, (MpmOp){.kind = MPM_STRESS, .dst = tau, .src = b->table->stretch, .factor = 1}));
  if (b->space->loaded)
    PetscCall(MpmTableAppendOwn(b->table, (MpmOp){.kind = MPM_LOAD, .dst = b->load, .src = b->load, .factor = 1}));
  for (PetscInt a = 0; a < dim; a++) {
    for (PetscInt axis = 0; axis < dim; axis++)
      PetscCall(MpmBuilderTerm(b, op, node + a, tau + MpmSpaceStress(b->space, a, axis), axis, b->space->stiffness,
                               axis ? PETSC_TRUE : op->accumulates));
    if (!b->space->loaded) continue;
    PetscCall(MpmTableAppendOwn(b->table, (MpmOp){.kind        = MPM_P2G,
                                                  .dst         = node + a,
                                                  .src         = b->load + a,
                                                  .accumulates = PETSC_TRUE,
                                                  .coefficient = op->coefficient,
                                                  .factor      = -op->factor}));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteGrad(MpmTableBuilder *b, const MpmOp *op, PetscBool begins, PetscBool ends)
{
  const PetscInt dim   = b->space->dim;
  MpmOp          slope = *op;

  PetscFunctionBegin;
  PetscCheck(b->formulation->particle_ranks[op->dst] == MPM_TENSOR && b->formulation->node_ranks[op->src] == MPM_VECTOR,
             PETSC_COMM_SELF, PETSC_ERR_SUP, "the table: at finite deformation GRAD makes a stress of a vector");
  slope.kind = MPM_G2P_SLOPE;
  for (PetscInt a = 0; a < dim; a++) {
    PetscInt sharp; /* what a transfer makes of the nodes comes before the scratch begins */

    PetscCall(MpmBuilderSharpen(b, b->node[op->src] + a, &sharp));
    if (b->moved_at == MPM_NONE) PetscCall(MpmBuilderSharpen(b, b->velocity + a, &sharp));
  }
  for (PetscInt c = 0; c < dim * dim && begins; c++)
    PetscCall(MpmTableAppendOwn(b->table, (MpmOp)SCALE(b->slope + c, 0)));
  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt axis = 0; axis < dim; axis++)
      PetscCall(MpmBuilderTerm(b, &slope, b->slope + dim * a + axis, b->node[op->src] + a, axis, 1, PETSC_TRUE));
  if (ends) b->stretching = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteMove(MpmTableBuilder *b)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < b->space->dim; a++) {
    PetscInt sharp;

    PetscCall(MpmBuilderSharpen(b, b->velocity + a, &sharp));
  }
  for (PetscInt a = 0; a < b->space->dim; a++) PetscCall(MpmTableAppendOwn(b->table, (MpmOp)SCALE(b->way + a, 0)));
  for (PetscInt a = 0; a < b->space->dim; a++)
    PetscCall(MpmBuilderAppend(b, (MpmOp)G2P(b->way + a, b->velocity + a, COURANT)));
  PetscCall(Stretch(b));
  PetscCall(MpmTableAppendOwn(b->table, (MpmOp){.kind = MPM_ADVANCE, .dst = MPM_NONE, .src = b->way, .factor = 1}));
  PetscFunctionReturn(PETSC_SUCCESS);
}
