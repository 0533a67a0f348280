/* The amplification matrix of one phase: a table applied to one Bloch mode. MpmSymbolCreate calls it for each phase. */
#pragma once
#include "linalg/small_eigen.h"
#include "program/program.h"
#include "symbol/ties.h"
#include <mpmstab/table.h>

typedef struct MpmBlochNodal_  MpmBlochNodal;  /* symbol/bloch_growth.h */
typedef struct MpmBlochGained_ MpmBlochGained; /* symbol/bloch_growth.h */

/* ---- what particles take from nodes (bloch_create.c) ---- */

/*
   What particles take from nodes at the end of a step. A particle register that is set to 0 and then only gets values
   from nodes holds sums of W y, with few numbers y of a node. pic, xpic, apic and tpic renew velocities so. Under drift
   the state after a step is then known by these y and the registers that are not taken, and so is that of a turn. With
   eight particles in a cell, apic in three dimensions has 3 numbers and 8 stresses, 51 unknowns where the registers
   hold 144.

   With E, which makes the registers of y and the others, and K, which is the turn as far as y, the turn is E K. Its
   eigenvalues other than 0 are those of K E, the smaller matrix.
*/
#define MPM_MAX_TAKEN 32 /* the most node fields that a table gives to registers that are taken */

/*S
   MpmTakenGift - what a node register holds while operations of the table give it to taken registers.

   at, src - the first operation that reads it, and the register
   slot    - its slot in the plan of the nodal operator
   number  - the unknown that it is a part of
   times   - y[number] is the sum of times the value over the gifts of this number
   parts, part - the operations that give it: W y, times factor k^coefficient, to dst
S*/
typedef struct {
  PetscInt  at, src, slot, number, parts;
  PetscReal times;
  MpmOp     part[MPM_MAX_FIELDS];
} MpmTakenGift;

/*S
   MpmTaken - see above.

   taken   - taken[r]: state register r is taken
   left    - the number of state registers that are not
   numbers - the number of unknowns y
   first   - first[n]: the first gift of number n, whose parts are those of y[n]
S*/
typedef struct {
  PetscBool    taken[MPM_MAX_FIELDS];
  PetscInt     left, numbers, first[MPM_MAX_TAKEN], ngifts;
  MpmTakenGift gift[MPM_MAX_TAKEN];
} MpmTaken;

/*
   MpmTakenFind - finds it for a table, or NULL where no register is taken, node fields are too many, or the table has
   no plan of its nodal operator. gains: the same of all registers of a table whose particles only gain, so that a step
   multiplies none; NULL for other tables. No register counts as taken then.

   Not collective. Free it with PetscFree.
*/
PetscErrorCode MpmTakenFind(const MpmTable *table, PetscBool gains, MpmTaken **taken);

/* ---- a Bloch mode ---- */

#define MPM_BLOCH_LANES 8 /* Courant numbers that go through the steps of a period side by side */

/*S
   MpmBloch - memory for the matrices, and the weights of all maps for one cell's particles at every step of a period.

   A register is a dense matrix. Its rows are a cell's particles, or its one node. Its columns are the states that the
   steps start from: for the matrix of a phase each number of the cell's state, particle by particle as in MpmOperator.
   Particle j of a cell has the places j_a along the directions, j = j_0 + ppc_0 (j_1 + ppc_1 j_2). A row has the real
   parts of its numbers first, then the imaginary parts. Several Courant numbers have a *lane* each: a row then has
   the number of each lane for the first column, those for the second column, and so on. The maps are the same in all
   lanes, and an operation has a factor for each lane.

   fields, ppc, size - the number of fields of the state, of particles in a cell, and size = fields x ppc
   lanes, most  - the number of lanes in the present step, 1 or MPM_BLOCH_LANES; and the most that are worthwhile, 1
                  where rows are long
   width        - of a row in the present step: the number of columns times lanes, filled up with zeros
   period       - the number of steps in a period
   turn         - after so many steps the particles have changed places with one another: particle j has the place that
                  place[j] had, beyond[j] cells farther. A period is a whole number of turns. A turn is shorter where
                  ppc and the denominator of the drift have a common divisor.
   taken, turn_size - what particles take from nodes, and the order of the matrix of a turn. NULL and size for particles
                  at rest, and where the registers hold no more
   used         - used[kind]: the table needs this map
   ties         - the weights along each direction
   particle, nodes - the registers
   turns        - room for the matrices of a turn of all lanes
   beta, known  - the present phase, and the number of steps for which tie is set
   wave         - the phase factors of the nodes along each direction, at the present phase (MpmTiesWave)
   tie          - tie[axis][(kind x period + step) x ppc + j]: the symbol of a map along an axis at the particles that
                  are j-th there, at the present phase; period and ppc are those of the axis. now[axis]: from the
                  present step on
   mass         - of a node, at the present step
   nodal        - the nodal operator; NULL where it does not apply
   gained       - what particles gain from nodes; NULL where it does not apply, or the turn's matrix is no larger
   program, values - the table's lines, with keys, and their factors in each lane
S*/
typedef struct {
  const MpmLayout *layout;
  const MpmScheme *scheme;
  PetscInt         fields, ppc, size, lanes, most, width, period, turn, turn_size, *place, (*beyond)[MPM_MAX_DIM];
  MpmTaken        *taken;
  PetscBool        used[MPM_OP_KINDS];
  MpmTies          ties[MPM_MAX_DIM];
  double complex   wave[MPM_MAX_DIM][MPM_MOST_SEEN], *tie[MPM_MAX_DIM], *now[MPM_MAX_DIM];
  PetscInt         known[MPM_MAX_DIM];
  PetscReal       *particle, *nodes, beta[MPM_MAX_DIM], mass;
  double complex  *turns;
  MpmBlochNodal   *nodal;
  MpmBlochGained  *gained;
  MpmStepProgram  *program;
  PetscReal       *values;
} MpmBloch;

/*
   MpmBlochCreate - computes the weights of all maps on a layout at each step of the drift's period, once for all phases
   and Courant numbers.

   Not collective. layout and scheme must outlive it. drift has one fraction for each direction (see MpmStepPeriod).
*/
PetscErrorCode MpmBlochCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmFraction drift[],
                              MpmBloch *bloch);
PetscErrorCode MpmBlochDestroy(MpmBloch *bloch);

/*
   MpmBlochMatrices - the amplification matrices of a phase at n Courant numbers, one after another, each size x size by
   columns and divided by 2^exponent. Each is the same to the last bit as alone. beta has one number for each direction.
   With noisy, every number is moved by about its rounding after each step. The difference of two such matrices then
   shows the effect of rounding, with any growth over the rest of the period.

   MpmBlochTurns - the matrices of a turn. With R, which gives what was a particle's to the one whose place it has
   taken, every turn is the same step of R q. So the matrix of a period is e^(i beta.m) times a power of this one, m the
   cells that particles move in a period, and growth per step is the same. With two particles a cell and a drift of 1/8
   a turn takes four steps, and a period eight. They are turn_size x turn_size. Where particles take values from nodes
   (MpmTaken) they are of the smaller matrix: first the y, then what is left of each particle. Its eigenvalues are those
   of the turn, but for zeros.

   Not collective.
*/
PetscErrorCode MpmBlochMatrices(MpmBloch *bloch, PetscInt n, const PetscReal courant[], const PetscReal beta[],
                                PetscBool noisy, double complex G[], PetscInt exponent[]);
PetscErrorCode MpmBlochTurns(MpmBloch *bloch, PetscInt n, const PetscReal courant[], const PetscReal beta[],
                             double complex G[], PetscInt exponent[]);

/*
   MpmBlochSetPhase - makes ready for MpmBlochTie and MpmBlochOfNodes at a phase, before the first step
   MpmBlochTie     - the symbol of an operation's map at particle j of a cell; along: of the directions for which it is
                     true, or NULL for all
   MpmBlochOfNodes - the symbol of an operation from nodes to nodes, without its factor

   Not collective.
*/
void           MpmBlochSetPhase(MpmBloch *bloch, const PetscReal beta[]);
double complex MpmBlochTie(const MpmBloch *bloch, const MpmOp *op, PetscInt j, const PetscBool along[]);
double complex MpmBlochOfNodes(const MpmBloch *bloch, const MpmOp *op);

/*
   MpmBlochStep - applies one step of the period to a state of a cell, in place: size numbers, with particle j's numbers
   from fields x j on.

   Not collective. 0 <= step < period.
*/
PetscErrorCode MpmBlochStep(MpmBloch *bloch, PetscReal courant, const PetscReal beta[], PetscInt step,
                            double complex state[]);

/*
   MpmBlochGrowths - the growth per step of a phase at n Courant numbers: the largest abs of the amplification factors
   of the nodal operator and of the null space of P2G, where that is known, and else of a turn; and growth without the
   null space, NaN where it is not known.

   Not collective. eigen has the order bloch->turn_size and is overwritten.
*/
PetscErrorCode MpmBlochGrowths(MpmBloch *bloch, MpmSmallEigen *eigen, PetscInt n, const PetscReal courant[],
                               const PetscReal beta[], PetscReal growth[], PetscReal without_null[]);

/* ---- the registers and the operations on them, for the files that make matrices of them ---- */

/* The numbers of a row with so many columns, which is filled up with zeros to a multiple of the lanes. */
static inline PetscInt MpmBlochFullWidth(PetscInt columns)
{
  return (columns + MPM_BLOCH_LANES - 1) / MPM_BLOCH_LANES * MPM_BLOCH_LANES;
}

/* The rows of a register of particles. */
static inline PetscReal *MpmBlochRows(const MpmBloch *b, PetscInt field)
{
  return b->particle + field * b->ppc * 2 * b->width;
}

/* The row of a register of nodes. */
static inline PetscReal *MpmBlochRow(const MpmBloch *b, PetscInt field)
{
  return b->nodes + field * 2 * b->width;
}

/*
   MpmBlochBegin - makes ready for the first steps of a period, of so many columns for each of n Courant numbers. All
   particle registers are 0. Lanes without a Courant number have the last one's.

   MpmBlochSetStep - sets what the maps of a step are, and the nodal mass.

   MpmBlochRunStep - a step of a period. taken: what nodes give to the registers that are taken is added to numbers,
   rows of 2 x width; NULL: it is not noted.

   MpmBlochPhaseBeyond - the phase factor of what goes from particle j to the one whose place it has taken, for the
   cells in between.

   Not collective.
*/
PetscErrorCode MpmBlochBegin(MpmBloch *b, PetscInt n, const PetscReal courant[], const PetscReal beta[], PetscInt steps,
                             PetscInt columns);
void           MpmBlochSetStep(MpmBloch *b, PetscInt step);
PetscErrorCode MpmBlochRunStep(MpmBloch *b, PetscInt step, const MpmTaken *taken, PetscReal numbers[]);
double complex MpmBlochPhaseBeyond(const MpmBloch *b, const PetscReal beta[], PetscInt j);
