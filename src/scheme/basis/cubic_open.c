/*
   Cubic B-splines on an open knot vector, 0 0 0 0 1 2 ... in cells: two splines more than there are nodes. Node i is at
   i - 1 in the interior. At a wall, with uniform splines u_0, u_1 and u_2,

     B_0 = 6 u_0,    B_1 = 3 u_1 / 2 - 6 u_0,    B_2 = u_2 - u_1 / 2 + u_0

   and B_0 is at the wall, B_1 a third of a cell from it. Source: Piegl and Tiller 1997, section 2.2, for the knots; the
   sums follow from B_0 = (1 - x)^3 in the first cell, B_1 = (2 - x)^3 / 4 in the second, and partition of unity.
*/
#define NODES 4
#define KNOTS_ON_NODES
#define OFFSET (-1)
#include "scheme/basis/nodes.h"
#include "scheme/basis/splines.h"

static inline void Alter(PetscInt before, PetscInt step, PetscReal w[])
{
  if (before == 0) {
    w[2 * step] += w[0] - w[step] / 2;
    w[step] = 1.5 * w[step] - 6 * w[0];
    w[0] *= 6;
  } else if (before == 1) { /* w[0] is u_1 */
    w[step] -= w[0] / 2;
    w[0] *= 1.5;
  }
}

static inline void Shift(PetscInt before, PetscInt step, PetscReal r[])
{
  if (before == 0) {
    r[0] += step;
    r[step] += step / 3.0;
  } else if (before == 1)
    r[0] += step / 3.0;
}

const MpmBasis MpmCubicOpen = {.name        = "cubic",
                               .summary     = "cubic B-splines, open knot vector",
                               .reference   = "Piegl and Tiller 1997",
                               .reach_left  = 0,
                               .reach_right = 3,
                               .wall_nodes  = 3,
                               .spline_ends = MPM_SPLINES_OPEN,
                               .slope_sum   = 6,
                               KERNELS};
