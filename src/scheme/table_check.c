/*
   What the interpreters of a table support, and what they ask of it. A table that they would get wrong is refused when
   it is made.
*/
#include "scheme/table_builder.h"
#include <mpmstab/errors.h>

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
  const PetscBool   stencil  = op->kind == MPM_LAP || op->kind == MPM_COPY || op->kind == MPM_COLLIDE;
  const PetscBool   itself   = op->kind == MPM_COPY && !op->accumulates ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool   sum      = traits.dst == MPM_ON_NODES && traits.src == MPM_ON_PARTICLES ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool   to_nodes = traits.dst == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  SUPPORTED(op->axis >= 0 && op->axis < MPM_AXES && MpmAxesFirst(op->axis) < t->dim && MpmAxesSecond(op->axis) < t->dim,
            o, "there is no such axis");
  SUPPORTED(op->axis < MPM_MAX_DIM || traits.first, o, "this kind acts along one axis");
  SUPPORTED(op->side >= 0 && op->side <= (traits.weight == MPM_STIFFNESS ? MPM_SHEAR - MPM_STIFFNESS : 1), o,
            "an axis has the sides 0 and 1, and GRAD 0 to 2");
  SUPPORTED(op->coefficient >= 0, o, "powers of the Courant number are 0, 1, 2 and so on");
  if (traits.dst == MPM_NOWHERE) PetscFunctionReturn(PETSC_SUCCESS);
  SUPPORTED(op->dst >= 0 && op->dst < (to_nodes ? nodes : particles), o,
            "the register that it writes to does not exist");
  SUPPORTED(op->src >= 0 && op->src < (traits.src == MPM_ON_NODES ? nodes : particles), o,
            "the register that it reads does not exist");
  if (traits.dst == MPM_ON_PARTICLES && traits.src == MPM_ON_NODES)
    SUPPORTED(op->accumulates, o, "what goes to particles is added to what they have");
  else if (op->kind == MPM_ADD)
    SUPPORTED(op->accumulates, o, "what it adds is added to what the particles have");
  else if (!stencil && !sum)
    SUPPORTED(!op->accumulates, o, "this kind does not accumulate");
  SUPPORTED(!stencil || itself || op->dst != op->src, o, "it would read the nodes that it writes");
  SUPPORTED(!sum || !op->accumulates || ContinuesSum(t, o), o,
            "it continues a sum, but other operations have come in between");
  SUPPORTED(traits.src != MPM_ON_NODES || written[op->src] || op->kind == MPM_WALL, o,
            "it reads a node field that the step has not written to");
  SUPPORTED(!to_nodes || !op->accumulates || written[op->dst], o,
            "it adds to a node field before anything has been written there");
  if (to_nodes) written[op->dst] = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Also refuses a written scheme with more operations on nodes in a row than march has room for. */
PetscErrorCode MpmTableCheck(const MpmTable *t)
{
  PetscBool written[MPM_MAX_FIELDS] = {PETSC_FALSE};
  PetscInt  run                     = 0;

  PetscFunctionBegin;
  for (PetscInt o = 0; o < t->nops; o++) {
    const MpmOpTraits traits = MpmOpTraitsOf(t->ops[o].kind);

    run = traits.dst == MPM_ON_NODES && traits.src == MPM_ON_NODES ? run + 1 : 0;
    MpmCheckInput(run <= MPM_MAX_NODE_OPS,
                  "%s: more than %d operations on nodes follow one another, with dim %" PetscInt_FMT
                  "; allowed: fewer lines or dimensions",
                  t->where, MPM_MAX_NODE_OPS, t->dim);
    PetscCall(CheckOp(t, o, written));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what is asked of a table ---- */

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
