/*
   The space of a table, the state that a scheme is linear about; and its registers: the components of the fields of a
   formulation, and what is added to them.
*/
#include "scheme/table_builder.h"
#include <mpmstab/errors.h>

/* ---- the space ---- */

PetscBool MpmSpaceIsPrestressed(const MpmSpace *space)
{
  for (PetscInt c = 0; c < MPM_MAX_STRESS; c++)
    if (space->prestress[c] != 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscReal MpmSpacePrestress(const MpmSpace *space, PetscInt a, PetscInt b)
{
  return space->prestress[MpmStressComponent(space->dim, a, b)];
}

PetscReal MpmSpaceTangent(const MpmSpace *space, PetscInt a, PetscInt b, PetscInt c, PetscInt d)
{
  const PetscReal *q = space->squares, nu = space->poisson;
  PetscReal        tangent = a == b && c == d ? space->lambda * q[a] * q[c] : 0;

  if (MpmSpaceIsFluid(space)) return a == b && c == d ? 1 + space->prestress[0] : 0;
  if (!MpmSpaceIsPrestressed(space)) {
    if (a == b && c == d) return a == c ? 1 : nu / (1 - nu);
    return (a == c && b == d) || (a == d && b == c) ? (1 - 2 * nu) / (2 * (1 - nu)) : 0;
  }
  if (a == c && b == d) tangent += space->mu * q[a] * q[b];
  if (a == d && b == c) tangent += space->mu * q[a] * q[b];
  if (a == c) tangent += MpmSpacePrestress(space, d, b);
  if (b == c) tangent += MpmSpacePrestress(space, a, d);
  return tangent;
}

PetscBool MpmSpaceMirrors(const MpmSpace *space, PetscInt a)
{
  for (PetscInt b = 0; b < space->dim; b++)
    if (b != a && MpmSpacePrestress(space, a, b) != 0) return PETSC_FALSE;
  return PETSC_TRUE;
}

PetscBool MpmSpaceAlike(const MpmSpace *space, PetscInt a, PetscInt b)
{
  if (!MpmSpaceIsPrestressed(space)) return PETSC_TRUE;
  for (PetscInt c = 0; c < space->dim; c++)
    if (!MpmSpaceMirrors(space, c)) return PETSC_FALSE;
  return MpmSpacePrestress(space, a, a) == MpmSpacePrestress(space, b, b) && space->squares[a] == space->squares[b]
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* ---- registers ---- */

PetscInt MpmSpaceComponents(const MpmSpace *space, MpmRank rank)
{
  if (rank == MPM_VECTOR) return space->dim;
  return rank == MPM_TENSOR && !MpmSpaceIsFluid(space) ? space->dim * (space->dim + 1) / 2 : 1;
}

PetscInt MpmSpaceStress(const MpmSpace *space, PetscInt a, PetscInt b)
{
  if (MpmSpaceIsFluid(space)) return a == b ? 0 : MPM_NONE;
  return MpmStressComponent(space->dim, a, b);
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

PetscErrorCode MpmBuilderNodes(MpmTable *t, PetscInt like, PetscInt n, PetscInt *first)
{
  PetscInt node;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < n; c++) PetscCall(MpmTableNode(t, like + c, c ? &node : first));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBuilderScratches(MpmTable *t, PetscInt n, PetscInt *first)
{
  PetscInt scratch;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < n; c++) PetscCall(MpmTableScratch(t, c ? &scratch : first));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBuilderClear(MpmTable *t, PetscInt n, PetscInt first)
{
  PetscFunctionBegin;
  for (PetscInt c = 0; c < n; c++) PetscCall(MpmTableAppendOwn(t, (MpmOp)SCALE(first + c, 0)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBuilderAddState(MpmTable *t, const char name[], PetscInt field, PetscInt component)
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

PetscBool MpmBuilderIsAhead(const MpmTableBuilder *b, PetscInt field)
{
  const MpmFormulation *f = b->formulation;

  for (PetscInt o = 0; o < f->nops && f->scratch[field] && MpmSpaceIsPrestressed(b->space); o++)
    if (f->ops[o].kind == MPM_IMPLICIT) return f->particle_ranks[field] == MPM_TENSOR ? PETSC_TRUE : PETSC_FALSE;
  return PETSC_FALSE;
}

PetscInt MpmBuilderComponents(const MpmTableBuilder *b, PetscBool on_nodes, PetscInt field)
{
  if (!on_nodes && MpmBuilderIsAhead(b, field)) return b->space->dim * b->space->dim;
  return MpmSpaceComponents(b->space,
                            on_nodes ? b->formulation->node_ranks[field] : b->formulation->particle_ranks[field]);
}

PetscErrorCode MpmBuilderAddComponents(MpmTable *t, const char name[], PetscInt field, MpmRank rank, PetscBool whole)
{
  static const char axes[] = "xyz";
  const PetscInt    dim    = t->dim;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < (rank == MPM_SCALAR ? 1 : rank == MPM_VECTOR ? dim : dim * dim); c++) {
    const PetscInt a = rank == MPM_VECTOR ? c : c / dim, e = c % dim;
    char           full[16];

    if (rank == MPM_TENSOR && !whole && e < a) continue;
    if (rank == MPM_SCALAR || dim == 1)
      PetscCall(PetscSNPrintf(full, sizeof full, "%s", name));
    else if (rank == MPM_VECTOR)
      PetscCall(PetscSNPrintf(full, sizeof full, "%s_%c", name, axes[a]));
    else
      PetscCall(PetscSNPrintf(full, sizeof full, "%s_%c%c", name, axes[a], axes[e]));
    PetscCall(MpmBuilderAddState(t, full, field, rank == MPM_TENSOR && !whole ? MpmStressComponent(dim, a, e) : c));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The registers of a field of the state. */
static PetscErrorCode AddField(MpmTableBuilder *b, PetscInt field)
{
  const MpmFormulation *f    = b->formulation;
  const MpmRank         rank = f->particle_ranks[field];

  PetscFunctionBegin;
  if (b->space->finite && rank == MPM_TENSOR) {
    PetscCall(MpmFiniteAddState(b, field));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  b->particle[field] = b->table->nstate;
  PetscCall(MpmBuilderAddComponents(b->table, f->particle_fields[field], field,
                                    MpmBuilderComponents(b, PETSC_FALSE, field) == 1 ? MPM_SCALAR : rank, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The displacement of particles: x, or x_x, x_y, x_z. */
static PetscErrorCode AddDisplacement(MpmTableBuilder *b)
{
  MpmTable *t = b->table;

  PetscFunctionBegin;
  t->displacement = b->space->displaced ? t->nstate : MPM_NONE;
  if (b->space->displaced) PetscCall(MpmBuilderAddComponents(t, "x", MPM_DISPLACEMENT, MPM_VECTOR, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddAffinePart(MpmTableBuilder *b)
{
  MpmTable *t = b->table;

  PetscFunctionBegin;
  t->affine = MPM_NONE;
  if (!b->transfer->affine) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(b->formulation->affine != MPM_NONE, PETSC_COMM_SELF, PETSC_ERR_PLIB, "no field to be affine");
  t->affine      = b->particle[b->formulation->affine];
  t->affine_part = t->nstate;
  t->affine_map  = b->transfer->taylor ? MPM_G2P_SLOPE : MPM_G2P_AFFINE;
  PetscCall(MpmBuilderAddComponents(t, "c", MPM_NONE, MPM_TENSOR, PETSC_TRUE));
  for (PetscInt r = t->affine_part; r < t->nstate; r++) t->filtered[r] = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In one dimension a number that is imposed at ends stands for the component along the only direction. */
static MpmParity ParityOf(const MpmTableBuilder *b, PetscInt node, PetscInt component, PetscInt axis)
{
  const MpmFormulation *f       = b->formulation;
  PetscBool             imposed = PETSC_FALSE;

  for (PetscInt o = 0; o < f->nops; o++)
    if ((f->ops[o].kind == MPM_IMPOSE || f->ops[o].kind == MPM_REACT) && f->ops[o].dst == node) imposed = PETSC_TRUE;
  if (!imposed) return f->like[node] ? ParityOf(b, f->like[node] - 1, component, axis) : MPM_EVEN;
  if (b->space->dim > 1 && f->node_ranks[node] != MPM_VECTOR) return MPM_TANGENTIAL;
  return component == axis ? MPM_NORMAL : MPM_TANGENTIAL;
}

static PetscErrorCode AddNodes(MpmTableBuilder *b)
{
  MpmTable *t = b->table;

  PetscFunctionBegin;
  for (PetscInt n = 0; b->formulation->node_fields[n]; n++) {
    b->node[n] = t->nnodes;
    for (PetscInt c = 0; c < MpmBuilderComponents(b, PETSC_TRUE, n); c++) {
      PetscCall(CheckRoom(t, t->nnodes, "node"));
      for (PetscInt axis = 0; axis < t->dim; axis++) t->parity[t->nnodes][axis] = ParityOf(b, n, c, axis);
      t->nnodes++;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The registers of a scratch field, if an operation has it. */
static PetscErrorCode AddScratch(MpmTableBuilder *b, PetscInt field)
{
  const MpmFormulation *f    = b->formulation;
  PetscBool             used = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt o = 0; o < f->nops; o++)
    if (f->ops[o].kind == MPM_SCALE && f->ops[o].dst == field) used = PETSC_TRUE;
  if (b->space->finite && f->particle_ranks[field] == MPM_TENSOR) PetscFunctionReturn(PETSC_SUCCESS);
  if (used) PetscCall(MpmBuilderScratches(b->table, MpmBuilderComponents(b, PETSC_FALSE, field), &b->particle[field]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   How far particles have gone in a step, where they move in its middle. It is named as the state is, and taken out of
   it.
*/
static PetscErrorCode AddGone(MpmTableBuilder *b)
{
  MpmTable *t = b->table;

  PetscFunctionBegin;
  b->gone = MPM_NONE;
  for (PetscInt o = 0; o < b->formulation->nops && b->gone == MPM_NONE; o++)
    if (b->formulation->ops[o].kind == MPM_MOVE_TO) b->gone = t->nstate;
  if (b->gone == MPM_NONE) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmBuilderAddComponents(t, "gone", MPM_NONE, MPM_VECTOR, PETSC_FALSE));
  t->nkept             = t->nstate - b->gone;
  t->nstate            = b->gone;
  t->fields[t->nstate] = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBuilderAddRegisters(MpmTableBuilder *b)
{
  MpmTable *t = b->table;

  PetscFunctionBegin;
  t->stretch = MPM_NONE;
  for (PetscInt f = 0; b->formulation->particle_fields[f]; f++)
    if (!b->formulation->scratch[f]) PetscCall(AddField(b, f));
  PetscCall(AddDisplacement(b));
  t->unfiltered = t->nstate;
  PetscCall(AddAffinePart(b));
  if (b->space->finite) PetscCall(AddGone(b));
  t->nparticles = MpmTableHeld(t);
  for (PetscInt f = 0; b->formulation->particle_fields[f]; f++)
    if (b->formulation->scratch[f]) PetscCall(AddScratch(b, f));
  if (b->space->finite) PetscCall(MpmFiniteAddScratch(b));
  PetscCall(AddNodes(b));
  PetscFunctionReturn(PETSC_SUCCESS);
}
