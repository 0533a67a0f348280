/*
   The growth of particles that move and only gain from nodes, as with flip: a register is never multiplied, and all that is
   added to it comes from nodes. With y the numbers that nodes give in the steps of a turn, and U y what particles gain,
   the turn takes x to P (x + U y(x)). P puts particles in their new places, and P^q is a number mu of modulus 1, since q
   turns take each particle to its own place some cells farther.

   States sum_l P^l U a_l, l < q, stay such states. Their numbers a are taken to others by a matrix C of order q x steps x
   (numbers of a step). All other amplification factors are those of P, of modulus 1. In three dimensions usl with eight
   particles in a cell and a drift of 1/8 has C of order 48 where the registers hold 72 numbers.
*/
#pragma once
#include "symbol/bloch.h"

/*S
   MpmBlochGained - see above.

   numbers - that nodes give in a step
   gift    - gift[y]: which register they are in, and what it gives
   cycles  - q
   order   - of C
   given   - rows of y of all steps, as those of registers
   matrix, value - C and its eigenvalues
   beyond  - MpmBlochPhaseBeyond of each particle, at the present phase
S*/
struct MpmBlochGained_ {
  PetscInt        numbers, cycles, order;
  MpmTakenGift    gift[MPM_MAX_TAKEN];
  PetscReal      *given;
  double complex *matrix, *value, *beyond;
};

/*
   MpmBlochGainedCreate - NULL where particles do not only gain, C would be no smaller, or a turn is so long that its numbers
   might leave the range of doubles.

   MpmBlochGainedGrowth - growth per step of a phase; ok is false, and growth is not set, where QR steps have not converged
   or the Courant number is so large that the numbers might leave the range of doubles.

   Not collective.
*/
PetscErrorCode MpmBlochGainedCreate(const MpmBloch *bloch, MpmBlochGained **gained);
PetscErrorCode MpmBlochGainedDestroy(MpmBlochGained **gained);
PetscErrorCode MpmBlochGainedGrowth(MpmBlochGained *gained, MpmBloch *bloch, PetscReal courant, const PetscReal beta[],
                                    PetscReal *growth, PetscBool *ok);
