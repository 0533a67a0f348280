/* The amplification matrix of one phase: a table applied to one Bloch mode. MpmSymbolCreate calls it for each phase. */
#pragma once
#include "scheme/maps.h"
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>
#include <complex.h>

/*S
   MpmBloch - memory for the matrices, and the weights of all maps for one cell's particles at every step of a period.

   A register is a dense matrix. Its rows are a cell's particles, or its one node. Its columns are the cell's state at
   the start, particle by particle as in MpmOperator.

   fields, size - the number of fields of the state, and size = fields x ppc
   period       - the number of steps in a period
   lowest, seen - the first of the nodes of a cell's particles over all steps, relative to the cell's node, and their
                  number
   used         - used[kind]: the table needs this map
   node         - node[step x ppc + j]: the first node of particle j, relative to the cell's node
   rows         - rows[(step x kinds + kind) x ppc + j] has the MPM_MAX_REACH weights of particle j's nodes (MpmMapRow)
   masses       - masses[step]: the mass of a node
   particle, nodes - the registers
   wave         - wave[i]: e^(i beta (lowest + i)) at the present phase
   tie          - tie[kind x ppc + j]: the symbol of a map at particle j, at the present phase and step
   traits, values - of the table's operations; values are those at the Courant number of the last matrix
S*/
typedef struct {
  const MpmLayout *layout;
  const MpmScheme *scheme;
  PetscInt         fields, size, period, lowest, seen;
  PetscBool        used[MPM_OP_KINDS];
  PetscInt        *node;
  PetscReal       *rows, *masses;
  double complex  *particle, *nodes, *wave, *tie;
  MpmOpTraits     *traits;
  PetscReal       *values;
} MpmBloch;

/*
   MpmBlochCreate - computes the weights of all maps on a layout at each step of the drift's period, once for all phases
   and Courant numbers.

   Not collective. layout and scheme must outlive it. The drift must be a fraction (see MpmStepPeriod).
*/
PetscErrorCode MpmBlochCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmFraction *drift,
                              MpmBloch *bloch);
PetscErrorCode MpmBlochDestroy(MpmBloch *bloch);

/*
   MpmBlochMatrix - the amplification matrix of a phase at a Courant number, size x size by columns, divided by
   2^exponent. With noisy, every number is moved by about its rounding after each step. The difference of two such
   matrices then shows the effect of rounding, with any growth over the rest of the period.

   Not collective.
*/
PetscErrorCode MpmBlochMatrix(MpmBloch *bloch, PetscReal courant, PetscReal beta, PetscBool noisy, double complex G[],
                              PetscInt *exponent);
