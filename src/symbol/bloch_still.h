/*
   What particles gain while they move along some directions only. The weights of a map are products of those along the
   directions, and along a direction without drift they stay. So all that a number y of the nodes ever gives to particles is

     sum_d e_d x w_(y,d)

   where d are the kinds of weights along the moving directions, w what y gives along the others, and e_d numbers of the
   particles that differ along the moving directions. All vectors e x w are few, and each turn takes their sums to such sums:
   the other factors of a turn have modulus 1. In three dimensions usl with eight particles in a cell and a drift along x has
   18 of them where the registers hold 72 numbers.
*/
#pragma once
#include "symbol/bloch.h"

#define MPM_MAX_STILL 128 /* the most w */

/*S
   MpmBlochStill - see above. Unknown m + moving x n is the n-th w with the m-th place along the moving directions.

   moves, rests - of each direction
   moving       - the number of places in a cell along the moving directions
   place        - place[j]: that of particle j
   first        - first[m]: a particle with place m
   n            - the number of w
   of           - of[y][i]: the w that part i of number y belongs to
   number, part - the number and one of the parts of a w
   weight       - of every unknown in each step: what its number gives to it
S*/
typedef struct {
  PetscBool       moves[MPM_MAX_DIM], rests[MPM_MAX_DIM];
  PetscInt        moving, *place, *first, n, of[MPM_MAX_TAKEN][MPM_MAX_FIELDS], number[MPM_MAX_STILL];
  MpmOp           part[MPM_MAX_STILL];
  double complex *weight;
} MpmBlochStill;

/*
   MpmBlochStillCreate - NULL where there are too many w.

   MpmBlochStillBegin  - sets the registers, which are 0, to the vectors, a column each.

   MpmBlochStillWeigh  - keeps the weights of a step. MpmBlochSetStep comes before it.

   MpmBlochStillMatrix - the matrix of a turn, by columns. given has rows of the numbers that nodes give, step by step, and
   beyond is MpmBlochPhaseBeyond of each particle.

   Not collective.
*/
PetscErrorCode MpmBlochStillCreate(const MpmBloch *bloch, const MpmFraction drift[], const MpmTaken *gains,
                                   MpmBlochStill **still);
PetscErrorCode MpmBlochStillDestroy(MpmBlochStill **still);
void MpmBlochStillBegin(const MpmBlochStill *still, MpmBloch *bloch, const MpmTaken *gains, PetscReal courant);
void MpmBlochStillWeigh(MpmBlochStill *still, const MpmBloch *bloch, PetscInt step);
void MpmBlochStillMatrix(const MpmBlochStill *still, const MpmBloch *bloch, const MpmTaken *gains,
                         const PetscReal given[], const double complex beyond[], double complex matrix[]);
