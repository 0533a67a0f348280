/*
   The bytes that a step moves between memory and processor.

   Each array is read once a pass, and written once if the pass changes it. An array that is only written is read too,
   because the processor fetches a line before it changes a part of it. Each operation on nodes is a sweep of its own.
*/
#include "march/traffic.h"
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

static void TouchPass(const MpmPass *pass, Touched *particle, Touched *node, uint64_t *weights)
{
  for (const MpmPassOp *op = pass->op; op < pass->op + pass->nops; op++) {
    if (op->kind == MPM_PASS_DRIFT || op->kind == MPM_PASS_SAMPLE) continue;
    particle->reads |= Bit(op->particle);
    if (!op->to_nodes) particle->writes |= Bit(op->particle);
    if (op->kind == MPM_PASS_ADD) particle->reads |= Bit(op->other);
    if (op->kind == MPM_PASS_SCALE || op->kind == MPM_PASS_ADD) continue;
    if (op->to_nodes)
      node->writes |= Bit(op->node);
    else
      node->reads |= Bit(op->node);
    if (op->weight) *weights |= Bit(op->weight);
  }
}

/* Adds the bytes of a pass, without the places of particles. Masses are read where something is summed. */
static void AddPass(const MpmTable *t, const MpmSchedule *s, const MpmPass *pass, PetscReal *of_particle,
                    PetscReal *of_node)
{
  Touched  particle = {0}, node = {0};
  uint64_t weights = 0;

  TouchPass(pass, &particle, &node, &weights);
  for (PetscInt o = 0; o < pass->nnode_ops; o++)
    if (pass->node_op[o].kind != MPM_WALL) *of_node += 3 * sizeof(PetscReal);     /* reads one, changes another */
  for (PetscInt f = t->nstate; f < t->nparticles; f++) particle.reads &= ~Bit(f); /* scratch fields stay in the cache */
  particle.writes &= particle.reads;
  *of_particle += Bytes(particle.reads) + Bytes(particle.writes) + Bytes(weights);
  *of_node += Bytes(node.reads | node.writes) + Bytes(node.writes);
  for (PetscInt f = 0; f < t->nnodes; f++)
    if (s->spare[f] && node.writes & Bit(f)) *of_node += Bytes(node.reads & Bit(f)); /* into another array */
  if (pass->nsums) *of_node += sizeof(PetscReal) * (pass->sums_mass ? 2 : 1);
}

PetscReal MpmScheduleBytes(const MpmTable *table, const MpmSchedule *schedule, PetscReal particles_per_node,
                           PetscBool alike)
{
  PetscReal of_particle = 0, of_node = 0;

  if (MpmTableSolves(table) || MpmTableIsFinite(table)) return NAN;
  for (PetscInt p = 0; p < schedule->npasses; p++) {
    AddPass(table, schedule, &schedule->pass[p], &of_particle, &of_node);
    if (!alike) of_particle += sizeof(PetscInt) + sizeof(PetscReal);
  }
  return of_particle + of_node / particles_per_node;
}
