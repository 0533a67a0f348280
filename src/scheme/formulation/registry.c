/* The list of formulations, what they share, and the traits and numbers of operations. */
#include "scheme/formulation/closed_forms.h"
#include <mpmstab/transfer.h>
#include <math.h>
#include <string.h>

extern const MpmFormulation MpmGas1, MpmGas2, MpmElastic, MpmUsl, MpmUsf, MpmMusl, MpmUsavg, MpmVerlet, MpmRk,
    MpmImplicit;

const MpmFormulation *const MpmFormulations[] = {&MpmGas1,  &MpmGas2,   &MpmElastic, &MpmUsl,      &MpmUsf, &MpmMusl,
                                                 &MpmUsavg, &MpmVerlet, &MpmRk,      &MpmImplicit, NULL};

const MpmEnergyTerm MpmMomentumEnergy[2] = {{MPM_ON_PARTICLES, 0, PETSC_FALSE}, {MPM_ON_PARTICLES, 1, PETSC_TRUE}};

PetscReal MpmQuadraticRadius(double complex trace, double complex det)
{
  const double complex root = csqrt(trace * trace / 4 - det);

  return fmax(cabs(trace / 2 + root), cabs(trace / 2 - root));
}

const MpmFormulation *MpmFormulationFind(const char name[])
{
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    if (!strcmp(MpmFormulations[f]->name, name)) return MpmFormulations[f];
  return NULL;
}

const MpmOp *MpmFormulationLines(const MpmFormulation *f, const MpmSchemeNumbers *numbers, const MpmTransfer *transfer,
                                 MpmOp room[MPM_MOST_TABLE_LINES], PetscInt *n)
{
  const MpmSchemeNumbers usual = {.share = 0.5, .rk = MPM_RK_USUAL, .theta = 0.5, .move_share = f->move_share};

  *n = f->lines ? f->lines(numbers ? numbers : &usual, transfer, room) : f->nops;
  return f->lines ? room : f->ops;
}

PetscBool MpmFormulationReads(const MpmFormulation *formulation, const char option[])
{
  for (const char *const *reads = formulation->options; *reads; reads++)
    if (!strcmp(*reads, option)) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscBool MpmFormulationHas(const MpmFormulation *formulation, MpmOpKind kind)
{
  MpmOp        room[MPM_MOST_TABLE_LINES];
  PetscInt     n;
  const MpmOp *ops = MpmFormulationLines(formulation, NULL, NULL, room, &n);

  for (PetscInt o = 0; o < n; o++)
    if (ops[o].kind == kind) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Whether another operation takes the particle field of the first one to nodes by another map. */
static PetscBool Differ(const MpmOp *one, const MpmOp *other)
{
  return (other->kind == MPM_P2G || other->kind == MPM_DIV) && other->src == one->src && other->kind != one->kind
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* A scratch field stands for the field that it is set to: root. */
PetscBool MpmFormulationKeepsUnseen(const MpmFormulation *formulation)
{
  MpmOp        room[MPM_MOST_TABLE_LINES];
  PetscInt     n, root[MPM_MAX_FIELDS];
  const MpmOp *ops = MpmFormulationLines(formulation, NULL, NULL, room, &n);

  for (PetscInt f = 0; f < MPM_MAX_FIELDS; f++) root[f] = f;
  for (PetscInt o = 0; o < n; o++) {
    MpmOp op = ops[o];

    if (op.kind == MPM_SCALE || op.kind == MPM_ADD) {
      if (!formulation->scratch[op.dst] || (root[op.dst] != op.dst && op.src != op.dst && root[op.dst] != op.src))
        return PETSC_FALSE;
      if (op.kind == MPM_ADD) root[op.dst] = op.src;
    }
    if (op.kind != MPM_P2G && op.kind != MPM_DIV) continue;
    op.src = root[op.src];
    for (PetscInt other = 0; other < o; other++)
      if (Differ(&op, &ops[other])) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

MpmOpTraits MpmOpTraitsOf(MpmOpKind kind)
{
  static const MpmOpTraits traits[] = {
      [MPM_P2G]        = {.dst = MPM_ON_NODES, .src = MPM_ON_PARTICLES, .weight = MPM_MASS},
      [MPM_P2G_AFFINE] = {.dst = MPM_ON_NODES, .src = MPM_ON_PARTICLES, .weight = MPM_MASS},
      [MPM_DIV]        = {.dst = MPM_ON_NODES, .src = MPM_ON_PARTICLES, .weight = MPM_VOLUME},
      [MPM_DIV_MLS]    = {.dst = MPM_ON_NODES, .src = MPM_ON_PARTICLES, .weight = MPM_VOLUME},
      [MPM_CURVE] =
          {.dst = MPM_ON_NODES, .src = MPM_ON_PARTICLES, .weight = MPM_VOLUME, .first = MPM_DIV, .second = MPM_DIV},
      [MPM_CURVE_MLS] =
          {.dst = MPM_ON_NODES, .src = MPM_ON_PARTICLES, .weight = MPM_VOLUME, .first = MPM_DIV_MLS, .second = MPM_DIV},
      [MPM_G2P]          = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_NODES, .weight = MPM_MOBILITY},
      [MPM_G2P_AFFINE]   = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_NODES, .weight = MPM_MOBILITY},
      [MPM_GRAD]         = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_NODES, .weight = MPM_STIFFNESS},
      [MPM_GRAD_MLS]     = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_NODES, .weight = MPM_STIFFNESS},
      [MPM_G2P_SLOPE]    = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_NODES, .weight = MPM_MOBILITY},
      [MPM_STRESS]       = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_PARTICLES},
      [MPM_VISCOUS]      = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_PARTICLES},
      [MPM_STRESS_AHEAD] = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_PARTICLES},
      [MPM_LOAD]         = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_PARTICLES},
      [MPM_STRETCH]      = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_PARTICLES},
      [MPM_RETURN]       = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_PARTICLES},
      [MPM_SCALE]        = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_PARTICLES},
      [MPM_ADD]          = {.dst = MPM_ON_PARTICLES, .src = MPM_ON_PARTICLES},
      [MPM_LAP]          = {.dst = MPM_ON_NODES, .src = MPM_ON_NODES, .halo = 1, .stencil = {1, -2, 1}},
      [MPM_COPY]         = {.dst = MPM_ON_NODES, .src = MPM_ON_NODES, .stencil = {0, 1, 0}},
      [MPM_SOLVE]        = {.dst = MPM_ON_NODES, .src = MPM_ON_NODES},
      [MPM_IMPLICIT]     = {.dst = MPM_ON_NODES, .src = MPM_ON_NODES},
      [MPM_COLLIDE]      = {.dst = MPM_ON_NODES, .src = MPM_ON_NODES},
      [MPM_WALL]         = {.dst = MPM_ON_NODES, .src = MPM_ON_NODES},
      [MPM_LOCAL]        = {.dst = MPM_ON_NODES, .src = MPM_ON_NODES},
      [MPM_ADVANCE]      = {.dst = MPM_NOWHERE, .src = MPM_ON_PARTICLES},
      [MPM_DRIFT]        = {.dst = MPM_NOWHERE, .src = MPM_NOWHERE},
  };
  return traits[kind];
}

PetscBool MpmOpIsGather(const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  return traits.src == MPM_ON_NODES && traits.dst == MPM_ON_PARTICLES ? PETSC_TRUE : PETSC_FALSE;
}

MpmOpKind MpmKindAlongOfTwo(MpmOpKind kind, PetscInt axes, PetscInt direction)
{
  if (direction == MpmAxesFirst(axes)) return MpmOpTraitsOf(kind).first;
  return direction == MpmAxesSecond(axes) ? MpmOpTraitsOf(kind).second : MPM_P2G;
}

PetscReal MpmOpValue(const MpmOp *op, PetscReal courant)
{
  PetscReal value = op->factor;

  for (PetscInt power = 0; power < op->coefficient; power++) value *= courant;
  return value;
}
