/*
   Damping and viscosity, which any formulation with a force of a stress may have. Where it makes the force

     a_i = - k DIV s        of a step or of a stage whose grid has the velocity v_i,

   the table has

     q_p = lambda tr(D) I + 2 mu D,    D the symmetric part of GRAD v_i        viscous stress, scratch
     a_i = - k DIV (s + q) - alpha k v_i

   and, with local damping, a_i -= beta abs(a_i) sign(v_i) of each component after that, with lambda and mu in units of
   rho c h, and alpha in units of c / h. v_i is the node field that the formulation has set last before, by P2G or from
   other nodes. So all is explicit, and at the places of the start of the step.

   usf, musl and usavg take their strain from this velocity, too, so that the stress and its viscous part belong to one
   velocity. usl takes the strain of the step before from v_i + a_i.

   Source: Landau and Lifshitz 1986, section 34 (viscosity of solids); Nairn 2003 and Uintah subtract alpha v_i from the
   acceleration of nodes; Cundall 1987 (local damping).
*/
#include "scheme/table_builder.h"
#include <mpmstab/errors.h>

static PetscBool IsForce(const MpmFormulation *f, PetscInt o)
{
  const MpmOp *op = &f->ops[o];

  return o < f->nops && op->kind == MPM_DIV && f->particle_ranks[op->src] == MPM_TENSOR &&
                 f->node_ranks[op->dst] == MPM_VECTOR
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* The line that has set the velocity of the grid last before a force, or MPM_NONE. */
static PetscInt VelocityLine(const MpmFormulation *f, PetscInt force)
{
  for (PetscInt o = force - 1; o >= 0; o--) {
    const MpmOp *op = &f->ops[o];

    if ((op->kind == MPM_P2G || op->kind == MPM_COPY) && f->node_ranks[op->dst] == MPM_VECTOR &&
        op->dst != f->ops[force].dst)
      return o;
  }
  return MPM_NONE;
}

/*
   The force whose viscous stress is to be made before a line: that line itself, or where a scratch stress begins the
   force that it is for. Scratch lives for one pass over the particles, and a transfer may need passes to sharpen the
   velocity.
*/
static PetscInt ForceOf(const MpmFormulation *f, PetscInt o)
{
  const MpmOp *op = &f->ops[o];

  if (IsForce(f, o)) return f->scratch[op->src] ? MPM_NONE : o;
  if (op->kind != MPM_SCALE || op->factor != 0 || !f->scratch[op->dst]) return MPM_NONE;
  for (PetscInt force = o + 1; force < f->nops; force++)
    if (IsForce(f, force) && f->ops[force].src == op->dst) return force;
  return MPM_NONE;
}

static PetscInt Component(const MpmTableBuilder *b, PetscInt a, PetscInt c)
{
  return b->viscous + (b->space->viscous[1] == 0 ? 0 : MpmStressComponent(b->space->dim, a, c));
}

/* The slopes of the velocity, for a material with a viscous stress (table_finite.c). */
static PetscErrorCode Rate(MpmTableBuilder *b, PetscInt v)
{
  static const MpmOp slope = {.kind = MPM_G2P_SLOPE, .accumulates = PETSC_TRUE, .factor = 1};
  const PetscInt     dim   = b->space->dim;

  PetscFunctionBegin;
  PetscCall(MpmBuilderSharpenAll(b, v, dim));
  if (b->rate == MPM_NONE) PetscCall(MpmBuilderScratches(b->table, dim * dim, &b->rate));
  PetscCall(MpmBuilderClear(b->table, dim * dim, b->rate));
  PetscCall(MpmBuilderSlopes(b, &slope, b->rate, v));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* q_ac += number times the slope along axis of a component of the velocity */
static PetscErrorCode Add(MpmTableBuilder *b, PetscInt q, PetscInt velocity, PetscInt axis, PetscReal number)
{
  static const MpmOp slope = {.kind = MPM_G2P_SLOPE, .accumulates = PETSC_TRUE, .factor = 1};

  PetscFunctionBegin;
  if (number != 0) PetscCall(MpmBuilderTerm(b, &slope, q, velocity, axis, number, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Without mu, and in one dimension, the stress is one number. */
static PetscErrorCode Stress(MpmTableBuilder *b, PetscInt v)
{
  const PetscReal lambda = b->space->viscous[0], mu = b->space->viscous[1];
  const PetscInt  dim = b->space->dim, n = mu == 0 ? 1 : dim * (dim + 1) / 2;

  PetscFunctionBegin;
  PetscCall(MpmBuilderSharpenAll(b, v, dim));
  if (b->viscous == MPM_NONE) PetscCall(MpmBuilderScratches(b->table, n, &b->viscous));
  PetscCall(MpmBuilderClear(b->table, n, b->viscous));
  for (PetscInt a = 0; a < dim; a++) {
    for (PetscInt c = 0; c < dim && n > 1; c++)
      PetscCall(Add(b, Component(b, a, a), v + c, c, lambda + (c == a ? 2 * mu : 0)));
    if (n == 1) PetscCall(Add(b, b->viscous, v + a, a, lambda + 2 * mu));
    for (PetscInt c = a + 1; c < dim; c++) {
      PetscCall(Add(b, Component(b, a, c), v + a, c, mu));
      PetscCall(Add(b, Component(b, a, c), v + c, a, mu));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDampingBefore(MpmTableBuilder *b, PetscInt o)
{
  const MpmFormulation *f      = b->formulation;
  const PetscBool       linear = b->space->viscous[0] != 0 || b->space->viscous[1] != 0 ? PETSC_TRUE : PETSC_FALSE;
  PetscInt              force, velocity;

  PetscFunctionBegin;
  if (!linear && !MpmMaterialIsViscous(&b->space->material)) PetscFunctionReturn(PETSC_SUCCESS);
  force = ForceOf(f, o);
  if (force == MPM_NONE || f->ops[force].accumulates) PetscFunctionReturn(PETSC_SUCCESS);
  velocity = VelocityLine(f, force);
  MpmCheckInput(
      velocity != MPM_NONE && velocity < o,
      "%s: viscosity needs the velocity of the grid before a stress begins that a force is made of, and here it "
      "comes later or never; allowed: without viscosity, or rk_on nodes",
      b->table->where);
  if (linear) PetscCall(Stress(b, b->node[f->ops[velocity].dst]));
  if (MpmMaterialIsViscous(&b->space->material)) PetscCall(Rate(b, b->node[f->ops[velocity].dst]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDampingAfter(MpmTableBuilder *b, PetscInt o)
{
  const MpmFormulation *f  = b->formulation;
  const MpmOp          *op = &f->ops[o];
  PetscInt              velocity;

  PetscFunctionBegin;
  if (!MpmSpaceIsDamped(b->space) || !IsForce(f, o) || op->accumulates) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < b->space->dim && b->viscous != MPM_NONE; a++)
    for (PetscInt axis = 0; axis < b->space->dim; axis++)
      if (b->space->viscous[1] != 0 || axis == a)
        PetscCall(MpmBuilderTerm(b, op, b->node[op->dst] + a, Component(b, a, axis), axis, 1, PETSC_TRUE));
  velocity = VelocityLine(f, o);
  if (b->space->damping == 0 && b->space->local == 0) PetscFunctionReturn(PETSC_SUCCESS);
  MpmCheckInput(
      velocity != MPM_NONE && !(IsForce(f, o + 1) && f->ops[o + 1].dst == op->dst),
      "%s: damping needs a force that one line makes, and the velocity of the grid before it; allowed: without "
      "grid_damping and local_damping",
      b->table->where);
  for (PetscInt a = 0; a < b->space->dim; a++) {
    const PetscInt force = b->node[op->dst] + a, v = b->node[f->ops[velocity].dst] + a;
    MpmOp          lost = ADD_TIMES(force, v, op->factor * b->space->damping);

    lost.coefficient = op->coefficient;
    if (b->space->damping != 0) PetscCall(MpmTableAppendOwn(b->table, lost));
    if (b->space->local != 0)
      PetscCall(
          MpmTableAppendOwn(b->table, (MpmOp){.kind = MPM_LOCAL, .dst = force, .src = v, .factor = b->space->local}));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
