/*
   Growth of one Bloch mode by less than the matrix of a turn: at rest by the nodal operator, and where particles only
   gain from nodes by the vectors that they gain.
*/
#pragma once
#include "operator/nodal.h"
#include "symbol/bloch.h"

/*
   The amplification factors of particles at rest without their null space: those of the nodal operator of one Bloch
   mode. In two dimensions it has four numbers for a vector and a stress, whatever the number of particles in a cell is.
*/

/*S
   MpmBlochNodal - the nodal operator of a table as a polynomial in the Courant number, at the present phase.

   plan        - of the table
   beta        - the present phase; NaN for none yet
   coefficient - coefficient[j]: nimages x nimages by columns (MpmNodalRun)
   rest, all   - the amplification factors of the null space of P2G, particle data that no node feels: rest of them are
                 1, the others of all are factor; all is MPM_NONE where only the largest abs of them is known, factor
S*/
struct MpmBlochNodal_ {
  MpmNodalPlan    *plan;
  PetscReal        beta[MPM_MAX_DIM], factor;
  double complex **coefficient;
  PetscInt         rest, all;
};

/*
   MpmBlochCountNull - counts the amplification factors of the null space of P2G: those of fields without filter (rest),
   and of all. all is MPM_NONE where this is not known.

   Not collective. b is at rest.
*/
void MpmBlochCountNull(const MpmBloch *bloch, PetscInt *rest, PetscInt *all, PetscReal *factor);

/*
   MpmBlochNodalCreate - NULL where it does not apply: one dimension, whose matrices are small, particles that drift,
   tables without a plan, and layouts with so few particles that the nodes have more numbers than those (one particle
   with a pressure gives its nodes a vector).

   MpmBlochNodalFactors - the amplification factors of a phase but for the null space, plan->nimages of them. ok is
   false where the QR steps have not converged or the numbers leave the range of doubles, and nothing is then set.

   MpmBlochNodalGrowths - growth per step of a phase, with the null space and without it, which is NaN where it is not
   known; ok as above.

   Not collective.
*/
PetscErrorCode MpmBlochNodalCreate(const MpmBloch *bloch, MpmBlochNodal **nodal);
PetscErrorCode MpmBlochNodalDestroy(MpmBlochNodal **nodal);
PetscErrorCode MpmBlochNodalFactors(MpmBlochNodal *nodal, MpmBloch *bloch, PetscReal courant, const PetscReal beta[],
                                    double complex value[], PetscBool *ok);
PetscErrorCode MpmBlochNodalGrowths(MpmBlochNodal *nodal, MpmBloch *bloch, PetscReal courant, const PetscReal beta[],
                                    PetscReal *growth, PetscReal *without_null, PetscBool *ok);

/*
   The growth of particles that move and only gain from nodes, as with flip: a register is never multiplied, and all
   that is added to it comes from nodes. With y the numbers that nodes give in the steps of a turn, and U y what
   particles gain, the turn takes x to P (x + U y(x)). P puts particles in their new places. A few vectors v of the
   state that hold all U y and what P makes of them are enough: a turn takes their sums to such sums, and all other
   amplification factors have modulus 1. There are two sets of them, and the smaller one is taken.

   Orbits: the P^l U, l < q. P^q is a number mu of modulus 1, since q turns take each particle to its own place some
   cells farther. In three dimensions usl with eight particles in a cell and a drift of 1/8 along the diagonal has 48 of
   them where the registers hold 72 numbers.

   Products, where particles move along some directions only. The weights of a map are products of those along the
   directions, and along a direction without drift they stay. So all that a number y of the nodes ever gives to
   particles is

     sum_d e_d x w_(y,d)

   where d are the kinds of weights along the moving directions, w what y gives along the others, and e_d numbers of the
   particles that differ along the moving directions. With the drift along x usl has 18 vectors e x w.
*/

#define MPM_MAX_STILL 128 /* the most w */

/*S
   MpmBlochGained - see above. Vector i is number l x steps x numbers + step x numbers + y of the orbits, or the product
   of the w with number i / moving and of the place i % moving along the moving directions.

   gains    - what nodes give in a step
   order    - how many vectors there are
   products - they are products
   cycles   - q
   moves, rests - of each direction
   moving   - the number of places in a cell along the moving directions
   place, first - place[j]: that of particle j; first[m]: a particle with place m
   n, of    - the number of w; of[y][i]: the w that part i of number y belongs to
   part     - one of the parts of a w
   number   - of each vector: the number of the nodes that gives it
   weight   - of each vector in each step: how much its number gives of it
   to, times - P takes vector i to times[i] vector to[i], at the present phase
   given    - rows of y of all steps, as those of registers
   matrix, value - the matrix and its eigenvalues
   beyond   - MpmBlochPhaseBeyond of each particle, at the present phase
S*/
struct MpmBlochGained_ {
  MpmTaken       *gains;
  PetscBool       products, moves[MPM_MAX_DIM], rests[MPM_MAX_DIM];
  PetscInt        order, cycles, moving, n, of[MPM_MAX_TAKEN][MPM_MAX_FIELDS], *place, *first, *number, *to;
  MpmOp           part[MPM_MAX_STILL];
  PetscReal      *given;
  double complex *weight, *times, *matrix, *value, *beyond;
};

/*
   MpmBlochGainedCreate - NULL where particles do not only gain, or the matrix would be no smaller than that of the
                          registers.

   Not collective. drift has one fraction for each direction.
*/
PetscErrorCode MpmBlochGainedCreate(const MpmBloch *bloch, const MpmFraction drift[], MpmBlochGained **gained);
PetscErrorCode MpmBlochGainedDestroy(MpmBlochGained **gained);
