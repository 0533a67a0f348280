/*
   What a table does at the ends of directions and at colliders. At ends IMPOSE and REACT become WALL.

   What colliders make of a table. Formulations do not name them: as walls they follow from IMPOSE and REACT.

     IMPOSE(v)     w = v, then v = P(v). P is what the bodies make of a velocity (collider.h).
     REACT(a, v)   a += P(v + a) - (v + a), so that v + a is what the bodies allow
                   v_p += G2P (v - w): particles get what v lost when it was imposed, as they get a

   The second line of REACT is for an IMPOSE of a P2G that REACT follows. Elsewhere v is imposed for the strain alone.
*/
#include "scheme/table_builder.h"

/* ---- ends ---- */

static PetscErrorCode Wall(MpmTable *t, PetscInt axis, PetscInt end, PetscInt dst, PetscInt src, PetscReal factor)
{
  PetscFunctionBegin;
  PetscCall(MpmTableAppendOwn(
      t, (MpmOp){.kind = MPM_WALL, .axis = axis, .dst = dst, .src = src, .factor = factor, .side = end}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same at all ends with a reaction, or at those that impose dst without one. */
static PetscErrorCode Walls(MpmTable *t, PetscBool reaction, PetscInt dst, PetscInt src, PetscReal factor)
{
  PetscFunctionBegin;
  for (PetscInt axis = 0; axis < t->dim; axis++)
    for (PetscInt end = 0; end < 2; end++)
      if (reaction ? t->ends[axis][end] == MPM_FIXED_REACTION : MpmEndImposes(t->ends[axis][end], t->parity[dst][axis]))
        PetscCall(Wall(t, axis, end, dst, src, factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTableImpose(MpmTable *t, PetscInt node)
{
  PetscFunctionBegin;
  PetscCall(Walls(t, PETSC_FALSE, node, node, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A value from before the wall is kept the first time that the wall is imposed in the step. */
PetscErrorCode MpmBuilderImposeWithReaction(MpmTableBuilder *b, PetscInt node, PetscBool wanted)
{
  MpmTable *t      = b->table;
  PetscBool reacts = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < 2 * t->dim; i++)
    if (t->ends[i / 2][i % 2] == MPM_FIXED_REACTION) reacts = PETSC_TRUE;
  if (reacts && wanted && b->kept[node] == MPM_NONE) {
    PetscCall(MpmTableNode(t, node, &b->kept[node]));
    PetscCall(Walls(t, PETSC_TRUE, b->kept[node], node, 1));
  }
  PetscCall(Walls(t, PETSC_TRUE, node, node, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBuilderReact(MpmTableBuilder *b, PetscInt dst, PetscInt imposed)
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

/* ---- colliders ---- */

/* The line of a formulation's P2G of a node field before line o; MPM_NONE: there is none. */
static PetscInt SumBefore(const MpmFormulation *f, PetscInt o, PetscInt node)
{
  while (--o >= 0)
    if (f->ops[o].kind == MPM_P2G && f->ops[o].dst == node && !f->ops[o].accumulates) return o;
  return MPM_NONE;
}

/* Whether the next line after o that begins anew with a node field, or reacts to it, reacts. */
static PetscBool ReactsLater(const MpmFormulation *f, PetscInt o, PetscInt node)
{
  while (++o < f->nops) {
    if (f->ops[o].kind == MPM_REACT && f->ops[o].src == node) return PETSC_TRUE;
    if (f->ops[o].kind == MPM_P2G && f->ops[o].dst == node) return PETSC_FALSE;
  }
  return PETSC_FALSE;
}

static PetscErrorCode Copy(MpmTableBuilder *b, PetscInt dst, PetscInt src, PetscReal factor, PetscBool accumulates)
{
  PetscFunctionBegin;
  for (PetscInt c = 0; c < b->table->dim; c++)
    PetscCall(MpmTableAppendOwn(
        b->table,
        (MpmOp){.kind = MPM_COPY, .dst = dst + c, .src = src + c, .factor = factor, .accumulates = accumulates}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* dst += P(u) - u, with u = v, or u = v + plus */
static PetscErrorCode Collide(MpmTableBuilder *b, PetscInt dst, PetscInt node, PetscInt plus)
{
  PetscFunctionBegin;
  if (b->trial == MPM_NONE) PetscCall(MpmBuilderNodes(b->table, b->node[node], b->table->dim, &b->trial));
  PetscCall(Copy(b, b->trial, b->node[node], 1, PETSC_FALSE));
  if (plus != MPM_NONE) PetscCall(Copy(b, b->trial, plus, 1, PETSC_TRUE));
  for (PetscInt c = 0; c < b->table->dim; c++)
    PetscCall(MpmTableAppendOwn(b->table, (MpmOp){.kind        = MPM_COLLIDE,
                                                  .axis        = c,
                                                  .dst         = dst + c,
                                                  .src         = b->trial + c,
                                                  .factor      = 1,
                                                  .accumulates = PETSC_TRUE}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool Collides(const MpmTableBuilder *b, PetscInt node)
{
  return b->space->collides && b->formulation->node_ranks[node] == MPM_VECTOR ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmBuilderCollide(MpmTableBuilder *b, PetscInt o)
{
  const PetscInt node = b->formulation->ops[o].dst, sum = SumBefore(b->formulation, o, node);

  PetscFunctionBegin;
  if (!Collides(b, node)) PetscFunctionReturn(PETSC_SUCCESS);
  if (sum != MPM_NONE && ReactsLater(b->formulation, o, node) && b->lost_by == MPM_NONE) {
    b->lost_by = b->formulation->ops[sum].src;
    if (b->lost == MPM_NONE) PetscCall(MpmBuilderNodes(b->table, b->node[node], b->table->dim, &b->lost));
    PetscCall(Copy(b, b->lost, b->node[node], 1, PETSC_FALSE));
  }
  PetscCall(Collide(b, b->node[node], node, MPM_NONE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBuilderCollideAgain(MpmTableBuilder *b, PetscInt o)
{
  const PetscInt node = b->formulation->ops[o].src;

  PetscFunctionBegin;
  if (!Collides(b, node)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Collide(b, b->node[b->formulation->ops[o].dst], node, b->node[b->formulation->ops[o].dst]));
  if (b->lost_by == MPM_NONE) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Copy(b, b->lost, b->lost, -1, PETSC_FALSE));
  PetscCall(Copy(b, b->lost, b->node[node], 1, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBuilderGiveLost(MpmTableBuilder *b)
{
  PetscFunctionBegin;
  for (PetscInt c = 0; b->lost_by != MPM_NONE && c < b->table->dim; c++)
    PetscCall(MpmBuilderAppend(b, (MpmOp)G2P(b->particle[b->lost_by] + c, b->lost + c, ONE)));
  b->lost_by = MPM_NONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
