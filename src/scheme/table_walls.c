/* What a table does at the ends of directions: IMPOSE and REACT become WALL. */
#include "scheme/table_builder.h"

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
static PetscErrorCode Keep(MpmTableBuilder *b, PetscInt node)
{
  MpmTable *t = b->table;

  PetscFunctionBegin;
  PetscCall(MpmTableNode(t, node, &b->kept[node]));
  for (PetscInt axis = 0; axis < t->dim; axis++)
    for (PetscInt end = 0; end < 2; end++)
      if (t->ends[axis][end] == MPM_FIXED_REACTION) PetscCall(Wall(t, axis, end, b->kept[node], node, 1));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A value from before the wall is kept the first time that the wall is imposed in the step. */
PetscErrorCode MpmBuilderImposeWithReaction(MpmTableBuilder *b, PetscInt node, PetscBool wanted)
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
