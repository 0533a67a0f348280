/* The amplification matrix of one phase: a table applied to one Bloch mode. MpmSymbolCreate calls it for each phase. */
#pragma once
#include "symbol/ties.h"

/*S
   MpmBloch - memory for the matrices, and the weights of all maps for one cell's particles at every step of a period.

   A register is a dense matrix. Its rows are a cell's particles, or its one node. Its columns are the states that the
   steps start from: for the matrix of a phase each number of the cell's state, particle by particle as in MpmOperator. Particle j of a cell has the places j_a along the directions,
   j = j_0 + ppc_0 (j_1 + ppc_1 j_2).

   fields, ppc, size - the number of fields of the state, of particles in a cell, and size = fields x ppc
   columns      - of the registers in the present step, at most size
   period       - the number of steps in a period
   used         - used[kind]: the table needs this map
   ties         - the weights along each direction
   particle, nodes - the registers
   wave         - the phase factors of the nodes along each direction, at the present phase (MpmTiesWave)
   tie          - tie[axis][kind x ppc + j]: the symbol of a map along an axis at the particles that are j-th there, at
                  the present phase and step
   mass         - of a node, at the present step
   traits, values - of the table's operations; values are those at the Courant number of the last matrix
S*/
typedef struct {
  const MpmLayout *layout;
  const MpmScheme *scheme;
  PetscInt         fields, ppc, size, columns, period;
  PetscBool        used[MPM_OP_KINDS];
  MpmTies          ties[MPM_MAX_DIM];
  double complex  *particle, *nodes, wave[MPM_MAX_DIM][MPM_MOST_SEEN], *tie[MPM_MAX_DIM];
  PetscReal        mass;
  MpmOpTraits     *traits;
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
   MpmBlochMatrix - the amplification matrix of a phase at a Courant number, size x size by columns, divided by
   2^exponent. beta has one number for each direction. With noisy, every number is moved by about its rounding after each
   step. The difference of two such matrices then shows the effect of rounding, with any growth over the rest of the
   period.

   Not collective.
*/
PetscErrorCode MpmBlochMatrix(MpmBloch *bloch, PetscReal courant, const PetscReal beta[], PetscBool noisy,
                              double complex G[], PetscInt *exponent);

/*
   MpmBlochStep - applies one step of the period to a state of a cell, in place: size numbers, with particle j's numbers
   from fields x j on.

   Not collective. 0 <= step < period.
*/
PetscErrorCode MpmBlochStep(MpmBloch *bloch, PetscReal courant, const PetscReal beta[], PetscInt step,
                            double complex state[]);
