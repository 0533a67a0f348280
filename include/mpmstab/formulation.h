/*
   A formulation is data: a table of linear operations, one per line of the algorithm as it is published.

   Readers of the table (march, assemble and symbol) know these operations and nothing of gas or
   bar. Source of the maps: Berzins, Kirby and Gritton, Stability Analysis of Material Point Method, 2013, and
   the papers named in each formulation's file.
*/
#pragma once
#include <mpmstab/compat.h>
#include <mpmstab/wave.h>

#define MPM_MAX_FIELDS 4 /* particle fields, and node fields, of one formulation */
#define MPM_NONE -1

/*E
   MpmOpKind - the maps between particles and nodes.

   MPM_P2G   - node      = sum_p phi_ip m_p particle / sum_p phi_ip m_p
   MPM_G2P   - particle += a sum_i phi_ip node
   MPM_GRAD  - particle += a h sum_i dphi_ip/dx node (hat basis: the node to the right minus the one to the left)
   MPM_LAP   - node      = a (f_{i+1} - 2 f_i + f_{i-1}) of another node field f
   MPM_ADD   - node     += another node field
   MPM_DRIFT - x_p      += U0 dt
E*/
typedef enum { MPM_P2G, MPM_G2P, MPM_GRAD, MPM_LAP, MPM_ADD, MPM_DRIFT } MpmOpKind;

/* Where an operation's operand lives. */
typedef enum { MPM_NOWHERE, MPM_ON_PARTICLES, MPM_ON_NODES } MpmPlace;

/*S
   MpmOpTraits - what a reader may ask of an operation without naming it.

   accumulates: the operation adds to its operand instead of replacing it. Between nodes the operation is a stencil:
   what the nodes at -1, 0 and 1 are multiplied with; halo is how far it reaches.
S*/
typedef struct {
  MpmPlace  dst, src;
  PetscBool accumulates;
  PetscInt  halo;
  PetscReal stencil[3];
} MpmOpTraits;

/* Not collective. The traits of an operation. */
MpmOpTraits MpmOpTraitsOf(MpmOpKind kind);

/* Factors that an operation may carry: 1, or the Courant number k = c dt / h. */
typedef enum { MPM_ONE, MPM_COURANT } MpmCoefficient;

/* One line of a formulation; dst and src index its particle or node fields. */
typedef struct {
  MpmOpKind      kind;
  PetscInt       dst, src;
  MpmCoefficient coefficient;
} MpmOp;

/* The vocabulary in which formulations are written. */
/* clang-format off */
#define P2G(node, particle)               {MPM_P2G, node, particle, MPM_ONE}
#define G2P(particle, node, coefficient)  {MPM_G2P, particle, node, MPM_##coefficient}
#define GRAD(particle, node, coefficient) {MPM_GRAD, particle, node, MPM_##coefficient}
#define LAP(node, other, coefficient)     {MPM_LAP, node, other, MPM_##coefficient}
#define ADD(node, other)                  {MPM_ADD, node, other, MPM_ONE}
#define DRIFT                             {MPM_DRIFT, MPM_NONE, MPM_NONE, MPM_ONE}
/* clang-format on */

/*
   The energy 1/2 int (...) dx as a sum of squares: of a particle field, or of a node field's difference over
   a cell. Both are in the units of the particle fields; velocity_unit of MpmWave makes velocities of them.
*/
typedef struct {
  MpmPlace place;
  PetscInt field;
} MpmEnergyTerm;

/*S
   MpmCellMoments - what a uniform layout at rest enters the closed forms with (theory: hat basis).

   e = C1 - C2 = 2 mean(xi) - 1, how far off-centre the particles sit; xi[] their places in the cell.
S*/
typedef struct {
  PetscReal        e;
  PetscInt         ppc;
  const PetscReal *xi;
} MpmCellMoments;

/*S
   MpmFormulation - a scheme: its fields, its table, its continuous problem and its closed forms.

   staggered names the particle field that is updated first in a step and so lags half a step in a
   second-order start, or MPM_NONE. published and corrected give abs(G) at the phase beta; they return NaN where
   the formula says nothing. published_slip says in a sentence what is wrong with the published one;
   published_centred: it also takes particles for centred, C1 = C2.
S*/
typedef struct {
  const char          *name, *summary, *reference;
  const char          *particle_fields[MPM_MAX_FIELDS + 1], *node_fields[MPM_MAX_FIELDS + 1];
  PetscInt             nops;
  const MpmOp         *ops;
  PetscInt             staggered;
  PetscInt             nenergy;
  const MpmEnergyTerm *energy;
  const MpmWave       *wave;
  const char          *published_text, *published_slip, *corrected_text;
  PetscBool            published_centred;
  PetscReal (*published)(PetscReal courant, PetscReal beta);
  PetscReal (*corrected)(const MpmCellMoments *cell, PetscReal courant, PetscReal beta);
} MpmFormulation;

/* Not collective. All formulations, NULL-terminated, in the order of the slides. */
extern const MpmFormulation *const MpmFormulations[];

/* Not collective. Looks a formulation up by name; NULL when there is none. */
const MpmFormulation *MpmFormulationFind(const char name[]);

/* Not collective. Number of particle fields and of node fields. */
PetscInt MpmFormulationParticleFields(const MpmFormulation *formulation);
PetscInt MpmFormulationNodeFields(const MpmFormulation *formulation);

/* Not collective. The value of a coefficient at a Courant number. */
PetscReal MpmCoefficientValue(MpmCoefficient coefficient, PetscReal courant);
