/* The table over one Bloch mode: what MpmSymbolCreate does at each phase. */
#pragma once
#include "scheme/maps.h"
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>
#include <complex.h>

/*S
   MpmBloch - room and the numbers of all maps for one cell's particles at every step of a period.

   A register is a dense matrix: rows are a cell's particles, or its one node, columns the cell's state at the start,
   particle by particle as in MpmOperator. rows[(step x kinds + kind) x ppc + j] ties particle j to its nodes,
   node[step x ppc + j] is the first of them, relative to the cell's; masses[step] is a node's mass. At a phase wave[i]
   is that of node lowest + i, of the seen nodes; at a step tie[kind x ppc + j] is the map's symbol, for maps in use.
   traits and values are those of the table's operations, values at the Courant number of the last matrix.
*/
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
   MpmBlochCreate - computes the maps' numbers of a layout at each step of the drift's period, once for all phases and
   Courant numbers.

   Not collective. layout and scheme must outlive it; the drift is a fraction (see MpmStepPeriod).
*/
PetscErrorCode MpmBlochCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmFraction *drift,
                              MpmBloch *bloch);
PetscErrorCode MpmBlochDestroy(MpmBloch *bloch);

/*
   MpmBlochMatrix - the amplification matrix of a phase at a Courant number, size x size by columns, divided by 2^exponent. noisy: with
   every number moved by about its rounding after each step, so that what two such matrices differ by is what rounding
   does to them, amplified by the rest of the period as it may be.

   Not collective.
*/
PetscErrorCode MpmBlochMatrix(MpmBloch *bloch, PetscReal courant, PetscReal beta, PetscBool noisy, double complex G[],
                              PetscInt *exponent);
