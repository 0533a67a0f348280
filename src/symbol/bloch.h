/* The amplification matrix of one phase: a table applied to one Bloch mode. MpmSymbolCreate calls it for each phase. */
#pragma once
#include "symbol/bloch_taken.h"
#include "symbol/ties.h"

typedef struct MpmBlochNodal_  MpmBlochNodal;  /* symbol/bloch_nodal.h */
typedef struct MpmBlochGained_ MpmBlochGained; /* symbol/bloch_gained.h */

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
   lanes, most  - the number of lanes in the present step, 1 or MPM_BLOCH_LANES; and the most that are worthwhile, 1 where
                  rows are long
   width        - of a row in the present step: the number of columns times lanes, filled up with zeros
   period       - the number of steps in a period
   turn         - after so many steps the particles have changed places with one another: particle j has the place that
                  place[j] had, beyond[j] cells farther. A period is a whole number of turns. A turn is shorter where
                  ppc and the denominator of the drift have a common divisor.
   taken, turn_size - what particles take from nodes, and the order of the matrix of a turn. NULL and size for particles at
                  rest, and where the registers hold no more
   used         - used[kind]: the table needs this map
   ties         - the weights along each direction
   particle, nodes - the registers
   turns        - room for the matrices of a turn of all lanes, where there is more than one
   beta, known  - the present phase, and the number of steps for which tie is set
   wave         - the phase factors of the nodes along each direction, at the present phase (MpmTiesWave)
   tie          - tie[axis][(kind x period + step) x ppc + j]: the symbol of a map along an axis at the particles that
                  are j-th there, at the present phase; period and ppc are those of the axis. now[axis]: from the
                  present step on
   mass         - of a node, at the present step
   nodal        - the nodal operator; NULL where it does not apply
   gained       - what particles gain from nodes; NULL where it does not apply, or the turn's matrix is no larger
   traits, values - of the table's operations; values are the factors in each lane
   noise, noisy - what moves numbers by their rounding, and the number of steps for which it is kept
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
  MpmOpTraits     *traits;
  PetscReal       *values, *noise;
  PetscInt         noisy;
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
   With noisy, every number is moved by about its rounding after each step. The difference of two such matrices then shows
   the effect of rounding, with any growth over the rest of the period.

   MpmBlochTurns - the matrices of a turn. With R, which gives what was a particle's to the one whose place it has taken,
   every turn is the same step of R q. So the matrix of a period is e^(i beta.m) times a power of this one, m the cells that
   particles move in a period, and growth per step is the same. With two particles a cell and a drift of 1/8 a turn takes
   four steps, and a period eight. They are turn_size x turn_size. Where particles take values from nodes (MpmTaken) they
   are of the smaller matrix: first the y, then what is left of each particle. Its eigenvalues are those of the turn, but
   for zeros.

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
double complex MpmBlochOfNodes(const MpmBloch *bloch, const MpmOp *op, const PetscReal beta[]);

/*
   MpmBlochStep - applies one step of the period to a state of a cell, in place: size numbers, with particle j's numbers
   from fields x j on.

   Not collective. 0 <= step < period.
*/
PetscErrorCode MpmBlochStep(MpmBloch *bloch, PetscReal courant, const PetscReal beta[], PetscInt step,
                            double complex state[]);

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

   MpmBlochApply - applies operation o of the table in that step.

   MpmBlochImplicit - applies IMPLICIT, with a number for each lane (bloch_implicit.c)

   MpmBlochNote - adds to the rows of what nodes give in a step, 2 x width numbers each, what operation o is the first to
   read. MpmBlochApply comes after it.

   MpmBlochPhaseBeyond - the phase factor of what goes from particle j to the one whose place it has taken, for the cells in
   between.

   Not collective.
*/
PetscErrorCode MpmBlochBegin(MpmBloch *b, PetscInt n, const PetscReal courant[], const PetscReal beta[], PetscInt steps,
                             PetscInt columns);
void           MpmBlochSetStep(MpmBloch *b, PetscInt step);
void           MpmBlochApply(MpmBloch *b, PetscInt o, const PetscReal beta[]);
void           MpmBlochImplicit(MpmBloch *b, const MpmOp *op, const PetscReal a[]);
void           MpmBlochNote(const MpmBloch *b, const MpmTaken *taken, PetscInt o, PetscReal numbers[]);
double complex MpmBlochPhaseBeyond(const MpmBloch *b, const PetscReal beta[], PetscInt j);
