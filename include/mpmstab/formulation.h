/*
   A formulation is data: a table of linear operations, one for each line of the algorithm as it is published.

   March, operator and symbol each interpret such a table: one runs its operations, one assembles them to a matrix, one
   applies them to a Fourier mode. They know the operations and nothing of gas or bar. What they read is the
   formulation's table after transfer and boundary have been worked into it (see table.h).

   Source of the maps: Berzins, Kirby and Gritton, Stability Analysis of Material Point Method, 2013, and the papers
   named in each formulation's file.
*/
#pragma once
#include <mpmstab/compat.h>
#include <mpmstab/wave.h>
#include <complex.h>

/* How many particle registers a table may have, and how many node registers: fields and scratch together. */
#define MPM_MAX_FIELDS 64
#define MPM_NONE -1

/*E
   MpmOpKind - the operations of a table. a is the operation's factor times a power of the Courant number (MpmOpValue),
   and '=' becomes '+=' where the operation accumulates.

   From particles to nodes. The sum is divided by the nodal mass sum_p phi_ip m_p, and is 0 where there is no mass:
   MPM_P2G        - node = a sum_p phi_ip m_p particle
   MPM_P2G_AFFINE - node = a sum_p phi_ip m_p particle (x_i - x_p) / h
   MPM_DIV        - node = a h sum_p dphi_ip/dx V_p particle, the adjoint of GRAD

   From nodes to particles. These always accumulate:
   MPM_G2P        - particle += a sum_i phi_ip node
   MPM_G2P_AFFINE - particle += a sum_i phi_ip node (x_i - x_p) h / sum_i phi_ip (x_i - x_p)^2
   MPM_GRAD       - particle += a E_p h sum_i dphi_ip/dx node. For the hat basis that is the node to the right minus the
                    one to the left. E_p is the particle's stiffness over the first material's: 1 unless a bar has two.

   On particles, and on nodes. f is another node field:
   MPM_SCALE      - particle *= a
   MPM_LAP        - node = a (f_{i+1} - 2 f_i + f_{i-1})
   MPM_COPY       - node = a f; accumulating, it adds a f
   MPM_SOLVE      - node = a (P W)^+ f with P = P2G and W = G2P: the least y whose P2G G2P is f
   MPM_WALL       - node = a f at the wall node of one end (side) alone
   MPM_DRIFT      - x_p += U0 dt

   In the tables of formulations only. What they stand for depends on transfer and boundary (see table.h):
   MPM_FILTER     - particle = F particle, with the node field P2G of it: how the transfer renews particles
   MPM_IMPOSE     - node = 0 at fixed ends
   MPM_REACT      - the increment of a node field at fixed ends
E*/
typedef enum {
  MPM_P2G,
  MPM_P2G_AFFINE,
  MPM_DIV,
  MPM_G2P,
  MPM_G2P_AFFINE,
  MPM_GRAD,
  MPM_SCALE,
  MPM_LAP,
  MPM_COPY,
  MPM_SOLVE,
  MPM_WALL,
  MPM_DRIFT,
  MPM_FILTER,
  MPM_IMPOSE,
  MPM_REACT
} MpmOpKind;

#define MPM_OP_KINDS (MPM_DRIFT + 1) /* the kinds that the interpreters of a table meet */

/*E
   MpmProperty - what particles may differ in, in units of a particle of the first material that fills 1 / ppc of a
   cell.
E*/
typedef enum { MPM_NO_PROPERTY, MPM_MASS, MPM_VOLUME, MPM_STIFFNESS, MPM_PROPERTIES } MpmProperty;

/* Where an operation's operand lives. */
typedef enum { MPM_NOWHERE, MPM_ON_PARTICLES, MPM_ON_NODES } MpmPlace;

/*S
   MpmOpTraits - what an interpreter may ask of a kind of operation without naming it.

   dst and src say where its operands live. weight is the property of particles that multiplies what they give or get.
   An operation between nodes is a stencil: the numbers that multiply the nodes at -1, 0 and 1; halo is how far it
   reaches.
S*/
typedef struct {
  MpmPlace    dst, src;
  MpmProperty weight;
  PetscInt    halo;
  PetscReal   stencil[3];
} MpmOpTraits;

/* Not collective. The traits of a kind that the interpreters meet. */
MpmOpTraits MpmOpTraitsOf(MpmOpKind kind);

/* Names for the powers of the Courant number k = c dt / h that an operation carries; any other power may be given. */
enum { MPM_ONE, MPM_COURANT, MPM_COURANT_SQUARED };

/*S
   MpmOp - one line of a table.

   dst and src are numbers of particle or node registers; traits of the kind say which. axis is the direction that an
   operation acts along: DIV, GRAD, LAP, the affine maps and WALL have one, and in one dimension it is 0. accumulates
   says that the operation adds to dst instead of replacing it. The operation is multiplied with factor times the
   Courant number to the power coefficient. side is the end of the axis at which a WALL acts: 0 left, 1 right.
S*/
typedef struct {
  MpmOpKind kind;
  PetscInt  axis, dst, src;
  PetscBool accumulates;
  PetscInt  coefficient;
  PetscReal factor;
  PetscInt  side;
} MpmOp;

/* Not collective. An operation's number a at a Courant number: factor x courant^coefficient. */
PetscReal MpmOpValue(const MpmOp *op, PetscReal courant);

/*
   The vocabulary in which formulations and transfers are written. power is ONE, COURANT or COURANT_SQUARED.
*/
/* clang-format off */
#define P2G(node, particle)            {.kind = MPM_P2G, .dst = node, .src = particle, .factor = 1}
#define G2P(particle, node, power)     G2P_TIMES(particle, node, 1, power)
#define G2P_TIMES(particle, node, number, power)                                                                       \
  {.kind = MPM_G2P, .dst = particle, .src = node, .accumulates = PETSC_TRUE, .coefficient = MPM_##power,               \
   .factor = number}
#define GRAD(particle, node, power)    GRAD_TIMES(particle, node, 1, power)
#define GRAD_TIMES(particle, node, number, power)                                                                      \
  {.kind = MPM_GRAD, .dst = particle, .src = node, .accumulates = PETSC_TRUE, .coefficient = MPM_##power,              \
   .factor = number}
#define HALF_GRAD(particle, node, power) GRAD_TIMES(particle, node, 0.5, power)
#define MINUS_DIV(node, particle, power)                                                                               \
  {.kind = MPM_DIV, .dst = node, .src = particle, .coefficient = MPM_##power, .factor = -1}
#define LAP(node, other, power)        {.kind = MPM_LAP, .dst = node, .src = other, .coefficient = MPM_##power, .factor = 1}
#define SCALE(particle, number)        {.kind = MPM_SCALE, .dst = particle, .src = particle, .factor = number}
#define COPY(node, other)              {.kind = MPM_COPY, .dst = node, .src = other, .factor = 1}
#define ADD(node, other)               ADD_TIMES(node, other, 1)
#define ADD_TIMES(node, other, number) {.kind = MPM_COPY, .dst = node, .src = other, .accumulates = PETSC_TRUE, .factor = number}
#define SOLVE(node, other)             {.kind = MPM_SOLVE, .dst = node, .src = other, .factor = 1}
#define DRIFT                          {.kind = MPM_DRIFT, .dst = MPM_NONE, .src = MPM_NONE, .factor = 1}
#define FILTER(particle, node)         {.kind = MPM_FILTER, .dst = particle, .src = node, .factor = 1}
#define IMPOSE(node)                   {.kind = MPM_IMPOSE, .dst = node, .src = node}
#define REACT(node, imposed)           {.kind = MPM_REACT, .dst = node, .src = imposed}
/* clang-format on */

/*
   The energy 1/2 int (...) dx as a sum of squares: of a particle field, or of a node field's difference over
   a cell. Both are in the units of the particle fields; velocity_unit of MpmWave makes velocities of them.
   A particle's square counts by its mass, a stress's by volume over stiffness.
*/
typedef struct {
  MpmPlace  place;
  PetscInt  field;
  PetscBool stress;
} MpmEnergyTerm;

/*S
   MpmCellSymbols - what a uniform layout at rest enters the closed forms with, at a phase beta.

   alpha: symbol of P2G G2P, the mean over a cell's particles of abs(phi symbol)^2. kappa: of -DIV GRAD, the mean of
   abs(h GRAD symbol)^2. mu: of P2G GRAD; for the hat mu = e (1 - cos beta) + i sin beta, e = C1 - C2 = 2 mean(xi) - 1.
   retained: what of a node field's mode is left when its particles have been through the transfer's filter (flip: 1).
S*/
typedef struct {
  PetscReal      beta, alpha, kappa, retained;
  double complex mu;
} MpmCellSymbols;

/*S
   MpmFormulation - a scheme: its fields, its table, its continuous problem and its closed forms.

   staggered names the particle field that is updated first in a step and so lags half a step in a second-order start,
   or MPM_NONE. affine: the field that transfers with an affine part give one to, or MPM_NONE. conserved: the particle
   field whose sum over masses no step changes without walls, or MPM_NONE. free_ends: whether an end may be left free.
   materials: whether particles may differ in density and stiffness. published (NULL: the slides do not treat it) and
   corrected give abs(G) at a phase; published returns NaN where the formula says nothing. published_slip says in a
   sentence what is wrong with the published one; published_centred: it also takes particles for centred, C1 = C2.
   limit is the largest stable Courant number at a phase, infinite where there is none.
S*/
typedef struct {
  const char          *name, *summary, *reference;
  const char          *particle_fields[MPM_MAX_FIELDS + 1], *node_fields[MPM_MAX_FIELDS + 1];
  PetscInt             nops;
  const MpmOp         *ops;
  PetscInt             staggered, affine, conserved;
  PetscBool            free_ends, materials;
  PetscInt             nenergy;
  const MpmEnergyTerm *energy;
  const MpmWave       *wave;
  PetscReal            published_limit; /* up to which the slides say it is stable; 0: never */
  const char          *published_text, *published_slip, *corrected_text, *limit_text;
  PetscBool            published_centred;
  PetscReal (*published)(PetscReal courant, PetscReal beta);
  PetscReal (*corrected)(const MpmCellSymbols *cell, PetscReal courant);
  PetscReal (*limit)(const MpmCellSymbols *cell);
} MpmFormulation;

/* Not collective. All formulations, NULL-terminated, in the order of the slides. */
extern const MpmFormulation *const MpmFormulations[];

/* Not collective. Looks a formulation up by name; NULL when there is none. */
const MpmFormulation *MpmFormulationFind(const char name[]);

/* Not collective. Whether a formulation's table has an operation of a kind. */
PetscBool MpmFormulationHas(const MpmFormulation *formulation, MpmOpKind kind);
