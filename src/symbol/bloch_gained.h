/*
   The growth of particles that move and only gain from nodes, as with flip: a register is never multiplied, and all that is
   added to it comes from nodes. With y the numbers that nodes give in the steps of a turn, and U y what particles gain,
   the turn takes x to P (x + U y(x)). P puts particles in their new places, and P^q is a number mu of modulus 1, since q
   turns take each particle to its own place some cells farther.

   States sum_l P^l U a_l, l < q, stay such states. Their numbers a are taken to others by a matrix C of order q x steps x
   (numbers of a step). All other amplification factors are those of P, of modulus 1. In three dimensions usl with eight
   particles in a cell and a drift of 1/8 along the diagonal has C of order 48 where the registers hold 72 numbers. Where
   particles move along some directions only, a smaller matrix may do (bloch_still.h).
*/
#pragma once
#include "symbol/bloch_still.h"

/*S
   MpmBlochGained - see above.

   gains   - what nodes give in a step
   still   - the smaller matrix of particles that rest along some directions; NULL where C is no larger
   cycles  - q
   order   - of the matrix
   given   - rows of y of all steps, as those of registers
   matrix, value - the matrix and its eigenvalues
   beyond  - MpmBlochPhaseBeyond of each particle, at the present phase
S*/
struct MpmBlochGained_ {
  MpmTaken       *gains;
  MpmBlochStill  *still;
  PetscInt        cycles, order;
  PetscReal      *given;
  double complex *matrix, *value, *beyond;
};

/*
   MpmBlochGainedCreate - NULL where particles do not only gain, or the matrix would be no smaller than that of the registers.

   MpmBlochGainedGrowth - growth per step of a phase; ok is false, and growth is not set, where QR steps have not converged
   or the numbers of a turn might leave the range of doubles.

   Not collective. drift has one fraction for each direction.
*/
PetscErrorCode MpmBlochGainedCreate(const MpmBloch *bloch, const MpmFraction drift[], MpmBlochGained **gained);
PetscErrorCode MpmBlochGainedDestroy(MpmBlochGained **gained);
PetscErrorCode MpmBlochGainedGrowth(MpmBlochGained *gained, MpmBloch *bloch, PetscReal courant, const PetscReal beta[],
                                    PetscReal *growth, PetscBool *ok);
