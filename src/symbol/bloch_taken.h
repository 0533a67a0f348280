/*
   What particles take from nodes at the end of a step. A particle register that is set to 0 and then only gets values from
   nodes holds sums of W y, with few numbers y of a node. pic, xpic, apic and tpic renew velocities so. Under drift the
   state after a step is then known by these y and the registers that are not taken, and so is that of a turn. With eight
   particles in a cell, apic in three dimensions has 3 numbers and 8 stresses, 51 unknowns where the registers hold 144.

   With E, which makes the registers of y and the others, and K, which is the turn as far as y, the turn is E K. Its
   eigenvalues other than 0 are those of K E, the smaller matrix.
*/
#pragma once
#include <mpmstab/table.h>

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
   MpmTakenFind - finds it for a table, or NULL where no register is taken, node fields are too many, or the table has no
   plan of its nodal operator. gains: the same of all registers of a table whose particles only gain, so that a step
   multiplies none; NULL for other tables. No register counts as taken then.

   Not collective. Free it with PetscFree.
*/
PetscErrorCode MpmTakenFind(const MpmTable *table, PetscBool gains, MpmTaken **taken);
