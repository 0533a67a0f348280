/*
   What a step costs and does at most: the bytes that it moves between memory and processor, and the factor by which it
   can enlarge the state.

   Each array is read once a pass, and written once if the pass changes it. An array that is only written is read too,
   because the processor fetches a line before it changes a part of it. Each operation on nodes is a sweep of its own.
*/
#include "march/passes.h"
#include <math.h>
#include <stdint.h>

typedef struct {
  uint64_t reads, writes; /* masks over fields */
} Touched;

_Static_assert(MPM_MAX_FIELDS <= 64, "a mask has 64 bits");

static uint64_t Bit(PetscInt field)
{
  return (uint64_t)1 << field;
}

static PetscReal Bytes(uint64_t mask)
{
  PetscReal bytes = 0;

  for (; mask; mask &= mask - 1) bytes += sizeof(PetscReal);
  return bytes;
}

static void TouchPass(const MpmLayout *layout, const MpmPass *pass, Touched *particle, Touched *node, uint64_t *weights)
{
  for (const MpmOp *op = pass->op; op < pass->op + pass->nops; op++) {
    const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
    const MpmProperty weight = MpmLayoutWeight(layout, op->kind, op->side);

    if (traits.dst == MPM_NOWHERE) continue;
    if (traits.src == MPM_ON_PARTICLES && op->kind != MPM_SCALE) particle->reads |= Bit(op->src);
    if (traits.src == MPM_ON_NODES) node->reads |= Bit(op->src);
    if (traits.dst == MPM_ON_PARTICLES) {
      particle->reads |= Bit(op->dst);
      particle->writes |= Bit(op->dst);
    } else
      node->writes |= Bit(op->dst);
    if (weight && traits.dst != traits.src) *weights |= Bit(weight);
  }
}

/* Adds the bytes of a pass, without the places of particles. Masses are read where something is summed. */
static void AddPass(const MpmTable *t, const MpmLayout *layout, const MpmSchedule *s, const MpmPass *pass,
                    PetscReal *of_particle, PetscReal *of_node)
{
  Touched  particle = {0}, node = {0};
  uint64_t weights = 0;

  TouchPass(layout, pass, &particle, &node, &weights);
  for (PetscInt o = 0; o < pass->nnode_ops; o++)
    if (pass->node_op[o].kind != MPM_WALL) *of_node += 3 * sizeof(PetscReal);     /* reads one, changes another */
  for (PetscInt f = t->nstate; f < t->nparticles; f++) particle.reads &= ~Bit(f); /* scratch fields stay in the cache */
  particle.writes &= particle.reads;
  *of_particle += Bytes(particle.reads) + Bytes(particle.writes) + Bytes(weights);
  *of_node += Bytes(node.reads | node.writes) + Bytes(node.writes);
  for (PetscInt f = 0; f < t->nnodes; f++)
    if (s->spare[f] && node.writes & Bit(f)) *of_node += Bytes(node.reads & Bit(f)); /* into another array */
  if (pass->nsums) *of_node += sizeof(PetscReal) * (pass->mass != MPM_NONE ? 2 : 1);
}

PetscReal MpmScheduleBytes(const MpmTable *table, const MpmLayout *layout, const MpmSchedule *schedule,
                           PetscReal particles_per_node, PetscBool alike)
{
  PetscReal of_particle = 0, of_node = 0;

  if (MpmTableSolves(table) || MpmTableIsFinite(table)) return NAN;
  for (PetscInt p = 0; p < schedule->npasses; p++) {
    AddPass(table, layout, schedule, &schedule->pass[p], &of_particle, &of_node);
    if (!alike) of_particle += sizeof(PetscInt) + sizeof(PetscReal);
  }
  return of_particle + of_node / particles_per_node;
}

/* The maximum norm of an operation whose number a is 1. */
static PetscReal NormOf(MpmOpKind kind, const MpmBasis *basis, PetscInt dim, PetscInt ppc, PetscReal least_mass)
{
  PetscReal cells = 1; /* in which a node has particles: as many as a particle has nodes */

  for (PetscInt a = 0; a < dim; a++) cells *= MpmMapReach(basis);
  switch (kind) {
  case MPM_DIV:
  case MPM_DIV_MLS:
    return basis->slope_sum * ppc * cells / least_mass;
  case MPM_CURVE:
  case MPM_CURVE_MLS: /* along two axes the product of two slopes */
    return PetscMax(basis->curve_sum, PetscSqr(basis->slope_sum)) * ppc * cells / least_mass;
  case MPM_GRAD:
  case MPM_GRAD_MLS:
  case MPM_G2P_SLOPE:
  case MPM_G2P_AFFINE: /* at most the largest gradient on a particle's nodes */
    return basis->slope_sum;
  case MPM_LAP:
    return 4;
  case MPM_SOLVE:    /* with G2P after it, it is a projection; P W has rarely an eigenvalue below 1/100 */
  case MPM_IMPLICIT: /* it is a contraction in the nodal masses, which rarely differ by more than 100 squared */
    return 100;
  default:
    return 1;
  }
}

PetscReal MpmScheduleBound(const MpmTable *t, const MpmBasis *basis, PetscReal courant, PetscInt ppc,
                           PetscReal least_mass, PetscReal stiffness)
{
  PetscReal particle[MPM_MAX_FIELDS], node[MPM_MAX_FIELDS], bound = 1;

  for (PetscInt i = 0; i < MPM_MAX_FIELDS; i++) particle[i] = node[i] = 1;
  for (PetscInt o = 0; o < t->nops; o++) {
    const MpmOp      *op     = &t->ops[o];
    const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
    PetscReal        *dst, from;

    if (traits.dst == MPM_NOWHERE) continue;
    dst  = traits.dst == MPM_ON_NODES ? &node[op->dst] : &particle[op->dst];
    from = traits.src == MPM_ON_NODES ? node[op->src] : particle[op->src];
    from *= PetscAbsReal(MpmOpValue(op, courant)) * NormOf(op->kind, basis, t->dim, ppc, least_mass);
    if (traits.weight == MPM_STIFFNESS) from *= stiffness;
    if (op->kind == MPM_WALL)
      *dst = PetscMax(*dst, from);
    else
      *dst = from + (op->accumulates ? *dst : 0);
  }
  for (PetscInt i = 0; i < t->nstate; i++) bound = PetscMax(bound, particle[i]);
  return bound;
}
