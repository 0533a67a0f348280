/*
   A formulation is data: a table of linear operations, one for each line of the algorithm as it is published.

   March, operator and symbol each interpret such a table. The march runs its operations, the operator assembles them to
   a matrix, and the symbol applies them to a Fourier mode. They know the operations and nothing of gas or bar. Each of
   them takes the formulation's table after MpmTableCreate has added transfer and boundary (see table.h).

   Source of the maps: Berzins, Kirby and Gritton, Stability Analysis of Material Point Method, 2013, and the papers
   named in each formulation's file.
*/
#pragma once
#include <mpmstab/compat.h>
#include <mpmstab/wave.h>
#include <complex.h>

/* The largest number of particle registers of a table, and of its node registers. Scratch counts too. */
#define MPM_MAX_FIELDS 64

/*E
   MpmOpKind - the operations of a table. a is the operation's factor times a power of the Courant number (MpmOpValue).
   Where the operation accumulates, '=' becomes '+='.

   From particles to nodes. The sum is divided by the nodal mass sum_p phi_ip m_p, and is 0 where there is no mass:
   MPM_P2G        - node = a sum_p phi_ip m_p particle
   MPM_P2G_AFFINE - node = a sum_p phi_ip m_p particle (x_i - x_p) / h
   MPM_DIV        - node = a h sum_p dphi_ip/dx V_p particle, the adjoint of GRAD
   MPM_DIV_MLS    - node = a sum_p phi_ip (x_i - x_p) h / D_p V_p particle, the adjoint of GRAD_MLS
   MPM_CURVE      - node = a h^2 sum_p d2phi_ip/dx_b dx_c V_p particle: the force that a prestress makes of
                    displacements
   MPM_CURVE_MLS  - the same with the slopes along c of the weights that DIV_MLS has along b

   From nodes to particles. These always accumulate:
   MPM_G2P        - particle += a sum_i phi_ip node
   MPM_G2P_AFFINE - particle += a sum_i phi_ip node (x_i - x_p) h / sum_i phi_ip (x_i - x_p)^2
   MPM_GRAD       - particle += a E_p h sum_i dphi_ip/dx node. For the hat basis that is the node to the right minus the
                    one to the left. E_p is the particle's stiffness over the first material's: 1 unless a bar has two.
   MPM_GRAD_MLS   - particle += a E_p sum_i phi_ip (x_i - x_p) h / D_p node, with D_p = sum_i phi_ip (x_i - x_p)^2: the
                    gradient of the affine field that fits the nodes best (Hu et al. 2018). For hats it is GRAD.
   MPM_G2P_SLOPE  - particle += a h sum_i dphi_ip/dx node: GRAD without the stiffness, for the slopes of a velocity

   P2G_AFFINE, DIV, LAP, G2P_AFFINE, G2P_SLOPE, GRAD and WALL act along an axis: dx and (x_i - x_p) are of that
   direction. CURVE and CURVE_MLS act along one axis or two (MpmAxes).

   On particles, at finite deformation (table_finite.c); dst and src are the first registers of theirs:
   MPM_STRESS     - tau = tau(F), the Kirchhoff stress of the material in units of rho0 c0^2, times E_p
   MPM_VISCOUS    - tau += the viscous stress of the velocity's slopes L, which are src (MpmMaterialViscous); a is rho
                    c^2 / (rho0 c0^2)
   MPM_STRESS_AHEAD - T = P(A F) F^T with A = I + a L, P the nominal stress: the stress at a part a of a step with the
                    slopes L, brought back to its start (scheme/deform.h); L is src, and T has dim rows of dim numbers
   MPM_LOAD       - b = the body force per mass at the particle's place at rest, in units of c^2 / h, at a part a of the
                    step
   MPM_STRETCH    - F <- (I + L + a L L) F, a the factor: 0, or 1/2 in steps of several stages
   MPM_RETURN     - F and the internal variables after it <- what MpmMaterialReturn makes of them; src is dst
   MPM_ADVANCE    - x_p += particle, in cells. The maps after it are those of the new places. Particles are then at a
                    part a of the step: 1 at its end

   On particles, and on nodes. f is another field; a COPY may also be of a node field to itself, which multiplies it:
   MPM_SCALE      - particle *= a
   MPM_ADD        - particle += a f, f a particle field
   MPM_LAP        - node = a (f_{i+1} - 2 f_i + f_{i-1})
   MPM_COPY       - node = a f
   MPM_SOLVE      - node = a (P W)^+ f with P = P2G and W = G2P: the least y whose P2G G2P is f
   MPM_IMPLICIT   - node = (1 + a K)^-1 node of a vector, K = DIV STRESS GRAD, whose lines are a table of its own
                    (table.h). There is an operation for each component, one after the other, with axis as the number of
                    the component: the first of them solves for all, so that interpreters pass over the others. At
                    finite deformation it is the a_i with a_i = f(a_i), where the table of its own has the lines of f
                    (MpmTable).
   MPM_COLLIDE    - node += component axis of P(u) - u at the nodes inside colliders, P what they make of a velocity;
                    src is that component of u, whose others are next to it
   MPM_WALL       - node = a f at the wall node of one end (side) alone
   MPM_LOCAL      - node -= a abs(node) sign(f), which is not linear
   MPM_DRIFT      - x_p += U0 dt

   In the tables of formulations only. MpmTableCreate replaces them by operations that depend on transfer and boundary:
   MPM_FILTER     - particle = F particle, with the node field P2G of it: how the transfer renews particles
   MPM_FILTER_BEFORE, MPM_FILTER_AFTER - the same where the filter of the space is before, or after the step takes the
                    nodal values of the field; nothing where it is not
   MPM_MOVE       - x += a k sum_i phi_ip node, x the displacement of particles in cells: with a prestress alone, else
                    nothing. Node fields whose sum is the grid's velocity have one each, and a is the share of each.
   MPM_MOVE_PROJECTED - takes the place of all MOVE where particles move with the projected velocity
   MPM_MOVE_TO    - x = x of the start of the step + a k sum_i phi_ip node, in the middle of a step, at finite
                    deformation: the maps after it are those of the new places. DRIFT then starts from there, too. At
                    small strain nothing
   MPM_IMPOSE     - node = 0 at fixed ends
   MPM_REACT      - node = 0 at fixed ends, or the reaction of the wall: its new value minus its value before the wall
                    was imposed
E*/
typedef enum {
  MPM_P2G,
  MPM_P2G_AFFINE,
  MPM_DIV,
  MPM_DIV_MLS,
  MPM_CURVE,
  MPM_CURVE_MLS,
  MPM_G2P,
  MPM_G2P_AFFINE,
  MPM_GRAD,
  MPM_GRAD_MLS,
  MPM_G2P_SLOPE,
  MPM_STRESS,
  MPM_VISCOUS,
  MPM_STRESS_AHEAD,
  MPM_LOAD,
  MPM_STRETCH,
  MPM_RETURN,
  MPM_SCALE,
  MPM_ADD,
  MPM_LAP,
  MPM_COPY,
  MPM_SOLVE,
  MPM_IMPLICIT,
  MPM_COLLIDE,
  MPM_WALL,
  MPM_LOCAL,
  MPM_ADVANCE,
  MPM_DRIFT,
  MPM_FILTER,
  MPM_FILTER_BEFORE,
  MPM_FILTER_AFTER,
  MPM_MOVE,
  MPM_MOVE_PROJECTED,
  MPM_MOVE_TO,
  MPM_IMPOSE,
  MPM_REACT
} MpmOpKind;

#define MPM_OP_KINDS (MPM_DRIFT + 1) /* the number of kinds that occur in an MpmTable */

/*E
   MpmProperty - a property in which particles may differ. Its unit is that of a particle of the first material that
   fills 1 / ppc of a cell. MPM_MOBILITY multiplies what a particle gets by G2P: 0 for one that is held, else 1.
   MPM_STIFFNESS is lambda + 2 mu; where Poisson's ratio varies, too, MPM_LAMBDA and MPM_SHEAR, which is mu, are over the
   same unit.
E*/
typedef enum {
  MPM_NO_PROPERTY,
  MPM_MASS,
  MPM_VOLUME,
  MPM_STIFFNESS,
  MPM_LAMBDA,
  MPM_SHEAR,
  MPM_MOBILITY,
  MPM_PROPERTIES
} MpmProperty;

/* The place of a register that an operation reads or writes. */
typedef enum { MPM_NOWHERE, MPM_ON_PARTICLES, MPM_ON_NODES } MpmPlace;

/*S
   MpmOpTraits - the traits of a kind of operation. An interpreter of a table can ask for them without naming the kind.

   dst, src - the places of the registers that the operation writes and reads
   weight   - the property of particles that multiplies what they give or get
   first, second - of a map along two different axes: the kinds of operation whose weights it has along either
   stencil  - of an operation between nodes: the numbers that multiply the nodes at -1, 0 and 1
   halo     - the reach of the stencil, in nodes
S*/
typedef struct {
  MpmPlace    dst, src;
  MpmProperty weight;
  MpmOpKind   first, second;
  PetscInt    halo;
  PetscReal   stencil[3];
} MpmOpTraits;

/* Not collective. The traits of a kind that occurs in an MpmTable. */
MpmOpTraits MpmOpTraitsOf(MpmOpKind kind);

/*
   Axes - the direction or the two directions that an operation acts along, as one number: an axis stands for itself,
   and two different ones for a number from MPM_MAX_DIM on. The second derivative along b and c has axes (b, c); with
   the weights of DIV_MLS b is the direction of these, and c that of their slope.

   Not collective. MpmAxes makes the number, MpmAxesFirst and MpmAxesSecond take it apart.
*/
#define MPM_AXES (MPM_MAX_DIM * MPM_MAX_DIM)
static inline PetscInt MpmAxes(PetscInt first, PetscInt second)
{
  return first + MPM_MAX_DIM * ((second - first + MPM_MAX_DIM) % MPM_MAX_DIM);
}
static inline PetscInt MpmAxesFirst(PetscInt axes)
{
  return axes % MPM_MAX_DIM;
}
static inline PetscInt MpmAxesSecond(PetscInt axes)
{
  return (axes % MPM_MAX_DIM + axes / MPM_MAX_DIM) % MPM_MAX_DIM;
}

/*
   MpmKindAlong - the kind of operation whose weights a map has along one direction: the weights of a map are products
   of those over the directions. It is P2G, with the weights phi_ip, in directions that the map does not act along.

   Not collective. MpmKindAlongOfTwo is MpmKindAlong for two different axes.
*/
MpmOpKind               MpmKindAlongOfTwo(MpmOpKind kind, PetscInt axes, PetscInt direction);
static inline MpmOpKind MpmKindAlong(MpmOpKind kind, PetscInt axes, PetscInt direction)
{
  if (axes < MPM_MAX_DIM) return direction == axes ? kind : MPM_P2G;
  return MpmKindAlongOfTwo(kind, axes, direction);
}

/* Names for powers of the Courant number k = c dt / h. An operation may carry any other power too. */
enum { MPM_ONE, MPM_COURANT, MPM_COURANT_SQUARED };

/*S
   MpmOp - one line of a table.

   axis        - the direction that DIV, GRAD, LAP, the affine maps and WALL act along, or the two of CURVE (MpmAxes);
                 formulations leave it at 0
   dst, src    - the numbers of the registers that it writes and reads; the traits of the kind say whether they are
                 registers of particles or of nodes
   accumulates - the operation adds to dst instead of replacing it
   coefficient - the power of the Courant number that multiplies the operation
   factor      - the number that multiplies the operation besides
   side        - the end of the axis at which a WALL acts: 0 left, 1 right. Of GRAD the modulus that multiplies it where
                 Poisson's ratio varies: 0 lambda + 2 mu, 1 lambda, 2 mu
S*/
typedef struct {
  MpmOpKind kind;
  PetscInt  axis, dst, src;
  PetscBool accumulates;
  PetscInt  coefficient;
  PetscReal factor;
  PetscInt  side;
} MpmOp;

/* Not collective. Whether an operation takes values of nodes to particles. */
PetscBool MpmOpIsGather(const MpmOp *op);

/* Not collective. The number a of an operation: factor times the Courant number to the power coefficient. */
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
#define IMPLICIT(node, number, power)  {.kind = MPM_IMPLICIT, .dst = node, .src = node, .coefficient = MPM_##power, .factor = number}
#define DRIFT                          {.kind = MPM_DRIFT, .dst = MPM_NONE, .src = MPM_NONE, .factor = 1}
#define FILTER(particle, node)         {.kind = MPM_FILTER, .dst = particle, .src = node, .factor = 1}
#define FILTER_BEFORE(particle, node)  {.kind = MPM_FILTER_BEFORE, .dst = particle, .src = node, .factor = 1}
#define FILTER_AFTER(particle, node)   {.kind = MPM_FILTER_AFTER, .dst = particle, .src = node, .factor = 1}
#define MOVE(node)                     MOVE_TIMES(node, 1)
#define MOVE_TIMES(node, number)       {.kind = MPM_MOVE, .dst = MPM_NONE, .src = node, .factor = number}
#define MOVE_PROJECTED(node)           {.kind = MPM_MOVE_PROJECTED, .dst = MPM_NONE, .src = node, .factor = 1}
#define MOVE_TO(node, number)          {.kind = MPM_MOVE_TO, .dst = MPM_NONE, .src = node, .factor = number}
#define IMPOSE(node)                   {.kind = MPM_IMPOSE, .dst = node, .src = node}
#define REACT(node, imposed)           {.kind = MPM_REACT, .dst = node, .src = imposed}
/* clang-format on */

/*E
   MpmRank - what a field of a formulation is at a place: a number, a vector of dim components, or a symmetric stress of
   dim (dim + 1) / 2. In one dimension all three are a number.

   A stress with a Poisson ratio of 1/2 is that of a fluid. It is the pressure alone, one number.
E*/
typedef enum { MPM_SCALAR, MPM_VECTOR, MPM_TENSOR } MpmRank;

#define MPM_MAX_STRESS (MPM_MAX_DIM * (MPM_MAX_DIM + 1) / 2)

/* Not collective. The number of the component ab of a stress in dim dimensions. */
static inline PetscInt MpmStressComponent(PetscInt dim, PetscInt a, PetscInt b)
{
  const PetscInt least = a < b ? a : b, most = a < b ? b : a;

  return least * dim - least * (least - 1) / 2 + most - least;
}

/*
   MpmEnergyTerm - a term of the energy per density, 1/2 int (...) dx: the square of a particle field, or of a node
   field's difference over a cell. Both are in the units of the particle fields; velocity_unit of MpmWave makes
   velocities of them. The square at a particle is multiplied by its mass, that of a stress by volume over stiffness.
*/
typedef struct {
  MpmPlace  place;
  PetscInt  field;
  PetscBool stress;
} MpmEnergyTerm;

typedef struct MpmTransfer_      MpmTransfer;      /* mpmstab/transfer.h */
typedef struct MpmSchemeNumbers_ MpmSchemeNumbers; /* mpmstab/transfer.h */

#define MPM_MOST_TABLE_LINES 96 /* of a formulation's table */

/*S
   MpmCellSymbols - symbols of the maps at a phase beta, for a uniform layout at rest. The closed forms are functions of
   them.

   alpha  - the symbol of P2G G2P: the mean over a cell's particles of abs(symbol of phi)^2. With an affine part it is
            the symbol of P2G G2P of both parts together. alpha, kappa and mu are those of what the transfer gives to
            particles: they are multiplied by its sharp_symbol.
   kappa  - the symbol of DIV GRAD: the mean over a cell's particles of abs(symbol of h dphi/dx)^2. In more dimensions
            it is an eigenvalue of DIV STRESS GRAD.
   plain  - kappa without a prestress; stiff: that of the grid itself, without sharp_symbol, which is that of IMPLICIT
   mu     - the symbol of P2G GRAD. For the hat basis it is e (1 - cos beta) + i sin beta, e = C1 - C2 = 2 mean(xi) - 1.
            In more dimensions it is a square root of the sum of the squares over the directions.
   chi    - with a prestress s0: s0 times the symbol of CURVE G2P, which is the mean over a cell's particles of
            conj(symbol of h^2 d2phi/dx2) times that of phi; kappa is then multiplied by 1 + s0
   drag   - what the node's velocity loses per time by damping and viscosity, in units of c / h: alpha + eta kappa
   projected - particles move with the projected velocity
   transfer, numbers - the transfer, and the numbers that formulation and transfer are given
   lap    - the symbol of -LAP: 4 sin^2(beta / 2), in more dimensions the sum over the directions
   filter - the filter symbol (see MpmTransfer), 1 for flip; f in the formulas
   taken  - the symbol of what a step with FILTER_BEFORE and FILTER_AFTER takes of old nodal values: 1, or the filter
            symbol where the filter acts before; t in the formulas

   Source: theory of the symbol in docs/theory.md, section 4.
S*/
typedef struct {
  PetscReal      alpha, kappa, plain, stiff, drag, lap, filter, taken;
  double complex mu, chi;
  PetscBool      projected;

  const MpmTransfer      *transfer;
  const MpmSchemeNumbers *numbers;
} MpmCellSymbols;

/* A scheme as it is written in a scene or in a file of its own. */
typedef struct MpmWritten_ MpmWritten;

/*S
   MpmFormulation - a scheme: its fields, its table, its continuous problem and its closed forms.

   name, summary, reference - the word of the option formulation, a line about it, and its source
   particle_fields, node_fields - the names of the fields, NULL-terminated
   particle_ranks, node_ranks - what each field is: a number, a vector or a stress
   scratch         - scratch[f]: particle field f is set anew in each pass over the particles that reads it, so that no
                     step finds it. It is no part of the state.
   nops, ops       - the table of operations on fields. MpmTableCreate writes it out for the components of fields.
   options         - the options that the formulation reads, NULL-terminated
   move_share      - the usual share of the new velocity in that which particles move with, where it reads that option
   lines           - writes the table that the numbers ask for, with a transfer, and returns its length; NULL: the table
                     is ops. Ask MpmFormulationLines.
   staggered       - the particle field that is updated first in a step, or MPM_NONE. It lags half a step in a start of
                     second order.
   affine          - the particle field that a transfer with an affine part gives one to, or MPM_NONE
   conserved       - the particle field whose sum over masses no step changes in a domain without walls, or MPM_NONE
   free_ends       - an end may be left free
   materials       - particles may differ in density and stiffness
   nenergy, energy - the terms of the energy
   wave            - the continuous problem
   like            - like[n]: 1 + the node field whose mirror images node field n has, too; 0: its own, which IMPOSE
                     gives
   written         - the text that the scheme was made from; NULL for one of MpmFormulations
   transfer        - the transfer that this text has; NULL: it has none
   published       - abs(G) at a phase as the slides print it, NaN where the formula says nothing; NULL where the slides
                     do not treat the formulation
   published_limit - the Courant number up to which the slides say that it is stable; 0: never
   published_slip  - says in a sentence what is wrong with the published formula
   published_centred - the published formula also takes particles for centred, C1 = C2
   corrected       - abs(G) at a phase, by the same analysis done right
   sums_chi        - it is a function of kappa + chi, wherever particles move
   limit           - the largest stable Courant number at a phase, infinite where there is none
   published_text, corrected_text, limit_text - the formulas as text
   quiet           - the Courant number up to which no step on a frozen grid with these symbols raises the energy of the
                     particles, where the transfer is quiet, too (docs/theory.md, section 12); NULL: none is known
   mls_bound       - with apic and gradient mls no layout at rest grows up to k = 2 sqrt(D / chi) (docs/theory.md,
                     section 4)
   leftmost        - with transfers that have leftmost too, particles at rest grow by real eigenvalues below -1 alone
                     (docs/theory.md, section 5)
   step_bound      - w: no layout at rest, and no material, grows up to the Courant number w / sqrt(lambda), lambda the
                     largest eigenvalue of M^-1 K on it with k = 1. Infinite: none grows at all. 0: that is not known
                     with these numbers and this transfer; NULL: with none (docs/theory.md, section 4)

   Each of published, corrected, limit, wave and energy is optional (NULL; nenergy 0). Without it nothing is compared
   with a closed form or an exact solution, runs start from random data or an eigenmode, and their growth is that of the
   norm.
S*/
typedef struct {
  const char  *name, *summary, *reference;
  const char  *particle_fields[MPM_MAX_FIELDS + 1], *node_fields[MPM_MAX_FIELDS + 1];
  MpmRank      particle_ranks[MPM_MAX_FIELDS], node_ranks[MPM_MAX_FIELDS];
  PetscBool    scratch[MPM_MAX_FIELDS];
  PetscInt     nops;
  const MpmOp *ops;
  const char  *options[8];
  PetscReal    move_share;
  PetscInt (*lines)(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer, MpmOp ops[MPM_MOST_TABLE_LINES]);
  PetscInt             staggered, affine, conserved;
  PetscBool            free_ends, materials;
  PetscInt             nenergy;
  const MpmEnergyTerm *energy;
  const MpmWave       *wave;
  PetscInt             like[MPM_MAX_FIELDS];
  const MpmWritten    *written;
  MpmTransfer         *transfer;
  PetscReal            published_limit;
  const char          *published_text, *published_slip, *corrected_text, *limit_text;
  PetscBool            published_centred, mls_bound, leftmost, sums_chi;
  PetscReal (*published)(PetscReal courant, PetscReal beta);
  PetscReal (*corrected)(const MpmCellSymbols *cell, PetscReal courant);
  PetscReal (*limit)(const MpmCellSymbols *cell);
  PetscReal (*quiet)(const MpmCellSymbols *cell);
  PetscReal (*step_bound)(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer);
} MpmFormulation;

/* Not collective. All formulations, NULL-terminated, in the order of the slides. */
extern const MpmFormulation *const MpmFormulations[];

/* Not collective. The formulation of a name, or NULL when there is none. */
const MpmFormulation *MpmFormulationFind(const char name[]);

/*
   MpmFormulationKeepsUnseen - whether particle data that no node feels stay as they are, but for the transfer's filter.

   Not collective. They do where particles change by what nodes send alone, and a field goes to nodes by one map only.
*/
PetscBool MpmFormulationKeepsUnseen(const MpmFormulation *formulation);

/*
   MpmFormulationLines - the table of operations of a formulation with a transfer and numbers (NULL: flip, the
   defaults). room has the lines of those that write them.

   Not collective.
*/
const MpmOp *MpmFormulationLines(const MpmFormulation *formulation, const MpmSchemeNumbers *numbers,
                                 const MpmTransfer *transfer, MpmOp room[MPM_MOST_TABLE_LINES], PetscInt *n);

/* Not collective. Whether a formulation reads an option. */
PetscBool MpmFormulationReads(const MpmFormulation *formulation, const char option[]);

/* Not collective. Whether a formulation's table has an operation of a kind, with the defaults of its numbers. */
PetscBool MpmFormulationHas(const MpmFormulation *formulation, MpmOpKind kind);

/*
   MpmRkWord - the name of explicit Runge-Kutta method i of formulation rk, or NULL after the last one
   MpmRkOnNames - where its stages are: MPM_RK_AUTO, on particles with a transfer that has no filter and else on nodes,
   MPM_RK_PARTICLES or MPM_RK_NODES
   MpmRkIsOnNodes - whether they are on nodes
   MpmRkPlacesNames - whether particles stay where they are during a step, or move in each stage

   Not collective.
*/
#define MPM_RK_USUAL 2 /* rk4 */
typedef enum { MPM_RK_AUTO, MPM_RK_PARTICLES, MPM_RK_NODES } MpmRkOn;
typedef enum { MPM_RK_FROZEN, MPM_RK_STAGES } MpmRkPlaces;
extern const char *const MpmRkOnNames[], *const MpmRkPlacesNames[];
const char *MpmRkWord(PetscInt i);
PetscBool   MpmRkIsOnNodes(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer);
