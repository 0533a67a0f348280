/*
   Modified ends: the node beyond a wall has the value 2 f_0 - f_1, which continues the last two nodes of the grid in a
   straight line. So its function goes to theirs, phi_0 + 2 phi_{-1} and phi_1 - phi_{-1}. Linear functions are
   reproduced up to the wall. These are the node types -2, -1, 1 and 2 of Karamelo's basis_functions.h.

   Source: Steffen, Kirby and Berzins 2008, who give the functions at a boundary.
*/
#pragma once
#define OFFSET 0
#include "scheme/basis/nodes.h"

static inline void Alter(PetscInt before, PetscInt step, PetscReal w[])
{
  if (before != -1) return;
  w[step] += 2 * w[0];
  w[2 * step] -= w[0];
  w[0] = 0;
}

static inline void Shift(PetscInt before, PetscInt step, PetscReal r[])
{
  (void)before;
  (void)step;
  (void)r;
}
