/*
   Quadratic B-splines on an open knot vector, 0 0 0 1 2 ... in cells: one spline more than there are nodes. In the
   interior their middles are those of cells, and node i is at i - 1/2. At a wall, with uniform splines u_0 and u_1,

     B_0 = 2 u_0,    B_1 = u_1 - u_0

   and B_0 is at the wall. Source: Piegl and Tiller 1997, section 2.2, for the knots; the sums follow from B_0 =
   (1 - x)^2 and B_1 = 2 x - 3 x^2 / 2 in the first cell.
*/
#define NODES 3
#define KNOTS_ON_NODES
#define OFFSET (-0.5)
#include "scheme/basis/nodes.h"
#include "scheme/basis/splines.h"

static inline void Alter(PetscInt before, PetscInt step, PetscReal w[])
{
  if (before != 0) return;
  w[step] -= w[0];
  w[0] *= 2;
}

static inline void Shift(PetscInt before, PetscInt step, PetscReal r[])
{
  if (before == 0) r[0] += 0.5 * step;
}

const MpmBasis MpmQuadraticOpen = {.name        = "quadratic",
                                   .summary     = "quadratic B-splines, open knot vector",
                                   .reference   = "Piegl and Tiller 1997",
                                   .reach_left  = 0,
                                   .reach_right = 2,
                                   .wall_nodes  = 2,
                                   .spline_ends = MPM_SPLINES_OPEN,
                                   .slope_sum   = 4,
                                   KERNELS};
