/*
   Ties: the maps between the particles of a cell and its nodes along one direction, at each step of a drift. The symbol
   of a map at a phase is a sum over such weights. In more dimensions it is a product over the directions.
*/
#pragma once
#include "scheme/maps.h"
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>
#include <complex.h>

#define MPM_MOST_SEEN (MPM_MAX_REACH + 4) /* a bound of the nodes that a cell's particles have weights at in any step */

/*S
   MpmTies - the weights of the maps of n particles in a row, those of one cell along a direction.

   period       - after so many steps the particles have the same places in cells again
   reach        - the number of weights of a particle (MpmMapReach)
   lowest, seen - the first of the nodes of the particles over all steps, relative to the cell's node, and their number
   node         - node[step x n + j]: the first node of particle j, relative to the cell's node
   rows         - rows[((step x kinds + kind) x n + j) x reach]: the weights of particle j's nodes (MpmMapRow)
   masses       - masses[step]: the sum of phi_ip over the particles, which a node has from this direction
S*/
typedef struct {
  PetscInt   n, period, reach, lowest, seen;
  PetscInt  *node;
  PetscReal *rows, *masses;
} MpmTies;

/*
   MpmTiesCreate - computes the weights of the maps in use along an axis. P2G must be in use.

   Not collective. The drift must be 0 or a fraction (see MpmStepPeriod). used: by kind of operation.
*/
PetscErrorCode MpmTiesCreate(const MpmLayout *layout, const MpmScheme *scheme, PetscInt axis, const MpmFraction *drift,
                             const PetscBool used[MPM_OP_KINDS], MpmTies *ties);
PetscErrorCode MpmTiesDestroy(MpmTies *ties);

/* Not collective. The phase factor of each node of the particles: wave[i] = e^(i beta (lowest + i)), for i < seen. */
void MpmTiesWave(const MpmTies *ties, PetscReal beta, double complex wave[MPM_MOST_SEEN]);

/*
   Not collective. The symbol of a map at particle j and a step: sum_d row_d e^(i beta d), with the wave of MpmTiesWave.
*/
static inline double complex MpmTie(const MpmTies *ties, PetscInt step, MpmOpKind kind, PetscInt j,
                                    const double complex wave[])
{
  const PetscInt        at   = step % ties->period;
  const PetscReal      *row  = ties->rows + ((at * MPM_OP_KINDS + kind) * ties->n + j) * ties->reach;
  const double complex *seen = wave + ties->node[at * ties->n + j] - ties->lowest;
  PetscReal             re = 0, im = 0;

  for (PetscInt d = 0; d < ties->reach; d++) {
    re += row[d] * creal(seen[d]);
    im += row[d] * cimag(seen[d]);
  }
  return CMPLX(re, im);
}
